"""Pictures of a scene: one host for all of them."""

from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.kernel.messages import Demand, SetClock
from vrut_lite.messages.light_map import ALL_RAYS, BESIDE_POINTS, SurfaceLightChanged
from vrut_lite.messages.picture import SetExposure
from vrut_lite.messages.view_light import ViewLightChanged
from vrut_lite.pictures.display import Bits, display_picture
from vrut_lite.pictures.image_files import Metadata, write_picture
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import Project, daylight_inputs, setting_inputs, view_inputs
from vrut_lite.studio.engines import GL, EngineHost
from vrut_lite.studio.open_kernel import open_gl, open_host, require_sky, require_sun
from vrut_lite.studio.picture_metadata import hour_text, picture_metadata
from vrut_lite.studio.progress import busy_with
from vrut_lite.studio.time_span import at_instant, other_side

if TYPE_CHECKING:
    from vrut_lite.host import Host
    from vrut_lite.render.gl_owner import GlOwner


@dataclass(frozen=True)
class ScenePlan:
    """A project (its hour is only the first), the bits of a PNG's channels, and the engine."""

    project: Project
    bits: Bits = 8
    engine: str = GL

    def open(self, by_map: bool = False) -> "SceneStudio":
        """A host with the scene open; `by_map`: the light map alone lights the pictures.

        Raises:
            UserError: the project has an invalid value.
        """
        # OpenGL is opened while libraries are imported.
        gl = open_gl() if self.engine == GL else None
        try:
            of_hour, of_view = daylight_inputs(self.project), view_inputs(self.project)
            setting_inputs(self.project, daylight_kernel()[0])
        except BaseException:
            if gl is not None:
                gl.close()
            raise
        host = self._open_host(gl)
        try:
            if self.engine == GL and self.project.shows != "noise":
                # Light of fewer rays is not shown, except to estimate noise from half as many.
                host.inject(_of_surfaces(ALL_RAYS if by_map else BESIDE_POINTS))
            host.inject(*setting_inputs(self.project, host.kernel), *of_view)
            with busy_with(f"opening and lighting {self.project.scene}", host.kernel.trace):
                if not isinstance(host, EngineHost):
                    # The scene goes to the GPU while its light is worked out.
                    host.begin_scene()
                host.inject(*of_hour)
                host.settle()
        except BaseException:
            host.close()
            raise
        return SceneStudio(self, host)

    def _open_host(self, gl: "GlOwner | None") -> "Host | EngineHost":
        if gl is None:
            return EngineHost(self.engine, self.project)
        host = open_host(gl)
        # A reflection that lags invisibly behind the sky would depend on the picture before.
        host.frame_skips = replace(host.frame_skips, reflection=False)
        return host


class SceneStudio:
    """A `Studio` for one scene."""

    def __init__(self, plan: ScenePlan, host: "Host | EngineHost"):
        self._plan, self.host = plan, host
        self._hour = plan.project.instant()

    def shoot(self, instant: datetime) -> "SceneShot":
        """The scene's picture at an instant."""
        self.go_to(instant)
        self.host.inject(_finer_light(wanted=True))
        picture = self.host.draw()
        return SceneShot(picture, self.metadata(picture.ev100), self._plan, self.notices)

    def go_to(self, instant: datetime) -> None:
        """Light the scene at an instant, without the light of a finished still.

        Raises:
            UserError: there is no sun or no sky.
        """
        # Rays for visible points at this hour only: light that no picture shows costs seconds.
        self.host.inject(_finer_light(wanted=False))
        if instant != self._hour:
            # Small moves are skipped as invisible, so that the sun moves far away first.
            for hour in (other_side(instant), instant):
                self.host.inject(SetClock(instant=hour))
                self.host.settle()
            self._hour = instant
        require_sun(self.host.kernel)
        require_sky(self.host.kernel)

    def metadata(self, ev100: float) -> dict[str, str | float]:
        """Metadata of a picture of the present hour with this exposure."""
        project = at_instant(self._plan.project, self._hour)
        metadata = {
            **picture_metadata(project, self.host.kernel),
            "exposureEv100": ev100,
            "toneMap": project.exposure.tone_map,
            "nightLook": project.exposure.night_look,
            "engine": self._plan.engine,
        }
        if isinstance(self.host, EngineHost):
            metadata["samplesPerPixel"] = self.host.samples
        return metadata

    @property
    def notices(self) -> tuple[str, ...]:
        """Lines on what the scene has and pictures lack."""
        scene = self.host.state.scene
        return scene.notices if scene else ()

    def close(self) -> None:
        """Free the GPU."""
        self.host.close()


def _of_surfaces(rays: int) -> Demand:
    """A demand for light of so many rays a texel."""
    return Demand(consumer="still", message=SurfaceLightChanged.__name__, size=rays)


def _finer_light(wanted: bool) -> Demand:
    """A demand for light on what a finished still shows, or its end."""
    size = None if wanted else 0
    return Demand(consumer="still", message=ViewLightChanged.__name__, size=size)


@dataclass(frozen=True)
class SceneShot:
    """A picture, its metadata, and what it lacks of the scene's files."""

    picture: Picture
    metadata: Metadata
    plan: ScenePlan
    notices: tuple[str, ...]

    @property
    def caption(self) -> str:
        """The hour, the sun and the exposure; false colours have none."""
        hour = hour_text(self.metadata)
        shows_light = self.plan.project.shows == "picture"
        return f"{hour}, EV100 {self.picture.ev100:.1f}" if shows_light else hour

    def write(self, path: Path) -> None:
        """PNG and JPEG for display, EXR of radiance."""
        deep = self.plan.bits == 16 and path.suffix.lower() == ".png"
        display = self._display_16() if deep else self.picture.display
        write_picture(path, self.picture.radiance, display, self.metadata)

    def _display_16(self) -> NDArray[Any]:
        """16-bit display values, from the radiance: the frame itself has 8 bits only."""
        picture = self.picture
        if picture.values is not None:
            return picture.display.astype(np.uint16) * 257
        radiance = picture.radiance if picture.shown is None else picture.shown
        wish = SetExposure(**msgspec.structs.asdict(self.plan.project.exposure))
        return display_picture(radiance, picture.ev100, wish, bits=16, pixel_rad=picture.pixel_rad)

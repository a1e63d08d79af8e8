"""Pictures of a scene all around: equirectangular, for one eye or for two."""

import math
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite.geometry.frames import angles_from_direction, enu_from_world
from vrut_lite.host import Host
from vrut_lite.messages.picture import SetExposure
from vrut_lite.numeric_types import FloatArray, vector
from vrut_lite.pictures import exposure
from vrut_lite.pictures.display import Bits, display_picture
from vrut_lite.pictures.image_files import Metadata, write_picture
from vrut_lite.pictures.night_eye import blur_px
from vrut_lite.pictures.photo_sphere import PhotoSphere
from vrut_lite.project import Project
from vrut_lite.studio.panorama_views import (
    INTERPUPILLARY_M,
    Eye,
    PanoramaView,
    Sphere,
    equal_areas,
)
from vrut_lite.studio.picture_metadata import hour_text
from vrut_lite.studio.progress import advancing_bar
from vrut_lite.studio.scene_pictures import ScenePlan, SceneStudio

_WIDTH_PX, _LEAST_WIDTH_PX, _MOST_WIDTH_PX = 2048, 32, 8192
# Size of the picture for which the scene is opened and lit.
_FIRST_PX = (64, 64)


def default_size_px(stereo: bool) -> tuple[int, int]:
    """Width and height of a panorama's file whose size nobody says."""
    return _WIDTH_PX, _WIDTH_PX if stereo else _WIDTH_PX // 2


@dataclass(frozen=True)
class PanoramaPlan:
    """A project whose size is the file's, the bits of a PNG's channels, and whether two eyes see.

    The camera's eye is the middle of the panorama.
    """

    project: Project
    stereo: bool
    bits: Bits = 8

    def __post_init__(self) -> None:
        """Check that such a panorama can be drawn.

        Raises:
            UserError: it cannot.
        """
        width, height = self.project.size
        if height * (1 if self.stereo else 2) != width:
            form = "square, an eye above the other" if self.stereo else "twice as wide as high"
            usual = "x".join(map(str, default_size_px(self.stereo)))
            raise UserError(
                f"an equirectangular picture is {form}: {width}x{height} is not, {usual} is"
            )
        if not _LEAST_WIDTH_PX <= width <= _MOST_WIDTH_PX or width % 4:
            raise UserError(
                f"an equirectangular picture is {_LEAST_WIDTH_PX} to {_MOST_WIDTH_PX} pixels wide, "
                f"a multiple of 4, not {width}"
            )
        project = self.project
        for wanted, name in (
            (project.exposure.glare > 0.0, "glare"),
            (project.polariser_deg is not None, "polariser"),
            (project.shows != "picture", "false colours"),
        ):
            if wanted:
                raise UserError(f"an equirectangular picture has no {name}: draw a perspective one")

    def open(self) -> "PanoramaStudio":
        """A host with the scene open.

        Raises:
            UserError: the project has an invalid value.
        """
        plan = ScenePlan(msgspec.structs.replace(self.project, size=_FIRST_PX))
        return PanoramaStudio(self, plan.open(by_map=True))


class PanoramaStudio:
    """A `Studio` for one scene."""

    def __init__(self, plan: PanoramaPlan, studio: SceneStudio):
        self._plan, self._studio = plan, studio
        assert isinstance(studio.host, Host)
        self._host = studio.host
        camera = self._host.state.camera
        assert camera is not None
        self._camera = camera
        north_offset_rad = math.radians(plan.project.north_offset_deg)
        self._sphere = Sphere(plan.project.size[0], north_offset_rad)

    def shoot(self, instant: datetime) -> "PanoramaShot":
        """The scene's panorama at an instant."""
        self._studio.go_to(instant)
        eyes: tuple[Eye, ...] = ("left", "right") if self._plan.stereo else ("middle",)
        middle_m = np.array(self._camera.eye_m)
        views = [(eye, view) for eye in eyes for view in self._sphere.views(middle_m, eye)]
        shape = self._sphere.height_px, self._sphere.width_px, 3
        pictures = {eye: np.zeros(shape, np.float32) for eye in eyes}
        self._look_to_horizon()
        with advancing_bar("views", len(views)) as advance:
            for eye, view in views:
                self._sphere.fill(pictures[eye], view, self._drawn(view))
                advance(1)
        self._host.frame_skips = replace(self._host.frame_skips, reflection=False)
        radiance = np.concatenate(list(pictures.values()))
        state = self._host.state
        metered = equal_areas(pictures[eyes[0]])
        ev100 = exposure.ev100_of(state.exposure, metered, state.white_card)
        metadata = {**self._studio.metadata(ev100), **self._about_projection()}
        sphere = PhotoSphere(
            self._plan.project.size,
            self._plan.stereo,
            self._heading_deg(middle_m),
            str(metadata["Software"]),
        )
        return PanoramaShot(
            radiance, ev100, metadata, self._plan, sphere.xmp(), self._studio.notices
        )

    def _drawn(self, view: PanoramaView) -> NDArray[np.float32]:
        """The view's radiance (h, w, 3), by the light map.

        Light of a still's own points differs by 2 % across the border of two views.
        """
        state = replace(self._host.state, moved_camera=view.camera, size_px=view.size_px)
        picture = self._host.draw_state(state, still=True)
        # Every view mirrors the sky that the first has filtered.
        self._host.frame_skips = replace(self._host.frame_skips, reflection=True)
        return picture.radiance

    def _look_to_horizon(self) -> None:
        """Compute the air as far as the horizon, which the views see together."""
        target_m = vector(np.array(self._camera.eye_m) - (0.0, 0.0, 1.0))
        self._host.inject(msgspec.structs.replace(self._camera, target_m=target_m))
        self._host.settle()

    def _heading_deg(self, middle_m: FloatArray) -> float:
        """Azimuth of the camera, clockwise of true north."""
        away = np.array(self._camera.target_m) - middle_m
        enu = enu_from_world(away, self._sphere.north_offset_rad)
        return math.degrees(float(angles_from_direction(enu)[0]))

    def _about_projection(self) -> Metadata:
        found: dict[str, str | float] = {"projection": "equirectangular, true north in the middle"}
        if self._plan.stereo:
            found["stereo"] = "omnidirectional, top-bottom, left eye on top"
            found["interpupillaryDistanceM"] = INTERPUPILLARY_M
        return found

    def close(self) -> None:
        """Free the GPU."""
        self._studio.close()


@dataclass(frozen=True)
class PanoramaShot:
    """Radiance (h, w, 3) of a panorama, the left eye's above the right one's, and its metadata."""

    radiance: NDArray[np.float32]
    ev100: float
    metadata: Metadata
    plan: PanoramaPlan
    xmp: bytes
    notices: tuple[str, ...]

    @property
    def caption(self) -> str:
        """The hour, the sun and the exposure."""
        return f"{hour_text(self.metadata)}, EV100 {self.ev100:.1f}"

    def write(self, path: Path) -> None:
        """PNG and JPEG for display, EXR of radiance."""
        eyes = np.split(self.radiance, 2) if self.plan.stereo else [self.radiance]
        display = np.concatenate([self._display(eye) for eye in eyes])
        write_picture(path, self.radiance, display, self.metadata, self.xmp)

    def _display(self, radiance: NDArray[np.float32]) -> NDArray[Any]:
        """Display values of an eye's picture, which goes on beyond its left and right border."""
        width = radiance.shape[1]
        wish = SetExposure(**msgspec.structs.asdict(self.plan.project.exposure))
        pixel_rad = 2.0 * math.pi / width
        beyond = min(blur_px(pixel_rad)[1] + 1, width)
        around = np.concatenate([radiance[:, -beyond:], radiance, radiance[:, :beyond]], axis=1)
        shown = display_picture(around, self.ev100, wish, bits=self.plan.bits, pixel_rad=pixel_rad)
        return shown[:, beyond : beyond + width]

"""A scene backend that traces paths: keeps what it was told, and traces when asked to draw."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from path_tracer.settings import PathTracerSettings
from path_tracer.subject import Subject
from path_tracer.tracer import Tracer
from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.clouds import CloudsChanged
from vrut_lite.daylight.picture import SetExposure
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.render.display import display_picture
from vrut_lite.render.exposure import automatic_ev100
from vrut_lite.render.white_balance import white_balance_matrix
from vrut_lite.scene.backend import Picture
from vrut_lite.scene.ground_disc import GroundDisc
from vrut_lite.scene.loading import LoadedScene

_UNPAINTED = 0.1


@dataclass
class _Told:
    """What the scene manager has said so far."""

    scene: LoadedScene | None = None
    background: BackgroundChanged | None = None
    sun: KeyLightChanged | None = None
    camera: MoveCamera | None = None
    ground: GroundDisc | None = None
    ground_albedo: NDArray[np.float64] = field(default_factory=lambda: np.full(3, _UNPAINTED))
    sheltered: bool = False
    exposure: SetExposure = field(default_factory=SetExposure)
    size: tuple[int, int] = (960, 540)


class PathTracedBackend:
    """A `SceneBackend`; `traced` hears of the samples that each step of a drawing brought.

    Neither air nor clouds are drawn.
    """

    def __init__(
        self, settings: PathTracerSettings, traced: Callable[[int], None] = lambda samples: None
    ):
        self.settings = settings
        self._traced = traced
        self._told = _Told()

    def show_scene(self, scene: LoadedScene, ground: GroundDisc | None) -> None:
        """Show this scene, on this ground if there is one."""
        self._told.scene, self._told.ground = scene, ground

    def set_background(self, background: BackgroundChanged) -> None:
        """Show this sky."""
        self._told.background = background

    def set_sun_light(self, light: KeyLightChanged) -> None:
        """Light with this sun."""
        self._told.sun = light

    def set_ambient(self, ambient: AmbientChanged) -> None:
        """Do nothing: the sky itself lights."""

    def set_air(self, air: AirChanged) -> None:
        """Do nothing: light goes straight from surface to surface."""

    def set_clouds(self, clouds: CloudsChanged) -> None:
        """Do nothing: there are none in the environment map."""

    def set_light_shafts(self, light_shafts: bool) -> None:
        """Do nothing: they are seen in the air alone."""

    def set_ground_albedo(self, albedo_rgb: NDArray[np.float64]) -> None:
        """Paint the ground disc."""
        self._told.ground_albedo = np.array(albedo_rgb, dtype=float)

    def set_camera(self, camera: MoveCamera) -> None:
        """Look from here."""
        self._told.camera = camera

    def set_sheltered(self, sheltered: bool) -> None:
        """Light with nothing, or with sun and sky again."""
        self._told.sheltered = sheltered

    def set_exposure(self, exposure: SetExposure) -> None:
        """Expose like this."""
        self._told.exposure = exposure

    def set_size(self, width_px: int, height_px: int) -> None:
        """Draw pictures of this size."""
        self._told.size = (width_px, height_px)

    @property
    def is_ready(self) -> bool:
        """Whether nothing is missing for a picture."""
        return not self._missing()

    def subject(self) -> Subject:
        """What a picture is of now.

        Raises:
            RuntimeError: scene, light or camera is still missing.
        """
        told = self._told
        if missing := self._missing():
            raise RuntimeError(f"nothing to draw yet: no {', no '.join(missing)}")
        assert told.scene is not None
        assert told.background is not None
        assert told.sun is not None
        assert told.camera is not None
        return Subject(
            scene=told.scene,
            ground=told.ground,
            ground_albedo=told.ground_albedo,
            background=told.background,
            sun=told.sun,
            camera=told.camera,
            sheltered=told.sheltered,
            size=told.size,
        )

    def _missing(self) -> list[str]:
        needed = ("scene", "background", "sun", "camera")
        return [name for name in needed if getattr(self._told, name) is None]

    def draw(self, still: bool = True) -> Picture:
        """Trace a picture; RuntimeError names what is still missing."""
        tracer = Tracer(self.subject(), self.settings)
        radiance = tracer.trace(0, self.settings.spp, traced=self._traced)
        assert radiance is not None
        return developed(radiance, self._told.exposure)


def developed(radiance: NDArray[np.float32], wish: SetExposure) -> Picture:
    """Radiance (h, w, 3) exposed and tone-mapped as the GL frame does it."""
    ev100 = wish.ev100 if wish.mode == "manual" else automatic_ev100(radiance)
    ev100 -= wish.compensation_ev
    white = white_balance_matrix(wish.white_temperature_k, wish.white_duv)
    # GL counts rows from below, and so does its dither.
    display = display_picture(radiance[::-1], ev100, wish.tone_map, white)[::-1]
    return Picture(radiance, np.ascontiguousarray(display, np.uint8), ev100)

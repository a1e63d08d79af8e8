"""The interface for a sky's author: the light of one hour, in plain values.

`SkyModule` (`sky_module.py`) calls for them and makes messages of them. Radiance is W m^-2 sr^-1 in
linear sRGB, irradiance W m^-2; directions are unit vectors in world axes (east +X, up +Y, north
-Z).
"""

import math
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple, Protocol

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.atmosphere.haze_layer import HazeLayer
from vrut_lite.geometry.encoding import encode_float16, float16_scale
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_job import GpuJob, TexelFormat
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.sky import (
    NO_LAMPS,
    BackgroundChanged,
    SkyPolarisationChanged,
    SkyRadianceChanged,
    SkySpectraSeen,
    ViewShader,
)
from vrut_lite.messages.sun import Body, KeyLightChanged, SunMoved
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector, vector

_USUAL_ALBEDO = 0.1
# Names of a sky's jobs for the GPU.
CUBE_JOB, AIR_JOB = "cube", "air"


class MotionThreshold(NamedTuple):
    """The largest moves of the sun (rad) and of the eye (m, up or down) that change no picture."""

    sun_rad: float = 0.0
    eye_m: float = 0.0


class SkyInputs(msgspec.Struct, frozen=True):
    """The inputs of a sky's light besides its settings.

    `ground_altitude_m` is the place's above sea level, `eye_height_m` the eye's above that ground.
    `body` is the body in the direction of `sun`: a moonlit sky is that of a sun in the moon's
    place, dimmed (`sky_at_night.py`). `night_apart`: another module posts the light of the moonless
    night, so that the sky must not add its own.
    """

    sun: SunMoved
    ground_altitude_m: float = 0.0
    eye_height_m: float = 0.0
    body: Body = "sun"
    night_apart: bool = False

    @property
    def sun_azimuth_rad(self) -> float:
        """The sun's azimuth in world axes: from -Z, clockwise seen from above."""
        x, _, z = self.sun.direction
        return float(np.arctan2(x, -z))

    def unless_unseen(self, later: "SkyInputs", unseen: MotionThreshold) -> "SkyInputs":
        """A later hour, with this one's sun and eye where their moves are invisible.

        While the disc crosses the horizon, every move changes its visible share and counts.
        """
        chord = math.dist(later.sun.direction, self.sun.direction)
        disc_stays = later.sun.visible_disc_fraction == self.sun.visible_disc_fraction
        eye_stays = abs(later.eye_height_m - self.eye_height_m) <= unseen.eye_m
        return msgspec.structs.replace(
            later,
            sun=self.sun if disc_stays and chord <= unseen.sun_rad else later.sun,
            eye_height_m=self.eye_height_m if eye_stays else later.eye_height_m,
        )


class Quality(Protocol):
    """A sky's sizes and thresholds for a tolerance; further fields are the sky's own."""

    @property
    def cube_size(self) -> int:
        """Edge of the background's cube map in texels where the consumer gives no size."""


class Work(NamedTuple):
    """A plain function and its arguments, for a background job; equal work is not done twice.

    `of` is passed on with the result, for settings that the light needs too. `first` computes a
    quick preview, shown until `function` finishes; used only when a sky is already visible.
    """

    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    of: Any = None
    first: "Work | None" = None


class Prepared(NamedTuple):
    """The `of` of a sky's work, and its result."""

    of: Any
    result: Any


class Background(NamedTuple):
    """The whole sphere without the sun's disc.

    Attributes:
        cube: radiance (6, size, size, 3) in float32; or in float16, to be multiplied by `scale`, a
            power of two; or a texture of such values.
        ground_rgb: radiance (3,) of the ground, which fills the cube below the horizon.
        ground_through_air: whether the cube shows the ground through the air before it; else the
            renderer adds that air.
        view: the same pixel by pixel, where a cube map would blur it.
        seen_sun_rgb: the sun's irradiance (3,) at the eye, where it differs from the scene's.
    """

    cube: Float32Array | NDArray[np.float16] | GpuTexture
    ground_rgb: FloatArray
    scale: float = 1.0
    ground_through_air: bool = False
    view: ViewShader | None = None
    seen_sun_rgb: FloatArray | None = None

    def message(self, source: str) -> BackgroundChanged:
        """The background as a message."""
        cube, scale = self._encoded()
        return BackgroundChanged(
            cube=cube,
            radiance_scale=scale,
            ground_radiance_rgb=vector(self.ground_rgb),
            source=source,
            ground_through_air=self.ground_through_air,
            view=self.view,
            seen_sun_irradiance_rgb=(
                None if self.seen_sun_rgb is None else vector(self.seen_sun_rgb)
            ),
        )

    def light_message(self, source: str) -> SkyRadianceChanged:
        """The radiance on the scene as a message; the cube must be on the CPU."""
        cube, scale = self._encoded()
        assert isinstance(cube, Array)
        return SkyRadianceChanged(
            cube=cube,
            radiance_scale=scale,
            ground_radiance_rgb=vector(self.ground_rgb),
            source=source,
        )

    def _encoded(self) -> tuple[Array | GpuTexture, float]:
        """The cube in half precision, and the power of two that brings it back."""
        if isinstance(self.cube, GpuTexture):
            return self.cube, self.scale
        if self.cube.dtype == np.float16:
            return Array(self.cube), self.scale
        cube, scale = encode_float16(self.cube)
        return Array(cube), scale


def polarisation_message(cube: Float32Array | None, source: str) -> SkyPolarisationChanged:
    """Q and U (2, 6, size, size, 3) as a message."""
    if cube is None:
        return SkyPolarisationChanged(cube=None, source=source)
    scale = float16_scale(float(np.abs(cube).max()))
    halves = Array((cube / np.float32(scale)).astype(np.float16))
    return SkyPolarisationChanged(cube=halves, radiance_scale=scale, source=source)


class SunDisc(NamedTuple):
    """The sun's direct light on a plane that faces it, its disc as in `KeyLightChanged`.

    `direction`: of a body elsewhere than in `SunMoved`: a photograph's sun, or the moon. `haze`: as
    in `KeyLightChanged`.
    """

    irradiance_rgb: FloatArray
    angular_radius_rad: float = 0.004675
    limb_darkening_rgb: tuple[tuple[float, ...], ...] = ((1.0,),) * 3
    body: Body = "sun"
    direction: Vector | None = None
    haze: tuple[HazeLayer, ...] = ()

    def message(self, direction: Vector, source: str) -> KeyLightChanged:
        """The same as the sky's holder posts it."""
        return KeyLightChanged(
            direction=self.direction or direction,
            irradiance_rgb=vector(self.irradiance_rgb),
            angular_radius_rad=self.angular_radius_rad,
            limb_darkening_rgb=self.limb_darkening_rgb,
            source=source,
            body=self.body,
            haze=self.haze,
        )


class Spectrum(NamedTuple):
    """Spectral radiance, W m^-2 sr^-1 nm^-1; empty where a sky knows colours alone."""

    wavelength_nm: tuple[float, ...] = ()
    radiance: tuple[float, ...] = ()


class SkySpectra(NamedTuple):
    """Spectra at W wavelengths, as in `SkySpectraSeen`: `cube` (6, size, size, W) float32 of the
    sky, `sun_irradiance`, `ground_radiance` and `ground_albedo` (W,)."""

    cube: Float32Array
    sun_irradiance: FloatArray
    ground_radiance: FloatArray
    ground_albedo: FloatArray

    def message(self, wavelength_nm: tuple[float, ...], source: str) -> SkySpectraSeen:
        """The spectra as a message."""
        return SkySpectraSeen(
            wavelength_nm=wavelength_nm,
            cube=Array(np.asarray(self.cube, np.float32)),
            sun_irradiance=tuple(self.sun_irradiance.tolist()),
            ground_radiance=tuple(self.ground_radiance.tolist()),
            ground_albedo=tuple(self.ground_albedo.tolist()),
            source=source,
        )


class Sky:
    """The light of one hour; each method is called only if its result is demanded.

    Equal skies are not posted twice: derive a frozen dataclass that holds all inputs of the light.

    Work on a card in trial pixels (`device_choice`): `cube_trials` of a texel by `gpu_background`,
    `air_trials` of the volume by `gpu_air`.
    """

    cube_trials: ClassVar[float] = 1.0
    air_trials: ClassVar[float] = 1e5

    def background(self, size: int) -> Background:
        """Sky and ground as a cube map with an edge of `size` texels."""
        raise NotImplementedError

    def background_on_ground(self, size: int) -> Background:
        """The background computed on the CPU for an observer on the ground."""
        return self.background(size)

    def sun(self) -> SunDisc:
        """The sun's light on the scene."""
        raise NotImplementedError

    def ambient(self) -> FloatArray | Float32Array:
        """Harmonics (25, 3) of the irradiance on the scene by sky and ground."""
        raise NotImplementedError

    def polarisation(self, size: int) -> Float32Array | None:
        """Q and U (2, 6, size, size, 3) as in `SkyPolarisationChanged`; None if unknown."""
        return None

    def lamps_rgb(self) -> Vector:
        """Radiance of the lands around by their lamps; none by day."""
        return NO_LAMPS

    def ground_albedo_rgb(self) -> FloatArray:
        """Albedo (3,) of the ground, for light that the sky itself does not know."""
        return np.full(3, _USUAL_ALBEDO)

    def on_scene(self) -> object:
        """The light on the scene as a value to compare; by default the whole sky."""
        return self

    def unseen(self, hour: SkyInputs, quality: Any) -> MotionThreshold:
        """Moves of sun and eye from this sky's hour that do not need a new sky."""
        return MotionThreshold()

    def air(self, eye_height_m: float, reach_m: float) -> AirVolume | None:
        """The air up to `reach_m` from the eye; None where it is invisible."""
        return None

    def spectrum(self, direction: Vector) -> Spectrum:
        """Spectrum of the sky in a direction; empty below the horizon."""
        return Spectrum()

    def spectra(self, size: int, wavelength_nm: tuple[float, ...]) -> SkySpectra | None:
        """Spectra of sky, sun and ground as they light the scene; None where only colours are
        known."""
        return None

    def gpu_background(self, size: int, format: TexelFormat) -> tuple[GpuJob, Background] | None:
        """The job `CUBE_JOB` that makes the cube, and the background without the texture.

        Its last program stores each texel once; so the base can sum skies by night (`cube_sum`).
        None where the CPU must make it.
        """
        return None

    def gpu_air(self, eye_height_m: float, reach_m: float) -> tuple[GpuJob, AirVolume] | None:
        """The job `AIR_JOB` that makes the air's light, and the volume without the texture.

        Its last program stores each node once; so the base can have two bodies (`air_sum`).
        """
        return None

    def card_cube_trials(self) -> float:
        """Work of a texel by `gpu_background` in this hour, in trial pixels."""
        return self.cube_trials

    def card_air_trials(self) -> float:
        """Work of the volume by `gpu_air` in this hour, in trial pixels."""
        return self.air_trials

    def card_makes(self, product: str) -> bool:
        """Whether there is a program for a product, "gpu_background" or "gpu_air"."""
        return getattr(type(self), product) is not getattr(Sky, product)

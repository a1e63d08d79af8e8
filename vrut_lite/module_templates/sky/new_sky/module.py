"""The module: its settings, and the light of an hour in plain values."""

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import msgspec
import numpy as np
from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.kernel.module import Manifest
from vrut_lite.kernel.settings import setting
from vrut_lite.numeric_types import Float32Array, FloatArray
from vrut_lite.sky.sky_module import SkyModule
from vrut_lite.sky.sky_of_hour import Background, MotionThreshold, Sky, SkyInputs, SunDisc

from new_sky.overcast import illuminance_lx, radiance


class NewSkySettings(msgspec.Struct, frozen=True):
    """Options of the command line and rows of the panel; each field has a default."""

    cloud_light: Annotated[float, setting("Light of the clouds over the usual", 0.1, 4)] = 1.0


class OvercastQuality(NamedTuple):
    """Sizes for a tolerance."""

    cube_size: int
    # Relative change of light that skipped moves of the sun may cause.
    share: float


class NewSky(SkyModule):
    """An overcast sky; the sun is that of another module, hidden by the clouds."""

    manifest = Manifest(
        name="new_sky",
        title="New sky",
        version="0.1.0",
        provides=("sky",),
        requires=("sun",),
    )
    settings_type = NewSkySettings
    settings: NewSkySettings

    def quality(self, tolerance: float) -> OvercastQuality:
        """A smooth sky needs few texels."""
        return OvercastQuality(int(np.clip(8.0 / tolerance, 64, 256)), 0.1 * tolerance)

    def light(self, hour: SkyInputs, quality: OvercastQuality, prepared: None) -> "OvercastLight":
        """The light under this sun."""
        lux = self.settings.cloud_light * illuminance_lx(hour.sun.apparent_elevation_rad)
        return OvercastLight(lux, tuple(self.ground.rgb))


@dataclass(frozen=True)
class OvercastLight(Sky):
    """Compared by value: equal skies are not posted twice."""

    horizontal_lx: float
    ground_albedo: tuple[float, ...]

    def background(self, size: int) -> Background:
        """Sky and ground as a cube map."""
        return Background(self._cube(size), self._ground())

    def sun(self) -> SunDisc:
        """No direct light comes through the clouds."""
        return SunDisc(np.zeros(3))

    def ambient(self) -> FloatArray | Float32Array:
        """Harmonics of the irradiance by sky and ground."""
        return irradiance_coefficients(self._cube(64))

    def ground_albedo_rgb(self) -> FloatArray:
        """The ground's, for light that other modules add."""
        return np.array(self.ground_albedo)

    def unseen(self, hour: SkyInputs, quality: OvercastQuality) -> MotionThreshold:
        """The logarithm of the light changes by 70 per rad of height at most, at sunrise."""
        return MotionThreshold(sun_rad=quality.share / 70.0)

    def _cube(self, size: int) -> Float32Array:
        sine = texel_directions(size)[..., 1]
        sky = radiance(self.horizontal_lx, sine)
        return np.where(sine[..., None] > 0.0, sky, self._ground()).astype(np.float32)

    def _ground(self) -> FloatArray:
        return np.array(self.ground_albedo) / np.pi * self.horizontal_lx / LUMENS_PER_WATT

"""The light of a photograph of the sky, as `SkyModule` asks for it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from photo_sky.photograph import Photograph
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.cube_map import reduce_cube, texel_directions
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance, irradiance_coefficients
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.sky_of_hour import Background, MotionThreshold, Sky, SkyInputs, SunDisc

RADIUS_RAD = 0.004675
_LIGHT_SIZE = 64
# At most so many samples along a texel's edge.
_MOST_SAMPLES = 8


@dataclass(frozen=True)
class PhotoLight(Sky):
    """A photograph turned clockwise and scaled to cd/m²; without one an even grey sky."""

    photograph: Photograph | None
    rotation_rad: float
    cd_m2_per_unit: float
    illuminance_lux: float | None
    albedo_rgb: Vector

    @cached_property
    def _scale(self) -> float:
        """W m^-2 sr^-1 per unit of the photograph."""
        assert self.photograph is not None
        if self.illuminance_lux is None:
            return self.cd_m2_per_unit / LUMENS_PER_WATT
        level = float(luminance(self.photograph.level_irradiance))
        return self.illuminance_lux / LUMENS_PER_WATT / level

    def sky_cube(self, size: int) -> FloatArray:
        """Radiance (6, size, size, 3) above the horizon, 0 below; means over the texels."""
        if self.photograph is None:
            even = (self.illuminance_lux or 10_000.0) / (np.pi * LUMENS_PER_WATT)
            return np.where(texel_directions(size)[..., 1:2] > 0.0, even, 0.0) * np.ones(3)
        rows = len(self.photograph.sky)
        samples = int(np.clip(np.ceil(0.5 * rows / size), 1, _MOST_SAMPLES))
        directions = texel_directions(size * samples)
        fine = np.zeros(directions.shape)
        above = directions[..., 1] > 0.0
        fine[above] = self._seen(directions[above])
        cube = reduce_cube(fine, size)
        # Sizes are even, so that the horizon cuts no texel, which would be half dark.
        cube[texel_directions(size)[..., 1] <= 0.0] = 0.0
        return cube * self._scale

    def _seen(self, direction: FloatArray) -> FloatArray:
        """The photograph's radiance (n, 3) above the horizon, linear between pixels."""
        assert self.photograph is not None
        sky = self.photograph.sky
        height = len(sky)
        azimuth = np.arctan2(direction[:, 0], -direction[:, 2]) - self.rotation_rad
        row = (0.5 - np.arcsin(np.clip(direction[:, 1], -1.0, 1.0)) / np.pi) * height - 0.5
        column = (azimuth / np.pi + 1.0) * height - 0.5
        row = np.clip(row, 0.0, height // 2 - 1.0)
        i, j = np.floor(row).astype(int), np.floor(column).astype(int)
        u, v = (column - j)[:, None], (row - i)[:, None]
        below, left, right = (
            np.minimum(i + 1, height // 2 - 1),
            j % (2 * height),
            (j + 1) % (2 * height),
        )
        top = sky[i, left] * (1.0 - u) + sky[i, right] * u
        return top * (1.0 - v) + (sky[below, left] * (1.0 - u) + sky[below, right] * u) * v

    @property
    def sun_direction(self) -> Vector | None:
        """World direction of the photograph's sun."""
        if self.photograph is None or self.photograph.sun_direction is None:
            return None
        x, y, z = self.photograph.sun_direction
        cosine, sine = np.cos(self.rotation_rad), np.sin(self.rotation_rad)
        return float(cosine * x - sine * z), float(y), float(sine * x + cosine * z)

    def sun(self) -> SunDisc:
        """All that was taken out, on a disc of the sun's own size."""
        direction = self.sun_direction
        if direction is None:
            return SunDisc(np.zeros(3), RADIUS_RAD)
        assert self.photograph is not None
        light = self.photograph.sun_irradiance * self._scale
        return SunDisc(light, RADIUS_RAD, direction=direction)

    @cached_property
    def _ground_rgb(self) -> FloatArray:
        falls, direction = horizontal_irradiance(self._light_cube), self.sun_direction
        if direction is not None:
            falls = falls + self.sun().irradiance_rgb * direction[1]
        return np.asarray(self.albedo_rgb) / np.pi * falls

    def ground_albedo_rgb(self) -> FloatArray:
        """That of the ground in sunlight."""
        return np.asarray(self.albedo_rgb)

    @cached_property
    def _light_cube(self) -> FloatArray:
        return self.sky_cube(_LIGHT_SIZE)

    def background(self, size: int) -> Background:
        """The photograph above the horizon, the ground below."""
        cube = self.sky_cube(size).astype(np.float32)
        cube[texel_directions(size)[..., 1] <= 0.0] = self._ground_rgb
        return Background(cube, self._ground_rgb)

    def ambient(self) -> FloatArray:
        """Harmonics of a small cube of sky and ground."""
        cube = self._light_cube.copy()
        cube[texel_directions(_LIGHT_SIZE)[..., 1] <= 0.0] = self._ground_rgb
        return irradiance_coefficients(cube)

    def unseen(self, hour: SkyInputs, quality: object) -> MotionThreshold:
        """No move of the clock's sun is seen."""
        return MotionThreshold(sun_rad=np.inf, eye_m=np.inf)

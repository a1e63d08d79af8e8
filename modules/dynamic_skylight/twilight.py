"""The sky of any hour: Hosek-Wilkie by day, computed twilight below, starlight at night.

The Hosek-Wilkie model ends where the sun sets. From a geometric elevation of +0.5 deg down to
-2.5 deg its last sky, with the glow at the sun's place below the horizon, is blended into the
computed twilight of `twilight_table` (see `twilight_blend`). The result is scaled to an illuminance
of level ground that continues the model's and meets the published curve at -7 deg. At -18 deg only
the constant night sky remains.

The shape of the sky follows the apparent sun; the level and the blend follow the geometric
elevation, as the published curve does: at sunset, -50', it gives 452 lx, where the Glossary of
Meteorology has 585 to 410 lx.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamic_skylight.hosek_wilkie.cube_rows import fill_cube
from dynamic_skylight.hosek_wilkie.formula import extended_perez
from dynamic_skylight.hosek_wilkie.levelled_sky import LevelledSky
from dynamic_skylight.hosek_wilkie.sky import ALL_FACES, HosekWilkieSky
from dynamic_skylight.twilight_blend import BLEND_DEG, BLEND_ENDS_DEG, blend, model_on_map
from dynamic_skylight.twilight_curve import NIGHT_BEGINS_DEG, illuminance_lx
from dynamic_skylight.twilight_rows import lay_over
from dynamic_skylight.twilight_table import (
    azimuth_coordinate,
    elevation_coordinate,
    look_up,
    luminous_irradiance,
    twilight_table,
)
from vrut_lite.atmosphere.refraction import geometric_elevation, refraction_of_true_rad
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.numeric_types import FloatArray

# Geometric elevation at which the illuminance reaches the published curve.
ON_CURVE_DEG = -7.0
BLEND_APPARENT_RAD = float(np.radians(BLEND_DEG) + refraction_of_true_rad(np.radians(BLEND_DEG)))
# Starlight and airglow of a clear moonless night, on level ground (RCA Electro-Optics
# Handbook 1974, table 6-1). Seidelmann's curve ends close by, at 6.5e-4 lx.
NIGHT_ILLUMINANCE_LX = 1e-3
# The night sky is uniform and white, so its radiance is E / pi in each channel.
_NIGHT_RADIANCE = NIGHT_ILLUMINANCE_LX / LUMENS_PER_WATT / np.pi / float(luminance(np.ones(3)))


@dataclass(frozen=True)
class HourSky:
    """Three skies, any of which may be absent: formula, twilight and night.

    Attributes:
        distribution: A to I of the extended Perez formula (3, 9).
        mean_radiance: its factors (3,), W m^-2 sr^-1; 0 when the sun is far below the horizon.
        sun_elevation_rad: apparent elevation of the glow's centre, negative in twilight.
        night_radiance: added everywhere (W m^-2 sr^-1, equal in the channels).
        twilight: (64, 32, 4) on the coordinates v and a of `twilight_table`, interpolated
            bilinearly: the formula is multiplied by the fourth number, then the first three are
            added (W m^-2 sr^-1); None by day and at night.
    """

    distribution: FloatArray
    mean_radiance: FloatArray
    sun_elevation_rad: float
    night_radiance: float
    twilight: FloatArray | None = None

    def radiance(self, theta_rad: ArrayLike, gamma_rad: ArrayLike) -> FloatArray:
        """Radiance (..., 3) above the horizon, linear sRGB, W m^-2 sr^-1, in float64."""
        cos_theta = np.maximum(np.cos(np.asarray(theta_rad, dtype=float)), 0.0)
        shape = extended_perez(cos_theta, gamma_rad, self.distribution)
        sky = np.maximum(shape * self.mean_radiance, 0.0)
        if self.twilight is not None:
            cos_azimuth = self._cos_azimuth(cos_theta, np.asarray(gamma_rad, dtype=float))
            places = elevation_coordinate(cos_theta), azimuth_coordinate(cos_azimuth)
            found = look_up(self.twilight, *np.broadcast_arrays(*places))
            sky = sky * found[..., 3:] + found[..., :3]
        return sky + self.night_radiance

    def _cos_azimuth(self, cos_theta: FloatArray, gamma: FloatArray) -> FloatArray:
        """Cosine (...,) of the azimuth from the sun's: the spherical law of cosines."""
        level = np.sqrt((1.0 - cos_theta) * (1.0 + cos_theta)) * np.cos(self.sun_elevation_rad)
        cosine = np.cos(gamma) - cos_theta * np.sin(self.sun_elevation_rad)
        # At the zenith the azimuth does not matter.
        return np.asarray(cosine / np.maximum(level, 1e-300))

    def cube_map(
        self,
        size: int = 256,
        sun_azimuth_rad: float = 0.0,
        out: NDArray[np.float32] | None = None,
        faces: tuple[int, ...] = ALL_FACES,
    ) -> NDArray[np.float32]:
        """The fast path, as `HosekWilkieSky.cube_map`; night is added below the horizon too."""
        cube = fill_cube(
            self.distribution,
            self.mean_radiance,
            sun_azimuth_rad,
            self.sun_elevation_rad,
            size,
            out,
            faces,
        )
        if self.twilight is not None:
            lay_over(cube, faces, self.twilight, sun_azimuth_rad)
        if self.night_radiance > 0.0:
            cube[list(faces)] += np.float32(self.night_radiance)
        return cube


def sky_of_hour(
    turbidity: float,
    albedo: ArrayLike,
    apparent_elevation_rad: float,
    level: float = 1.0,
    twilight_turbidity: float | None = None,
    starlight: bool = True,
) -> HourSky:
    """The sky for a sun at any apparent elevation from -pi/2 to pi/2.

    `level` multiplies the model's sky; late twilight has its published level regardless.
    `twilight_turbidity` is the haze on Preetham's scale, on which twilight was solved; by default
    the model's turbidity. Without `starlight` the sky is dark from -18 deg.

    Raises:
        ValueError: for a value out of range, in one sentence (see `HosekWilkieSky`).
    """
    elevation = float(apparent_elevation_rad)
    if not -np.pi / 2 <= elevation <= np.pi / 2:
        raise ValueError(f"the sun's elevation must lie within +-pi/2 rad, not {elevation}")
    # Held below the blend: the model is a function of the cube root of elevation, with an infinite
    # slope at 0.
    model = LevelledSky(turbidity, albedo, max(elevation, BLEND_APPARENT_RAD), level)
    if elevation >= BLEND_APPARENT_RAD:
        return HourSky(model.rgb_distribution, model.rgb_mean_radiance, elevation, 0.0)
    return _twilight(model, elevation, twilight_turbidity or turbidity, starlight)


def _twilight(
    model: HosekWilkieSky, elevation_rad: float, turbidity: float, starlight: bool
) -> HourSky:
    """The model's last sky and the computed twilight, scaled to the hour's illuminance."""
    geometric_deg = float(np.degrees(geometric_elevation(elevation_rad)))
    distribution, mean = model.rgb_distribution, model.rgb_mean_radiance
    at_blend = luminous_irradiance(model_on_map(distribution, mean, BLEND_APPARENT_RAD))
    level = _luminous_irradiance(at_blend, geometric_deg)
    # The night sky is added gradually, so that the sky is continuous with the model's day.
    night = _NIGHT_RADIANCE * min(BLEND_DEG - geometric_deg, 1.0) if starlight else 0.0
    if level <= 0.0:
        return HourSky(distribution, 0.0 * mean, elevation_rad, night)
    fitted = twilight_table().directions(turbidity, float(np.degrees(elevation_rad)))
    if geometric_deg > BLEND_ENDS_DEG:
        now = model_on_map(distribution, mean, elevation_rad)
        sky = blend(now, fitted, level, geometric_deg)
        return HourSky(distribution, mean, elevation_rad, night, sky)
    sky = np.concatenate([level * fitted, np.zeros_like(fitted[..., :1])], axis=-1)
    return HourSky(distribution, 0.0 * mean, elevation_rad, night, sky)


def _luminous_irradiance(at_blend: float, geometric_deg: float) -> float:
    """Luminous irradiance (CIE Y, W m^-2) without night: `at_blend` at the blend, 0 at -18 deg.

    The model's last sky is about three times as bright as the curve. The excess fades evenly in
    its logarithm; from -7 deg down the sky has the published illuminance.
    """
    rest = illuminance_lx(NIGHT_BEGINS_DEG)
    curve = float(illuminance_lx(geometric_deg) - rest) / LUMENS_PER_WATT
    curve_at_blend = float(illuminance_lx(BLEND_DEG) - rest) / LUMENS_PER_WATT
    share = (geometric_deg - ON_CURVE_DEG) / (BLEND_DEG - ON_CURVE_DEG)
    return float(curve * (at_blend / curve_at_blend) ** max(share, 0.0))

"""The sky of any hour: Hosek-Wilkie by day, faded to night below the horizon.

The model ends where the sun sets. Provisionally, until twilight is fitted to data of its own,
the sky below half a degree keeps the numbers that Hosek's formula has there, with the glow
around the sun's true place below the horizon, is coloured by ozone, and is scaled so that the
illuminance on level ground goes on from there and approaches the published curve of twilight.
At 18 deg below the horizon it has become the constant night sky.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamic_skylight.hosek_wilkie.formula import extended_perez
from dynamic_skylight.hosek_wilkie.sky import ALL_FACES, HosekWilkieSky
from dynamic_skylight.sun.refraction import geometric_elevation, refraction_rad
from dynamic_skylight.twilight_curve import NIGHT_BEGINS_DEG, illuminance_lx, ozone_tint
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance

FloatArray = NDArray[np.float64]

# Geometric elevation at which Hosek's own sky hands over.
BLEND_DEG = 0.5
BLEND_APPARENT_RAD = float(np.radians(BLEND_DEG) + refraction_rad(np.radians(BLEND_DEG)))
# Starlight and airglow of a clear moonless night, on level ground (RCA Electro-Optics
# Handbook 1974, table 6-1). Seidelmann's curve ends close by, at 6.5e-4 lx.
NIGHT_ILLUMINANCE_LX = 1e-3
# The night sky is taken as even and white, so that its radiance is E / pi in each channel.
_NIGHT_RADIANCE = NIGHT_ILLUMINANCE_LX / LUMENS_PER_WATT / np.pi / float(luminance(np.ones(3)))
_QUADRATURE = (16, 32)


@dataclass(frozen=True)
class HourSky:
    """A sky by the formula's numbers, with the sun anywhere, and an even light behind it.

    Attributes:
        distribution: A to I of the extended Perez formula (3, 9).
        mean_radiance: its factors (3,), W m^-2 sr^-1.
        sun_elevation_rad: of the glow's centre; below the horizon at twilight.
        night_radiance: added everywhere (W m^-2 sr^-1, equal in the channels).
    """

    distribution: FloatArray
    mean_radiance: FloatArray
    sun_elevation_rad: float
    night_radiance: float

    def radiance(self, theta_rad: ArrayLike, gamma_rad: ArrayLike) -> FloatArray:
        """Radiance (..., 3) above the horizon, linear sRGB, W m^-2 sr^-1; the exact twin."""
        cos_theta = np.maximum(np.cos(np.asarray(theta_rad, dtype=float)), 0.0)
        shape = extended_perez(cos_theta, gamma_rad, self.distribution)
        return np.maximum(shape * self.mean_radiance, 0.0) + self.night_radiance

    def cube_map(
        self,
        size: int = 256,
        sun_azimuth_rad: float = 0.0,
        out: NDArray[np.float32] | None = None,
        faces: tuple[int, ...] = ALL_FACES,
    ) -> NDArray[np.float32]:
        """The fast path, as `HosekWilkieSky.cube_map`; the night is added below as well."""
        # Imported when first used: compiling takes a moment that reading the model need not.
        from dynamic_skylight.hosek_wilkie.cube_rows import fill_cube

        cube = fill_cube(
            self.distribution,
            self.mean_radiance,
            sun_azimuth_rad,
            self.sun_elevation_rad,
            size,
            out,
            faces,
        )
        if self.night_radiance > 0.0:
            cube[list(faces)] += np.float32(self.night_radiance)
        return cube


def sky_of_hour(turbidity: float, albedo: float, apparent_elevation_rad: float) -> HourSky:
    """The sky for a sun at any apparent elevation from -pi/2 to pi/2.

    Raises:
        ValueError: for a value out of range, in one sentence (see `HosekWilkieSky`).
    """
    elevation = float(apparent_elevation_rad)
    if not -np.pi / 2 <= elevation <= np.pi / 2:
        raise ValueError(f"the sun's elevation must lie within +-pi/2 rad, not {elevation}")
    # Held from the blend down: in the cube root of elevation the model's slope at 0 is infinite.
    model = HosekWilkieSky(turbidity, albedo, max(elevation, BLEND_APPARENT_RAD))
    if elevation >= BLEND_APPARENT_RAD:
        return HourSky(model.rgb_distribution, model.rgb_mean_radiance, elevation, 0.0)
    return _twilight(model, elevation)


def _twilight(model: HosekWilkieSky, elevation_rad: float) -> HourSky:
    """The blend's sky with the curve's illuminance and the blue hour's colour."""
    geometric_deg = float(np.degrees(geometric_elevation(elevation_rad)))
    distribution, mean = model.rgb_distribution, model.rgb_mean_radiance
    at_blend = luminance(horizontal_irradiance(distribution, mean, BLEND_APPARENT_RAD))
    tinted = mean * ozone_tint(geometric_deg, BLEND_DEG)
    now = luminance(horizontal_irradiance(distribution, tinted, elevation_rad))
    scaled = tinted * (_luminous_irradiance(float(at_blend), geometric_deg) / float(now))
    # The night comes in gradually, for the sake of exact continuity with Hosek's day.
    night = _NIGHT_RADIANCE * min(BLEND_DEG - geometric_deg, 1.0)
    return HourSky(distribution, scaled, elevation_rad, night)


def _luminous_irradiance(at_blend: float, geometric_deg: float) -> float:
    """Luminous irradiance (CIE Y, W m^-2), the night's apart: `at_blend` there, 0 at -18 deg.

    Hosek's last sky is about three times as bright as the curve; the excess fades with depth, so
    that the deep twilight has the published illuminance itself.
    """
    rest = illuminance_lx(NIGHT_BEGINS_DEG)
    curve = float(illuminance_lx(geometric_deg) - rest) / LUMENS_PER_WATT
    curve_at_blend = float(illuminance_lx(BLEND_DEG) - rest) / LUMENS_PER_WATT
    share = (geometric_deg - NIGHT_BEGINS_DEG) / (BLEND_DEG - NIGHT_BEGINS_DEG)
    return float(curve * (at_blend / curve_at_blend) ** max(share, 0.0))


def horizontal_irradiance(
    distribution: FloatArray, mean_radiance: FloatArray, sun_elevation_rad: float
) -> FloatArray:
    """Irradiance (3,) on level ground of the clamped formula, W m^-2, by Gauss-Legendre.

    The rule is in sin^2 theta, whose weight is the cosine's, and even in azimuth.
    """
    rows, columns = _QUADRATURE
    x, weight = np.polynomial.legendre.leggauss(rows)
    cos_theta = np.sqrt(0.5 - 0.5 * x)[:, None]
    sin_theta = np.sqrt(0.5 + 0.5 * x)[:, None]
    azimuth = (np.arange(columns) + 0.5) * (np.pi / columns)
    cos_gamma = cos_theta * np.sin(sun_elevation_rad) + sin_theta * np.cos(
        sun_elevation_rad
    ) * np.cos(azimuth)
    gamma = np.arccos(np.clip(cos_gamma, -1.0, 1.0))
    radiance = np.maximum(extended_perez(cos_theta, gamma, distribution) * mean_radiance, 0.0)
    mean: FloatArray = np.pi * np.einsum("i,ijc->c", weight / 2.0, radiance) / columns
    return mean

"""Irradiance and radiance of level ground under sun and sky."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.field_tables import table_of_field
from bruneton_sky.solver import SourceField, ground_irradiance
from bruneton_sky.solver.grid import SunGrid
from bruneton_sky.sun_light import sun_irradiance
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray

SKYLIGHT_EXPONENT, SUNLIGHT_EXPONENT = 3.0, 0.0
# Nodes of mu_s between which the ground's light is interpolated, placed as the solver's.
_SUNS = 192


class GroundLight(NamedTuple):
    """A spectral quantity by its source, (..., C) each: sun and sky convert to RGB differently."""

    sun: FloatArray
    sky: FloatArray

    def rgb(self, wavelength_nm: tuple[float, ...]) -> FloatArray:
        """The sum as linear sRGB (..., 3)."""
        sun = rgb_from_spectrum(self.sun, wavelength_nm, SUNLIGHT_EXPONENT)
        return sun + rgb_from_spectrum(self.sky, wavelength_nm, SKYLIGHT_EXPONENT)


def ground_radiance(field: SourceField, mu_s: ArrayLike) -> GroundLight:
    """Radiance of level ground where the sun's zenith angle has the cosine (...,).

    Lambert's albedo / pi times the irradiance of sun and sky, W m^-2 sr^-1 nm^-1.
    """
    cosine = np.asarray(mu_s, dtype=float)
    suns, light = _light_on_ground(field)
    return GroundLight(*(_interpolate(cosine, suns, part) for part in light))


@table_of_field
def _light_on_ground(field: SourceField) -> tuple[FloatArray, GroundLight]:
    """Cosines (n,) of suns, rising, and the ground's radiance (n, C) under each."""
    air = field.atmosphere
    suns = SunGrid(air, _SUNS).mu_s
    reflected = np.asarray(air.ground_albedo) / np.pi
    sun, sky = sun_on_ground(air, suns), ground_irradiance(field, suns)
    return suns, GroundLight(sun * reflected, sky * reflected)


def _interpolate(x: FloatArray, nodes: FloatArray, values: FloatArray) -> FloatArray:
    return np.stack([np.interp(x, nodes, values[:, c]) for c in range(values.shape[1])], axis=-1)


def sun_on_ground(atmosphere: Atmosphere, mu_s: FloatArray) -> FloatArray:
    """Irradiance (n, C) of level ground by the part of the sun's disc above the horizon."""
    spread = np.sin(atmosphere.sun_angular_radius_rad)
    share = np.clip(0.5 + 0.5 * mu_s / spread, 0.0, 1.0)
    visible = share * share * (3.0 - 2.0 * share)
    height = np.maximum(mu_s, 0.0)
    return np.asarray(sun_irradiance(atmosphere, 0.0, height) * (height * visible)[:, None])

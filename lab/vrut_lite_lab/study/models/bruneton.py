"""Bruneton and Neyret 2008: tables of four orders of scattering, at all 40 wavelengths.

Bruneton 2016 compares the tables of the paper; here they come from `bruneton_sky.precompute`,
whose axes are those of 2017 and whose light is solved and not gathered from table to table.
Viewers of the study stand on the ground, so that tables of two altitudes hold all there is.
"""

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from bruneton_sky import Atmosphere, Tables, TableSizes, precompute

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY

_PUBLISHED_ORDERS = 4
# The altitudes of a table are solved independently, and the ground is one of them.
_GROUND_AND_TOP = TableSizes(altitude=2, irradiance_altitude=2)


@dataclass(frozen=True, eq=False)
class Bruneton:
    """The sky of an atmosphere at the 40 wavelengths."""

    air: Atmosphere = field(default_factory=STUDY.bruneton_atmosphere)
    orders: int = _PUBLISHED_ORDERS
    name: str = "bruneton"
    title: str = "Bruneton 2008"

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40), looked up."""
        view = _unit_vectors(view_zenith_rad, relative_azimuth_rad)
        return self._seen(view, sun_zenith_rad)[0]

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,), looked up; none from a sun below the horizon."""
        sun = _unit_vectors(sun_zenith_rad, 0.0)
        return self._seen(sun, sun_zenith_rad)[1] * np.asarray(self.air.solar_irradiance)

    def _seen(self, view: FloatArray, sun_zenith_rad: float) -> tuple[FloatArray, FloatArray]:
        """Radiance and transmittance (..., C) along unit vectors (..., 3)."""
        viewer = np.array([0.0, 0.0, self.air.ground_radius_m])
        sun = _unit_vectors(sun_zenith_rad, 0.0)
        return _tables(self.air, self.orders).sky_radiance(viewer, view, sun)


@lru_cache(maxsize=4)
def _tables(air: Atmosphere, orders: int) -> Tables:
    return precompute(air, orders, sizes=_GROUND_AND_TOP)


def _unit_vectors(
    zenith_rad: float | FloatArray, relative_azimuth_rad: float | FloatArray
) -> FloatArray:
    """Unit vectors (..., 3): x toward the sun's azimuth, z up."""
    across = np.sin(zenith_rad)
    # A view at the horizon must not look into the ground by the rounding of pi / 2.
    up = np.where(np.abs(np.cos(zenith_rad)) < 1e-15, 0.0, np.cos(zenith_rad))
    level = across * np.cos(relative_azimuth_rad), across * np.sin(relative_azimuth_rad)
    return np.stack(np.broadcast_arrays(*level, up), axis=-1)

"""Nishita, Sirai, Tadamura and Nakamae 1993: single scattering between concentric spheres.

64 spheres hold equal shares of the molecules; a ray is cut where it meets them, and between two
meetings the trapezoidal rule serves both the optical depth and the scattered light. Optical paths
to the sun come from tables of 64 x 64: by sphere, and by distance from the axis through
the planet's centre along the sun's direction. They are coarse near the ground, which costs 1 mW
of RMSE. As Bruneton 2016 compares it; the light scattered at the eye itself counts as none.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from bruneton_sky.geometry import in_earth_shadow
from bruneton_sky.phase import rayleigh_phase

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY, StudyAtmosphere
from vrut_lite_lab.study.models.model import cosines

SPHERES = 64
_CYLINDERS = 64


class _Paths(NamedTuple):
    """Optical paths in m (2, spheres, cylinders) of molecules and aerosol, to the top.

    Outward from the sphere, and inward: down to the ray's lowest sphere, then up.
    """

    outward: FloatArray
    inward: FloatArray


@dataclass(frozen=True, eq=False)
class Nishita93:
    """The sky of an atmosphere, without ground."""

    air: StudyAtmosphere = STUDY
    name: str = "nishita93"
    title: str = "Nishita 1993"

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40) of light scattered once."""
        air = self.air
        mu, mu_s, nu = cosines(sun_zenith_rad, view_zenith_rad, relative_azimuth_rad)
        radius, density = self.sphere_radius_m, self.density
        ground = air.ground_radius_m
        scattered = np.zeros((2, mu.size, air.solar_irradiance.size))
        view_path, before = np.zeros((2, mu.size)), np.zeros_like(scattered)
        distance_before = np.zeros(mu.size)
        for sphere in range(1, SPHERES):
            distance = _distance_outward(ground, ground * mu, radius[sphere])
            half_m = 0.5 * (distance - distance_before)
            view_path += (density[:, sphere] + density[:, sphere - 1])[:, None] * half_m
            mu_s_there = np.clip((ground * mu_s + distance * nu) / radius[sphere], -1.0, 1.0)
            there = self.light(sphere, mu_s_there, view_path) * density[:, sphere, None, None]
            scattered += (there + before) * half_m[:, None]
            before, distance_before = there, distance
        return self._radiance(scattered, nu)

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,), by the same tables."""
        mu_s = np.array([np.cos(sun_zenith_rad)])
        return np.asarray(self.air.solar_irradiance * self.light(0, mu_s, np.zeros((2, 1)))[0])

    def light(self, sphere: int, mu_s: FloatArray, path_before_m: FloatArray) -> FloatArray:
        """Share (n, 40) of sunlight that is left behind the air before and after a sphere.

        Args:
            sphere: where the light turns from the sun's direction to the eye's.
            mu_s: cosines (n,) of the sun's zenith angle there.
            path_before_m: optical paths (2, n) from there to the eye.
        """
        air = self.air
        path = path_before_m + self._to_sun(sphere, mu_s)
        depth = path[0][:, None] * air.rayleigh_scattering + path[1][:, None] * air.mie_extinction
        altitude = self.sphere_radius_m[sphere] - air.ground_radius_m
        dark = in_earth_shadow(air.ground_radius_m, altitude, mu_s)
        return np.where(dark[:, None], 0.0, np.exp(-depth))

    @cached_property
    def sphere_radius_m(self) -> FloatArray:
        """Radii (64,) between which there are equal shares of the molecules."""
        height, thickness = self.air.rayleigh_scale_height_m, self.air.top_altitude_m
        share = np.linspace(0.0, 1.0, SPHERES)
        return self.air.ground_radius_m - height * np.log1p(np.expm1(-thickness / height) * share)

    @cached_property
    def density(self) -> FloatArray:
        """Relative densities (2, 64) of molecules and aerosol on the spheres."""
        heights = np.array([self.air.rayleigh_scale_height_m, self.air.mie_scale_height_m])
        return np.exp(-(self.sphere_radius_m - self.air.ground_radius_m) / heights[:, None])

    def _to_sun(self, sphere: int, mu_s: FloatArray) -> FloatArray:
        """Optical paths (2, n) in m to the sun, linear between the table's cylinders."""
        from_axis = self.sphere_radius_m[sphere] * np.sqrt((1.0 - mu_s) * (1.0 + mu_s))
        place = from_axis / self.air.top_radius_m * (_CYLINDERS - 1)
        nodes = np.arange(_CYLINDERS)
        tables = self._paths.outward[:, sphere], self._paths.inward[:, sphere]
        outward, inward = ([np.interp(place, nodes, row) for row in table] for table in tables)
        return np.where(mu_s >= 0.0, outward, inward)

    @cached_property
    def _paths(self) -> _Paths:
        cylinder = np.linspace(0.0, self.air.top_radius_m, _CYLINDERS)
        # The planet shades what would come through it, so the inward paths end with the grazing
        # one: its huge neighbours would darken all that is interpolated beside it.
        grazing = np.maximum(cylinder, self.air.ground_radius_m)
        outward = [self._outward(sphere, cylinder) for sphere in range(SPHERES)]
        inward = [
            self._outward(sphere, grazing) + 2.0 * self._below(sphere, grazing)
            for sphere in range(SPHERES)
        ]
        return _Paths(np.stack(outward, axis=1), np.stack(inward, axis=1))

    def _outward(self, sphere: int, cylinder_m: FloatArray) -> FloatArray:
        """Optical paths (2, n) in m from a sphere to the top, at distances (n,) from the axis."""
        start = self.sphere_radius_m[sphere]
        rmu = np.sqrt(np.maximum(start**2 - cylinder_m**2, 0.0))
        distance = np.array(
            [_distance_outward(start, rmu, r) for r in self.sphere_radius_m[sphere:]]
        )
        density = self.density[:, sphere:]
        return 0.5 * (density[:, 1:] + density[:, :-1]) @ np.diff(distance, axis=0)

    def _below(self, sphere: int, cylinder_m: FloatArray) -> FloatArray:
        """Optical paths (2, n) in m from a sphere down to the lowest point of the ray.

        Between two spheres by the trapezoid; from the lowest one that the ray meets on, the
        density of that sphere.
        """
        radius = self.sphere_radius_m[: sphere + 1, None]
        half_chord = np.sqrt(np.maximum(radius**2 - cylinder_m**2, 0.0))
        density = np.broadcast_to(self.density[:, : sphere + 1, None], (2, *half_chord.shape))
        inner = np.where(half_chord[:-1] > 0.0, density[:, :-1], density[:, 1:])
        steps = np.diff(half_chord, axis=0)
        return (0.5 * (inner + density[:, 1:]) * steps).sum(axis=1) + density[:, 0] * half_chord[0]

    def _radiance(self, scattered: FloatArray, nu: FloatArray) -> FloatArray:
        air = self.air
        rayleigh, mie = rayleigh_phase(nu), cornette_shanks_phase(nu, air.mie_g)
        by_molecules = scattered[0] * air.rayleigh_scattering * rayleigh[:, None]
        by_aerosol = scattered[1] * air.mie_scattering * mie[:, None]
        return np.asarray((by_molecules + by_aerosol) * air.solar_irradiance)


def _distance_outward(start_m: float, rmu: FloatArray, radius_m: float) -> FloatArray:
    """Distance (n,) to a sphere around a start inside it, or on it, by radius times cosine."""
    beyond = (radius_m - start_m) * (radius_m + start_m)
    return np.sqrt(np.maximum(beyond + rmu**2, 0.0)) - rmu

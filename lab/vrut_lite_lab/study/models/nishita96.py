"""Nishita, Dobashi and Nakamae 1996: the sky of 1993, and light scattered twice.

The second scattering takes the light from eight directions for that from all: the zenith, the
nadir, both horizons, the sun, the point opposite it, and the two across. Each stands for all
directions that are nearer to it than to the others; how much of that light is scattered toward
the eye is integrated over them. As Bruneton 2016 compares it.

It makes the second scattering 1.5 times as strong as it is with the sun at 67 degrees, 4 times
at 4: each horizon stands for a band of sky, and the grid's steps along it, 55 km, are far
longer than the light there comes.
"""

from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np
from bruneton_sky.geometry import distance_to_top
from bruneton_sky.phase import rayleigh_phase

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase
from vrut_lite.numeric_types import FloatArray, IntArray
from vrut_lite_lab.study.framework.atmosphere import STUDY, StudyAtmosphere
from vrut_lite_lab.study.models.in_parts import in_parts
from vrut_lite_lab.study.models.light_grid import LightGrid
from vrut_lite_lab.study.models.nishita93 import SPHERES, Nishita93

_DIRECTIONS = 8
# The whole sphere of directions, by zenith angle; twice as many by azimuth.
_ZENITHS = 32


@dataclass(frozen=True, eq=False)
class Nishita96:
    """The sky of an atmosphere over its ground.

    Args:
        quirks: look for the nearest of the eight directions as the published program does: it
            compares with another one, which makes zenith and nadir stand for all.
    """

    quirks: bool = False
    air: StudyAtmosphere = STUDY

    @property
    def name(self) -> str:
        """`nishita96`, or `nishita96-published`."""
        return "nishita96-published" if self.quirks else "nishita96"

    @property
    def title(self) -> str:
        """As in `Nishita 1996 (as published)`."""
        return "Nishita 1996" + (" (as published)" if self.quirks else "")

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40) of light scattered once and twice, and reflected between."""
        once = self._once.sky_radiance(sun_zenith_rad, view_zenith_rad, relative_azimuth_rad)
        view = _unit_vectors(view_zenith_rad, relative_azimuth_rad)
        return once + in_parts(partial(self._twice, sun_zenith_rad), view)

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,), as in 1993."""
        return self._once.sun_irradiance(sun_zenith_rad)

    @property
    def _once(self) -> Nishita93:
        return _nishita93(self.air)

    def _twice(self, sun_zenith_rad: float, view: FloatArray) -> FloatArray:
        """Radiance (n, 40) along unit vectors (n, 3): a sum over the spheres of 1993.

        Each segment's scattering is that at its far end.
        """
        air, density = self.air, self._once.density
        grids = light_grids(air, float(sun_zenith_rad))
        shares = self._shares(view, grids)
        used = [j for j in range(_DIRECTIONS) if shares[:, j].any()]
        viewer = np.array([0.0, 0.0, air.ground_radius_m])
        seen = np.zeros((len(view), air.solar_irradiance.size))
        path, before = np.zeros((2, len(view))), np.zeros(len(view))
        for sphere in range(1, SPHERES):
            altitude = self._once.sphere_radius_m[sphere] - air.ground_radius_m
            distance = distance_to_top(air.ground_radius_m, altitude, 0.0, view[:, 2])
            step = distance - before
            path += 0.5 * (density[:, sphere] + density[:, sphere - 1])[:, None] * step
            molecules, aerosol = density[:, sphere]
            scattering = np.multiply.outer(shares[0], molecules * air.rayleigh_scattering)
            scattering += np.multiply.outer(shares[1], aerosol * air.mie_scattering)
            point = viewer + distance[:, None] * view
            light = sum(grids[j].radiance(point) * scattering[j] for j in used)
            seen += np.exp(-self._depth(path)) * light * step[:, None]
            before = distance
        return seen * air.solar_irradiance

    def _shares(self, view: FloatArray, grids: tuple[LightGrid, ...]) -> FloatArray:
        """How much (2, 8, n) of each direction's light molecules and aerosol send to the eye.

        Integrals of the phase functions over all that the directions stand for.
        """
        zenith = (np.arange(_ZENITHS) + 0.5) * np.pi / _ZENITHS
        azimuth = (np.arange(2 * _ZENITHS) + 0.5) * np.pi / _ZENITHS
        around = _unit_vectors(*np.meshgrid(zenith, azimuth, indexing="ij"))
        solid_angle = np.sin(zenith)[:, None] * (np.pi / _ZENITHS) ** 2
        source = np.stack([grid.source for grid in grids])
        if self.quirks:
            nearest = _nearest_as_published(around, source)
        else:
            nearest = np.argmax(around @ source.T, axis=-1)
        weight = np.equal.outer(np.arange(_DIRECTIONS), nearest) * solid_angle
        weight = weight.reshape(_DIRECTIONS, -1)
        nu = np.clip(around.reshape(-1, 3) @ view.T, -1.0, 1.0)
        return np.stack(
            [weight @ rayleigh_phase(nu), weight @ cornette_shanks_phase(nu, self.air.mie_g)]
        )

    def _depth(self, path_m: FloatArray) -> FloatArray:
        """Optical depth (n, 40) of optical paths (2, n)."""
        molecules, aerosol = path_m[..., None]
        return np.asarray(
            molecules * self.air.rayleigh_scattering + aerosol * self.air.mie_extinction
        )


@lru_cache(maxsize=2)
def _nishita93(air: StudyAtmosphere) -> Nishita93:
    return Nishita93(air)


@lru_cache(maxsize=2)
def light_grids(air: StudyAtmosphere, sun_zenith_rad: float) -> tuple[LightGrid, ...]:
    """Grids of light from the eight directions."""
    right = np.pi / 2
    zenith = 0.0, np.pi, right, -right
    sun = (sun_zenith_rad + turn for turn in (0.0, np.pi, -right, right))
    return tuple(LightGrid(air, sun_zenith_rad, each) for each in (*zenith, *sun))


def _nearest_as_published(around: FloatArray, source: FloatArray) -> IntArray:
    """Which direction stands for which (32, 64): 0, the zenith, or 1, the nadir.

    Candidates are compared at the number of the zenith angle in their own's place, so that all
    seven look alike and the first is taken. Beyond the eighth the program reads what lies
    behind its directions in memory: 0 here, by which the lower half of the sphere is the
    nadir's, as it ought to be.
    """
    read = np.zeros((_ZENITHS, 3))
    read[:_DIRECTIONS] = source
    compared = (around * read[:, None]).sum(axis=-1)
    return np.asarray(compared > around[..., 2], dtype=np.int64)


def _unit_vectors(zenith_rad: FloatArray, relative_azimuth_rad: FloatArray) -> FloatArray:
    """Unit vectors (..., 3): x toward the sun's azimuth, z up."""
    across = np.sin(zenith_rad)
    level = across * np.cos(relative_azimuth_rad), across * np.sin(relative_azimuth_rad)
    return np.stack([*level, np.cos(zenith_rad)], axis=-1)

"""Light scattered once that arrives from one direction, on a grid of points around the viewer.

Nishita, Dobashi and Nakamae 1996, "Display of Clouds Taking into Account Multiple Anisotropic
Scattering and Sky Light", keep it in a box of 33 x 33 x 33 points whose edges follow the light:
so the grid's lines are rays, and one march along each of them fills the box. The box stands on
the plane that touches the ground at the viewer and reaches as far as the air at the horizon
does; it is sheared where the light comes aslant.

Coordinates have their origin in the planet's centre, z up through the viewer and x toward the
sun's azimuth. The sun lies in the plane y = 0, and so does all that light comes from: the half
of the box with y >= 0 tells all.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from bruneton_sky.geometry import in_earth_shadow
from bruneton_sky.optical_path import optical_depth_to_top
from bruneton_sky.phase import rayleigh_phase
from bruneton_sky.tables.interpolate import interpolate
from bruneton_sky.tables.parametrisations import texture_coordinate

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import StudyAtmosphere

POINTS = 33
_HALF = POINTS // 2 + 1


class _Lines(NamedTuple):
    """Lines along the light: first points (33, 17, 3), the points' distance in m, a direction."""

    start: FloatArray
    step_m: float
    direction: FloatArray


class _Air(NamedTuple):
    """The air at points: extinction (..., 40) in 1/m, sunlight (..., 40) that arrives
    there, as a share, and that which it scatters along the lines, in 1/(m sr)."""

    extinction: FloatArray
    sunlight: FloatArray
    scattered: FloatArray


@dataclass(frozen=True, eq=False)
class LightGrid:
    """Light from one direction, under one sun.

    Args:
        sun_zenith_rad: of the sun, at the viewer.
        from_zenith_rad: where the light comes from, at the viewer: positive on the sun's side,
            negative or beyond pi on the other.
    """

    air: StudyAtmosphere
    sun_zenith_rad: float
    from_zenith_rad: float

    @cached_property
    def source(self) -> FloatArray:
        """Unit vector (3,) toward where the light comes from."""
        return _in_suns_plane(self.from_zenith_rad)

    def radiance(self, point_m: FloatArray) -> FloatArray:
        """Radiance (n, 40) per unit of solar irradiance, in 1/sr, at points (n, 3).

        Linear between the grid's points; outside the box it stays as on its faces.
        """
        x, y, z = point_m.T
        height = (z - self.air.ground_radius_m) / self.air.top_altitude_m
        if self._is_level:
            across, along = height, 0.5 * (1.0 - x * self.source[0] / self._reach_m)
        else:
            lean_m = self._slope * height * self.air.top_altitude_m
            across = 0.5 * (1.0 + (x - lean_m) / self._reach_m)
            along = 1.0 - height if self.source[2] > 0.0 else height
        places = (across, POINTS), (np.abs(y) / self._reach_m, _HALF), (along, POINTS)
        return interpolate(self._table, [texture_coordinate(*place) for place in places])

    @property
    def _is_level(self) -> bool:
        return bool(abs(self.source[2]) < 1e-12)

    @property
    def _slope(self) -> float:
        """Shift of the box toward x per metre of height."""
        return float(self.source[0] / self.source[2])

    @cached_property
    def _reach_m(self) -> float:
        """Half the box's length and width: the distance to the top of the air at the horizon."""
        top_m, air = self.air.top_altitude_m, self.air
        return float(np.sqrt(top_m * (air.top_radius_m + air.ground_radius_m)))

    @cached_property
    def _table(self) -> FloatArray:
        """Radiance (33, 17, 33, 40) per unit of solar irradiance, at the points of the lines."""
        lines = self._lines()
        table = np.zeros((POINTS, _HALF, POINTS, self.air.solar_irradiance.size))
        for index, arriving in self._march(lines):
            if index >= 0:
                table[:, :, index] = arriving
        return table

    def _lines(self) -> _Lines:
        reach, top = self._reach_m, self.air.top_altitude_m
        first = np.linspace(0.0, 1.0, POINTS)[:, None]
        y = np.linspace(0.0, reach, _HALF)
        if self._is_level:
            x, height, length = reach * self.source[0], top * first, 2.0 * reach
        else:
            base = top if self.source[2] > 0.0 else 0.0
            height, length = np.full_like(first, base), top / abs(self.source[2])
            x = (2.0 * first - 1.0) * reach + self._slope * base
        start = np.stack(np.broadcast_arrays(x, y, self.air.ground_radius_m + height), axis=-1)
        return _Lines(start, float(length) / (POINTS - 1), -self.source)

    def _march(self, lines: _Lines) -> Iterator[tuple[int, FloatArray]]:
        """What arrives (33, 17, 40) at the lines' points; their numbers below 0 lie outside.

        By the trapezoidal rule, from where a line enters the air or leaves the ground.
        """
        begin, end = self._in_the_air(lines)
        lit = begin < end
        before = self._at(lines, begin)
        light = np.where(lit[..., None], self._reflected(lines, begin, before.sunlight), 0.0)
        distance = begin
        for index in range(int(np.floor(begin.min(initial=0.0) / lines.step_m)), POINTS):
            met = index * lines.step_m
            # One point beyond the ground, for those between it and the last above.
            passed = (lit & (met >= begin) & (met < end + lines.step_m))[..., None]
            here = self._at(lines, np.full_like(begin, met))
            half_m = 0.5 * (met - distance)[..., None]
            clear = np.exp(-(here.extinction + before.extinction) * np.maximum(half_m, 0.0))
            gathered = (here.scattered + clear * before.scattered) * half_m
            light = np.where(passed, gathered + clear * light, light)
            yield index, np.where(passed, light, 0.0)
            before = _Air(*(np.where(passed, a, b) for a, b in zip(here, before, strict=True)))
            distance = np.where(passed[..., 0], met, distance)

    def _in_the_air(self, lines: _Lines) -> tuple[FloatArray, FloatArray]:
        """Distances (33, 17) along lines to where they enter the air and leave it.

        Of two pieces, beyond the ground and before it, the one nearer ahead of the first point.
        Both are 0 for a line that has left the air before its first point, or never meets it.
        """
        along = (lines.start * lines.direction).sum(axis=-1)
        radius_squared = (lines.start**2).sum(axis=-1)
        across = radius_squared - along**2
        top = np.sqrt(np.maximum(self.air.top_radius_m**2 - across, 0.0))
        ground = np.sqrt(np.maximum(self.air.ground_radius_m**2 - across, 0.0))
        from_ground = (ground > 0.0) & (ground - along <= 0.0)
        to_ground = (ground > 0.0) & (-along - ground >= 0.0)
        begin = np.where(from_ground, ground, -top) - along
        end = np.where(to_ground, -ground, top) - along
        outside = radius_squared >= self.air.top_radius_m**2
        met = (top > 0.0) & ~(outside & (begin < 0.0))
        return np.where(met, begin, 0.0), np.where(met, end, 0.0)

    def _at(self, lines: _Lines, distance_m: FloatArray) -> _Air:
        """The air at distances (33, 17) along the lines; below the ground it is as on it."""
        air, sun = self.air, _in_suns_plane(self.sun_zenith_rad)
        point = lines.start + distance_m[..., None] * lines.direction
        radius = np.linalg.norm(point, axis=-1)
        altitude = np.clip(radius - air.ground_radius_m, 0.0, air.top_altitude_m)
        mu_s = point @ sun / radius
        depth = optical_depth_to_top(air.bruneton_atmosphere(), altitude, mu_s)
        dark = in_earth_shadow(air.ground_radius_m, altitude, mu_s)
        sunlight = np.where(dark[..., None], 0.0, np.exp(-depth))
        molecules = np.exp(-altitude / air.rayleigh_scale_height_m)[..., None]
        aerosol = np.exp(-altitude / air.mie_scale_height_m)[..., None]
        nu = float(self.source @ sun)
        scattering = molecules * air.rayleigh_scattering * rayleigh_phase(nu)
        scattering += aerosol * air.mie_scattering * cornette_shanks_phase(nu, air.mie_g)
        extinction = molecules * air.rayleigh_scattering + aerosol * air.mie_extinction
        return _Air(extinction, sunlight, scattering * sunlight)

    def _reflected(self, lines: _Lines, begin_m: FloatArray, sunlight: FloatArray) -> FloatArray:
        """Radiance (33, 17, 40) of the ground where lines begin there, else 0."""
        point = lines.start + begin_m[..., None] * lines.direction
        radius = np.linalg.norm(point, axis=-1)
        mu_s = point @ _in_suns_plane(self.sun_zenith_rad) / radius
        on_ground = radius < 0.5 * (self.air.ground_radius_m + self.air.top_radius_m)
        falling = np.where(on_ground, np.maximum(mu_s, 0.0), 0.0)[..., None] * sunlight
        return np.asarray(falling * self.air.ground_albedo / np.pi)


def _in_suns_plane(zenith_rad: float) -> FloatArray:
    return np.array([np.sin(zenith_rad), 0.0, np.cos(zenith_rad)])

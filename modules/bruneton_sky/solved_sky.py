"""The accurate sky in Python: an atmosphere is solved once, and its light asked for anywhere."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.background import background_cube, surroundings
from bruneton_sky.field_tables import table_of_field
from bruneton_sky.geometry import rays_in_air
from bruneton_sky.ground_light import SKYLIGHT_EXPONENT
from bruneton_sky.ray_light import light_along, polarised_light_along
from bruneton_sky.solver import SourceField
from bruneton_sky.solver import solve as solve_source
from bruneton_sky.solver.view import sky_irradiance
from bruneton_sky.solver_job import solve_air
from bruneton_sky.sun_light import seen_irradiance
from vrut_lite.arguments import (
    as_count,
    as_number,
    as_numbers,
    as_vectors,
    broadcast,
    check_type,
)
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.preview import fisheyes_png
from vrut_lite.numeric_types import FloatArray

_FARTHEST_M = 1e15
# In notebooks: noon, evening, sunset, dusk.
_SHOWN_SUNS_DEG = (60.0, 20.0, 2.0, -4.0)
# Tolerance of cosines beyond 1: they may come from single precision.
_SINGLE_ROUNDING = 1e-6
# Change of nu's range by rounding mu to single precision.
_ANGLE_SLACK = 1e-3
_LARGEST_CUBE = 8192
# Directions over which irradiance is summed: twice as many each way as for a picture, whose light
# errs by 0.4 % in haze (these: 0.1 %).
_IRRADIANCE_SIZES = {"irradiance_mu": 32, "irradiance_azimuth": 24}
# In twilight the planet's shadow cuts through the rays: with as many bins as by day a sky 6 degrees
# after sunset is 3 % too dark.
_TWILIGHT_BELOW_MU_S, _TWILIGHT_BINS = 0.1, 96
_ROUNDING = 1e-15
# Rays times wavelengths of a batch: they fit a processor's cache.
_BATCH = 3000


def solve(atmosphere: Atmosphere) -> "SolvedSky":
    """The sky of an atmosphere: all orders of scattering, for every observer and every sun.

    The solver is that of the module's own pictures (`bruneton_sky.solver`, sizes for the air at
    hand): some 0.1 s for up to four wavelengths of clear air, as much for every four more, more in
    haze and fog; the first call on a machine compiles for some 15 s. For other sizes or orders:
    `SolvedSky(field=bruneton_sky.solver.solve(...))`.

    Args:
        atmosphere: any number of wavelengths, fog included.

    Raises:
        ValueError: this is no `Atmosphere`.
    """
    check_type("atmosphere", atmosphere, Atmosphere)
    return SolvedSky(field=solve_air(atmosphere))


@dataclass(frozen=True, kw_only=True, eq=False)
class SolvedSky:
    """The light of a solved atmosphere, from the ground to space; made by `solve`.

    Arguments are numbers or arrays that broadcast to a shape (...,):

    * `altitude_m`: of the observer above the ground, from 0; above the atmosphere too.
    * `mu`, `mu_s`: cosines of the zenith angles of the view and of the sun, at the observer.
    * `nu`: cosine of the angle between view and sun, between the cosines of the sum and of the
      difference of the zenith angles.

    Spectral results are (..., C), one value per wavelength of the atmosphere. The sun is a point
    for the air that it lights, the ground a Lambertian sphere of the atmosphere's albedo.

    Accuracy of scalar transfer, against scalar Monte Carlo of the same optics: in clear air by day,
    from the ground to 300 km, the rms error of radiance is that of the reference (0.06 to 0.3 %),
    and no ray errs by more than 0.2 % beyond three standard errors; with the sun 0 to 6 degrees
    below the horizon 1 to 2 % rms, in haze of turbidity 3 0.2 to 0.7 %, of turbidity 10 0.6 to 2.3
    %, in fog 1 to 3 %. Sky irradiance by day is within 0.4 %, in twilight that of its radiance.
    Light is polarised: docs/polarisation.md says what scalar transfer misses. A ray takes 0.04 ms
    at three wavelengths.

    Raises:
        ValueError: in every method, a value is out of range or no number, or shapes do not
            broadcast; the sentence names the argument.
    """

    field: SourceField

    @property
    def atmosphere(self) -> Atmosphere:
        """The solved atmosphere."""
        return self.field.atmosphere

    def _repr_png_(self) -> bytes | None:
        """Fisheyes under suns in the south, for notebooks; None without colours."""
        suns = np.radians(_SHOWN_SUNS_DEG)
        try:
            cubes = [self.cube_map(128, (0.0, np.sin(sun), np.cos(sun))) for sun in suns]
        except ValueError:
            return None
        return fisheyes_png(cubes)

    def radiance(
        self, altitude_m: ArrayLike, mu: ArrayLike, mu_s: ArrayLike, nu: ArrayLike
    ) -> FloatArray:
        """Radiance (..., C) of the air along whole rays, all orders, W m^-2 sr^-1 nm^-1.

        Without the sun's disc. A ray that meets the ground ends there; the ground's own radiance
        is not part of it, the light that it has sent into the air is (as in `single_scattering`
        and `Tables.sky_radiance`). 0 where a ray from space misses the atmosphere.
        """
        return self._light(altitude_m, mu, mu_s, nu)[0]

    def radiance_rgb(
        self, altitude_m: ArrayLike, mu: ArrayLike, mu_s: ArrayLike, nu: ArrayLike
    ) -> FloatArray:
        """`radiance` (..., 3) in linear sRGB, W m^-2 sr^-1; below 0 outside the gamut.

        Raises:
            ValueError: the atmosphere's wavelengths make no colour (`rgb_from_spectrum`).
        """
        radiance = self.radiance(altitude_m, mu, mu_s, nu)
        return rgb_from_spectrum(radiance, self.atmosphere.wavelength_nm, SKYLIGHT_EXPONENT)

    def radiance_to_point(
        self,
        altitude_m: ArrayLike,
        mu: ArrayLike,
        mu_s: ArrayLike,
        nu: ArrayLike,
        distance_m: ArrayLike,
    ) -> tuple[FloatArray, FloatArray]:
        """Radiance (..., C) of the air before points along rays, and transmittance (..., C).

        A point that the ground hides counts as the ground in front of it.

        Args:
            distance_m: (...,) from the observer to the points, at least 0.
        """
        distance = as_numbers("distance_m", distance_m, 0.0, _FARTHEST_M, "m")
        return self._light(altitude_m, mu, mu_s, nu, distance)

    def stokes(
        self, altitude_m: ArrayLike, mu: ArrayLike, mu_s: ArrayLike, nu: ArrayLike
    ) -> FloatArray:
        """Stokes's I, Q, U (..., C, 3) of the air along whole rays, W m^-2 sr^-1 nm^-1.

        I is `radiance`. By the vertical plane of the view, Q > 0 is light that vibrates in it,
        U > 0 light that vibrates 45 degrees counter-clockwise from it, as the observer sees it. In
        the zenith and the nadir that plane is the sun's. `nu` leaves open on which side of the sun
        the view is: U is that of views clockwise from the sun, seen from above; on the other side
        it has the other sign. The ground's light is not part of it. Q^2 + U^2 is at most I^2.

        The first call solves a sky with few or no polarised orders again, with all of them.
        """
        radiance = self.radiance(altitude_m, mu, mu_s, nu)
        starts = [part.ravel() for part in _rays(altitude_m, mu, mu_s, nu)]
        polarised = np.zeros((2, starts[0].size, radiance.shape[-1]))
        field = with_polarised_orders(self.field)
        for some, ways in self._ways_in_air(*starts):
            polarised[:, some] = polarised_light_along(field, *ways)
        q, u = polarised.reshape(2, *radiance.shape)
        length = np.hypot(q, u)
        most = np.minimum(length, (1.0 - _ROUNDING) * radiance)
        share = np.divide(most, length, out=np.zeros_like(length), where=length > 0.0)
        return np.stack([radiance, share * q, share * u], axis=-1)

    def polarisation(
        self, altitude_m: ArrayLike, mu: ArrayLike, mu_s: ArrayLike, nu: ArrayLike
    ) -> tuple[FloatArray, FloatArray]:
        """Degree of linear polarisation (..., C) from 0 to 1, and its angle (..., C) in radians.

        The angle is that of the vibration, counter-clockwise from the vertical plane as the
        observer sees it, from -pi / 2 to pi / 2, for views clockwise from the sun: see `stokes`.
        Where there is no light both are 0.
        """
        radiance, q, u = np.moveaxis(self.stokes(altitude_m, mu, mu_s, nu), -1, 0)
        degree = np.divide(np.hypot(q, u), radiance, out=np.zeros_like(q), where=radiance > 0.0)
        return degree, 0.5 * np.arctan2(u, q)

    def irradiance(self, altitude_m: ArrayLike, mu_s: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Irradiance (..., C) of the sun and of the sky, W m^-2 nm^-1.

        The sun's is behind the air, on a plane that faces it, of the part of its disc above the
        horizon. The sky's is of all orders, on a level surface that faces up.
        """
        air = self.atmosphere
        altitude, sun = broadcast(altitude_m=_altitudes(altitude_m), mu_s=_cosines("mu_s", mu_s))
        heights, suns = altitude.ravel(), sun.ravel()
        disc, sky = np.zeros((2, heights.size, len(air.wavelength_nm)))
        for part in self._batches(heights.size):
            disc[part] = seen_irradiance(air, heights[part], suns[part])
        sizes = self.field.sizes
        steps = max(sizes.steps, _TWILIGHT_BINS)
        field = replace(self.field, sizes=replace(sizes, steps=steps, **_IRRADIANCE_SIZES))
        low = suns < _TWILIGHT_BELOW_MU_S
        for chosen, bins in ((low, _TWILIGHT_BINS), (~low, sizes.single_bins)):
            # Above the top of the atmosphere the sky is dark.
            for height in np.unique(heights[chosen & (heights < air.top_altitude_m)]):
                same = chosen & (heights == height)
                sky[same] = sky_irradiance(field, np.array([height]), suns[same], bins)[0]
        shape = (*altitude.shape, len(air.wavelength_nm))
        return disc.reshape(shape), sky.reshape(shape)

    def cube_map(
        self,
        size: int = 256,
        sun_direction: ArrayLike = (0.0, 0.7, -0.7),
        altitude_m: float = 0.0,
    ) -> NDArray[np.float32]:
        """Radiance (6, size, size, 3) float32 of sky and ground, linear sRGB, W m^-2 sr^-1.

        OpenGL face order +X -X +Y -Y +Z -Z, world axes (+Y up, -Z north), row 0 at t = 0; without
        the sun's disc. Up to 10 m the half below the horizon is bare ground, albedo E / pi with
        the direct sun in E; above that it is seen through the air. Colours outside the gamut are
        clamped at 0. This is the fast sky-view table of the module's pictures, within 0.3 % of
        `radiance_rgb` in the mean by day.

        Args:
            size: texels along an edge, 1 to 8192.
            sun_direction: (3,) to the sun in world axes, of any length but 0.
            altitude_m: of the observer.
        """
        size = as_count("size", size, 1, _LARGEST_CUBE)
        direction = as_vectors("sun_direction", sun_direction, 1e100)
        if direction.shape != (3,) or not direction.any():
            raise ValueError(
                f"sun_direction must be one vector (3,) other than 0, not {direction.tolist()}"
            )
        altitude = as_number("altitude_m", altitude_m, 0.0, _FARTHEST_M, "m")
        return background_cube(surroundings(self.field, altitude, direction), size)

    def _light(
        self,
        altitude_m: ArrayLike,
        mu: ArrayLike,
        mu_s: ArrayLike,
        nu: ArrayLike,
        distance_m: FloatArray | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        rays = _rays(altitude_m, mu, mu_s, nu, distance_m)
        shape = (*rays[0].shape, len(self.atmosphere.wavelength_nm))
        starts = [part.ravel() for part in rays]
        radiance = np.zeros((starts[0].size, shape[-1]))
        transmittance = np.ones_like(radiance)
        for some, ways in self._ways_in_air(*starts):
            radiance[some], transmittance[some] = light_along(self.field, *ways)
        return radiance.reshape(shape), transmittance.reshape(shape)

    def _ways_in_air(
        self,
        altitude_m: FloatArray,
        mu: FloatArray,
        mu_s: FloatArray,
        nu: FloatArray,
        distance_m: FloatArray | float = np.inf,
    ) -> Iterator[tuple[NDArray[np.intp], tuple[FloatArray, ...]]]:
        """Batches of the rays (n,) that are in air: which they are, their starts and lengths."""
        _check_angles(mu, mu_s, nu)
        air = self.atmosphere
        inside = rays_in_air(air.ground_radius_m, air.top_altitude_m, altitude_m, mu, mu_s, nu)
        within = np.maximum(distance_m - inside.entry_m, 0.0)
        ways = inside.altitude_m, inside.mu, inside.mu_s, nu, within
        seen = np.flatnonzero(~inside.misses)
        for part in self._batches(seen.size):
            yield seen[part], tuple(values[seen[part]] for values in ways)

    def _batches(self, count: int) -> Iterator[slice]:
        step = max(_BATCH // len(self.atmosphere.wavelength_nm), 1)
        return (slice(start, start + step) for start in range(0, count, step))


def with_polarised_orders(field: SourceField) -> SourceField:
    """The field with Q and U of all orders; solved here if the sky has none."""
    return field if field.polarised is not None else _polarised(field)


@table_of_field
def _polarised(field: SourceField) -> SourceField:
    sizes = replace(field.sizes, polarised_orders=None)
    return solve_source(field.atmosphere, sizes=sizes, all_orders=True)


def _altitudes(altitude_m: ArrayLike) -> FloatArray:
    return as_numbers("altitude_m", altitude_m, 0.0, _FARTHEST_M, "m")


def _rays(
    altitude_m: ArrayLike,
    mu: ArrayLike,
    mu_s: ArrayLike,
    nu: ArrayLike,
    distance_m: FloatArray | None = None,
) -> tuple[FloatArray, ...]:
    """The arguments (...,) of rays, checked; distances only if there are any."""
    cosines = {"mu": mu, "mu_s": mu_s, "nu": nu}
    arguments = {"altitude_m": _altitudes(altitude_m)}
    arguments |= {name: _cosines(name, value) for name, value in cosines.items()}
    if distance_m is not None:
        arguments["distance_m"] = distance_m
    return broadcast(**arguments)


def _check_angles(mu: FloatArray, mu_s: FloatArray, nu: FloatArray) -> None:
    """Refuse angles (n,) between view and sun that no azimuth makes."""
    most = np.sqrt((1.0 - mu**2).clip(0.0) * (1.0 - mu_s**2).clip(0.0))
    impossible = np.flatnonzero(np.abs(nu - mu * mu_s) > most + _ANGLE_SLACK)
    if impossible.size:
        n = impossible[0]
        raise ValueError(
            f"nu must lie within mu * mu_s +- sqrt((1 - mu^2) (1 - mu_s^2)), which no view of a "
            f"sun can leave: not {nu[n]:.6g} at mu {mu[n]:.6g} and mu_s {mu_s[n]:.6g}"
        )


def _cosines(name: str, value: ArrayLike) -> FloatArray:
    return as_numbers(name, value, -1.0, 1.0, slack=_SINGLE_ROUNDING)

"""Backward Monte Carlo path tracer: the reference for light scattered more than once.

Unbiased in every order, on any planet, in float64: spherical shells, point sun, sharp planet
shadow, Lambertian ground; no refraction. Its transmittances are the closed forms of
`optical_path`; nothing is tabulated. Reflections by the ground count as scatterings.

`monte_carlo_stokes` traces polarised light (I, Q, U), the others light that does not polarise: the
same paths with phase functions in place of scattering matrices. With equal seeds the two share
their random numbers, so that their ratio has less noise than either.

Noise: every estimate is made BATCHES times from independent scrambled Sobol points (Owen 1995),
which serve the first events of each path; the standard error is that of the batches' mean.

Importing this module imports numba.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypedDict, Unpack

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import make_ray, rays_in_air
from bruneton_sky.optical_path import optical_depth
from numpy.typing import ArrayLike

from vrut_lite.arguments import ROUNDING, as_count, as_number, as_numbers, broadcast
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.monte_carlo.medium import Medium, medium_of
from vrut_lite_lab.monte_carlo.paths import trace

Start = Callable[[FloatArray], tuple[FloatArray, FloatArray, FloatArray]]
BATCHES = 16
# Events of each path that take their three numbers from a Sobol sequence.
SOBOL_EVENTS = 4
# Length of Sobol's sequence.
_MOST_PATHS = 1 << 30


class PathOptions(TypedDict, total=False):
    """Options of paths along rays.

    Attributes:
        paths: per ray (4096), rounded up to BATCHES times a power of two.
        seed: equal seeds give equal results; ray i depends on the seed (0) and i alone.
        max_order: the last separate order (10); higher ones are added to it.
        ground_seen: include the radiance of the ground at the end of the ray.
    """

    paths: int
    seed: int
    max_order: int
    ground_seen: bool


@dataclass(frozen=True)
class MonteCarloEstimate:
    """Estimates of n quantities by order of scattering, as independent batches of paths.

    Attributes:
        batches: (BATCHES, n, orders, C); order k stands at index k - 1, and the last index
            holds its order and all beyond.
    """

    batches: FloatArray

    @property
    def per_order(self) -> FloatArray:
        """Means (n, orders, C)."""
        return self.batches.mean(axis=0)

    @property
    def standard_error(self) -> FloatArray:
        """Standard errors (n, orders, C) of `per_order`, each itself uncertain by 18 %.

        They are more uncertain, and too small, where few paths carry most light: from the sixth
        order on, and in the planet's shadow.
        """
        return _standard_error(self.batches)

    def total(self, first_order: int = 1) -> FloatArray:
        """Sum (n, C) of the orders from `first_order` on."""
        return self.per_order[:, first_order - 1 :].sum(axis=1)

    def total_error(self, first_order: int = 1) -> FloatArray:
        """Standard error (n, C) of `total`: the orders of one path are not independent."""
        return _standard_error(self.batches[:, :, first_order - 1 :].sum(axis=2))


def monte_carlo_radiance(
    atmosphere: Atmosphere,
    altitude_m: ArrayLike,
    mu: ArrayLike,
    mu_s: ArrayLike,
    nu: ArrayLike,
    **options: Unpack[PathOptions],
) -> MonteCarloEstimate:
    """Radiance along n rays by order of scattering, W m^-2 sr^-1 nm^-1, of scalar transfer.

    The arguments of rays broadcast to (n,). An observer above the atmosphere looks into it from
    outside; where the ray misses it, the radiance is zero.

    Args:
        atmosphere: C wavelengths.
        altitude_m: of the observer, from 0 up; also above the atmosphere.
        mu: cosine of the view direction's zenith angle.
        mu_s: cosine of the sun's zenith angle.
        nu: cosine of the angle between view direction and sun.
        options: of the paths.

    Raises:
        ValueError: an argument is outside its range or not a number.
    """
    return _along_rays(atmosphere, 1, (altitude_m, mu, mu_s, nu), **options)[0]


def monte_carlo_stokes(
    atmosphere: Atmosphere,
    altitude_m: ArrayLike,
    mu: ArrayLike,
    mu_s: ArrayLike,
    nu: ArrayLike,
    **options: Unpack[PathOptions],
) -> tuple[MonteCarloEstimate, MonteCarloEstimate, MonteCarloEstimate]:
    """Stokes parameters I, Q and U along n rays, W m^-2 sr^-1 nm^-1, of vector transfer.

    By the vertical plane of the view, Q > 0 is light that vibrates in it, U > 0 light that vibrates
    45 degrees counter-clockwise from it, as the observer sees it, for views clockwise from the sun,
    seen from above; on the other side U has the other sign. V is left out: particles make 1e-4 of I
    of it. Arguments and errors are those of `monte_carlo_radiance`.
    """
    i, q, u = _along_rays(atmosphere, 3, (altitude_m, mu, mu_s, nu), **options)
    return i, q, u


def _along_rays(
    atmosphere: Atmosphere,
    parameters: int,
    rays: tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike],
    *,
    paths: int = 4096,
    seed: int = 0,
    max_order: int = 10,
    ground_seen: bool = False,
) -> list[MonteCarloEstimate]:
    """Estimates of I, or with 3 parameters I, Q, U, along rays: altitude_m, mu, mu_s, nu."""
    medium = medium_of(atmosphere, parameters > 1)
    tracer = _Tracer(medium, paths, seed, max_order, parameters)
    cosines = dict(zip(("mu", "mu_s", "nu"), rays[1:], strict=True))
    whole = broadcast(
        altitude_m=as_numbers("altitude_m", rays[0], 0.0),
        **{name: as_numbers(name, v, -1.0, 1.0, slack=ROUNDING) for name, v in cosines.items()},
    )
    altitude, view, sun_s, cosine = (np.atleast_1d(v).ravel() for v in whole)
    heights, view, sun_s = enter_atmosphere(atmosphere, altitude, view, sun_s, cosine)
    batches = tracer.zeros(altitude.size)
    for i in np.flatnonzero(np.isfinite(heights)):
        direction, sun = _view_and_sun(view[i], sun_s[i], cosine[i])
        start = partial(_from_eye, heights[i], direction)
        batches[:, :, i] = tracer.run(int(i), 0, start, sun, ground_seen)
    return [MonteCarloEstimate(each * np.asarray(atmosphere.solar_irradiance)) for each in batches]


def monte_carlo_irradiance(
    atmosphere: Atmosphere,
    mu_s: ArrayLike,
    *,
    altitude_m: float = 0.0,
    paths: int = 4096,
    seed: int = 0,
    max_order: int = 10,
) -> MonteCarloEstimate:
    """Irradiance of the sky without the sun on a level surface, W m^-2 nm^-1, for n suns.

    Order k is light that was scattered k times before. The other arguments are those of
    `monte_carlo_radiance`; the altitude lies inside the atmosphere.
    """
    suns = np.atleast_1d(as_numbers("mu_s", mu_s, -1.0, 1.0))
    altitude_m = as_number("altitude_m", altitude_m, 0.0, atmosphere.top_altitude_m, "m")
    tracer = _Tracer(medium_of(atmosphere, False), paths, seed, max_order, 1)
    batches = tracer.zeros(suns.size)[0]
    start = partial(_from_surface, altitude_m)
    for i, cosine in enumerate(suns):
        sun = np.array([np.sqrt((1.0 - cosine) * (1.0 + cosine)), 0.0, cosine])
        batches[:, i] = tracer.run(i, 2, start, sun, False)[0]
    # Directions are drawn with the density cosine / pi.
    return MonteCarloEstimate(np.pi * batches * np.asarray(atmosphere.solar_irradiance))


def monte_carlo_leaving(
    atmosphere: Atmosphere, *, paths: int = 16384, seed: int = 0, max_order: int = 10
) -> MonteCarloEstimate:
    """Share of the sunlight entering the atmosphere that leaves it scattered or reflected.

    n is 1. With `unscattered_share` this sums to 1 where nothing absorbs.
    """
    tracer = _Tracer(medium_of(atmosphere, False), paths, seed, max_order, 1)
    batches = tracer.zeros(1)[0]
    start = partial(_from_outside, atmosphere.top_altitude_m)
    batches[:, 0] = tracer.run(0, 3, start, np.array([0.0, 0.0, 1.0]), True)[0]
    # The mean radiance L over the top's sphere and, by cosine, over directions sends out
    # 4 pi r^2 pi L; pi r^2 times the solar irradiance comes in.
    return MonteCarloEstimate(4.0 * np.pi * batches)


def unscattered_share(atmosphere: Atmosphere, nodes: int = 64) -> FloatArray:
    """Share (C,) of the entering sunlight that passes the planet without an event."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    top = atmosphere.top_altitude_m
    perigee = 0.5 * top * (x + 1.0)
    outer = atmosphere.ground_radius_m + top
    distance = atmosphere.ground_radius_m + perigee
    cosine = np.sqrt((top - perigee) * (outer + distance)) / outer
    ray = make_ray(atmosphere.ground_radius_m, top, -cosine)
    depth = optical_depth(atmosphere, ray, np.asarray(top), -ray.y)
    ring = 0.5 * top * weight * 2.0 * distance / outer**2
    return np.asarray((ring[:, None] * np.exp(-depth)).sum(axis=0))


def enter_atmosphere(
    atmosphere: Atmosphere,
    altitude_m: FloatArray,
    mu: FloatArray,
    mu_s: FloatArray,
    nu: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Altitude, mu and mu_s (n,) where rays (n,) from any altitude are first inside the air.

    NaN where a ray from above misses the atmosphere; unchanged where it starts inside.
    """
    planet = atmosphere.ground_radius_m, atmosphere.top_altitude_m
    rays = rays_in_air(*planet, altitude_m, np.clip(mu, -1.0, 1.0), mu_s, nu)
    altitude, view, sun = (np.where(rays.misses, np.nan, part) for part in rays[:3])
    return altitude, view, np.clip(sun, -1.0, 1.0)


class _Tracer:
    """The common part of estimates in one medium: its parameters, the batches, the seeds.

    It measures I, or with `parameters` 3 I, Q and U.
    """

    def __init__(
        self, medium: Medium, paths: int, seed: int, max_order: int, parameters: int
    ) -> None:
        as_count("paths", paths, 1, _MOST_PATHS)
        as_count("max_order", max_order, 1, 1000)
        self._medium = medium
        self._log2_paths = max(int(np.ceil(np.log2(paths / BATCHES))), 0)
        self._seed = seed
        self._parameters = parameters
        self._shape = max_order, medium.albedo.size

    def zeros(self, count: int) -> FloatArray:
        """Batches (parameters, BATCHES, count, orders, C) to be filled."""
        return np.zeros((self._parameters, BATCHES, count, *self._shape))

    def run(
        self, index: int, extra: int, start: Start, sun: FloatArray, may_land: bool
    ) -> FloatArray:
        """Batches (parameters, BATCHES, orders, C) of one quantity.

        Args:
            index: of the quantity; with the seed it makes the random numbers.
            extra: number of uniform numbers for the start of a path.
            start: altitudes (n,), zeniths (n, 3) and directions (n, 3) from those (n, extra).
            sun: unit vector (3,) toward the sun.
            may_land: whether a path may go to the ground at once.
        """
        from scipy.stats.qmc import Sobol  # Here: its import takes longer than this package's.

        orders, wavelengths = self._shape
        means = np.zeros((BATCHES, orders, self._parameters, wavelengths))
        for batch, mean in enumerate(means):
            words = np.random.SeedSequence((self._seed, index, batch)).generate_state(2)
            points = Sobol(extra + 3 * SOBOL_EVENTS, seed=int(words[0])).random_base2(
                self._log2_paths
            )
            altitudes, zeniths, directions = start(points[:, :extra])
            radii = self._medium.radius + altitudes[:, None]
            numbers = points[:, extra:].reshape(-1, SOBOL_EVENTS, 3)
            trace(
                self._medium, altitudes, zeniths * radii, directions, sun,
                np.ascontiguousarray(numbers), int(words[1]), may_land, mean,
            )  # fmt: skip
        per_path = means / (2**self._log2_paths * self._medium.importance)
        return per_path.transpose(2, 0, 1, 3)


def _from_eye(
    altitude_m: float, direction: FloatArray, uniform: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """All paths start at one point in one direction."""
    ones = np.ones((len(uniform), 1))
    return altitude_m * ones[:, 0], ones * np.array([0.0, 0.0, 1.0]), ones * direction


def _from_surface(
    altitude_m: float, uniform: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """From a level surface upward, with the density cosine / pi."""
    directions = _cosine_directions(uniform[:, 0], uniform[:, 1])
    zeniths = np.zeros_like(directions)
    zeniths[:, 2] = 1.0
    return np.full(len(uniform), altitude_m), zeniths, directions


def _from_outside(
    altitude_m: float, uniform: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """From points even on the sphere of that altitude downward, with the density cosine / pi."""
    z = 2.0 * uniform[:, 0] - 1.0
    sine = np.sqrt((1.0 - z) * (1.0 + z))
    zeniths = np.stack([sine, np.zeros_like(z), z], axis=-1)
    x, y, up = _cosine_directions(uniform[:, 1], uniform[:, 2]).T
    # The local frame: east (z, 0, -sine), north (0, 1, 0), down -zenith.
    directions = np.stack([x * z - up * sine, y, -x * sine - up * z], axis=-1)
    return np.full(len(uniform), altitude_m), zeniths, directions


def _cosine_directions(u: FloatArray, v: FloatArray) -> FloatArray:
    """Directions (n, 3) about the z axis with the density cosine / pi."""
    sine, azimuth = np.sqrt(u), 2.0 * np.pi * v
    return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.sqrt(1.0 - u)], axis=-1)


def _view_and_sun(mu: float, mu_s: float, nu: float) -> tuple[FloatArray, FloatArray]:
    """Unit vectors (3,) in the frame whose z is the zenith and whose sun has no y."""
    sine, sine_s = (np.sqrt((1.0 - m) * (1.0 + m)) for m in (mu, mu_s))
    product = sine * sine_s
    cosine = np.clip((nu - mu * mu_s) / product, -1.0, 1.0) if product > 0 else 1.0
    view = np.array([sine * cosine, sine * np.sqrt((1.0 - cosine) * (1.0 + cosine)), mu])
    return view, np.array([sine_s, 0.0, mu_s])


def _standard_error(batches: FloatArray) -> FloatArray:
    return np.asarray(batches.std(axis=0, ddof=1) / np.sqrt(len(batches)))

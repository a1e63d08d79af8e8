"""Where a state of the air lies in the tables, and which state a node stands for.

A table's nodes are the centres of a texture's texels: along an axis of n nodes the texture
coordinate runs from 0.5 / n at the first to 1 - 0.5 / n at the last (Bruneton 2017). The axis
of mu in a scattering table is two textures in one: its first half holds rays that meet the
ground, from the horizon (first node) down, its second half those that do not, ending at the
horizon (last node).

The scattering tables (altitude, mu, nu, mu_s) have the axes of the thesis's equations 2.31 to
2.37, after Bruneton and Neyret 2008, section 4, in one of two forms:

* "2017" (Bruneton's implementation): mu is measured by the ray's length between the shortest and
  the longest at its altitude, mu_s by the length of the sun's ray from the ground. At altitude 0
  rays to the ground have no length: their nodes all look straight down, and a density of
  scattering looked up for level views close to the ground is partly that for down.
* "2008": mu is measured by the ray's length from 0. The nodes below the shortest ray there is hold
  that ray's light, and interpolation between them and the next is off: light scattered once, in
  tables of the full sizes 1 km above the ground with the sun at 37 to 87 degrees, errs in views
  steeply down by 11 % in the mean (2017: 0.2 to 0.4 %), in views up by 0.3 to 0.7 % (0.2 to
  0.5 %). mu_s has an exponential, written here for any lowest sun; with the sun 3 degrees below
  the horizon it is the better one, 2 % on the ground against 6 %.

The thesis prints three equations wrongly: the second case of 2.32 has the minus sign before its
root here, and 2.35 to 2.37 the lengths rho = sqrt(r^2 - Rg^2), H = sqrt(Rt^2 - Rg^2) and
Delta = r^2 mu^2 - rho^2.

Of the flat tables the irradiance (altitude, mu_s) has plain normalised axes, as the thesis says.
The transmittance (altitude, mu) falls to nothing within a degree of the horizon, which one node
in 256 of such an axis would stand for: its mu is measured by the ray's length, as in 2017.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import distance_to_top
from bruneton_sky.tables import ray_lengths
from bruneton_sky.tables.sizes import TableSizes
from vrut_lite.numeric_types import FloatArray

Year = Literal["2017", "2008"]
_SUN_STEEPNESS_2008 = 3.0


class State(NamedTuple):
    """A point of the air, a view from it and the sun; the fields broadcast.

    `mu` and `mu_s` are cosines of the zenith angles of view and sun, `nu` the cosine between
    them. `hits_ground`: whether the view meets the ground; at the horizon, where radiance jumps, mu
    alone does not determine it.
    """

    altitude_m: FloatArray
    mu: FloatArray
    mu_s: FloatArray
    nu: FloatArray
    hits_ground: NDArray[np.bool_]


class Coordinates(NamedTuple):
    """Texture coordinates in [0, 1], in the order of a scattering table's axes."""

    altitude: FloatArray
    mu: FloatArray
    nu: FloatArray
    mu_s: FloatArray


@dataclass(frozen=True)
class Parametrisation:
    """One form of the scattering tables' axes.

    Attributes:
        from_shortest: whether mu is measured from the shortest ray there is, or from no length.
        unit_of_sun: place in [0, 1] of mu_s, 1 with the sun at the zenith, 0 with it at mu_s_min or
            below.
        sun_of_unit: the inverse.
    """

    from_shortest: bool
    unit_of_sun: Callable[[Atmosphere, ArrayLike], FloatArray]
    sun_of_unit: Callable[[Atmosphere, FloatArray], FloatArray]

    def to_coordinates(
        self, atmosphere: Atmosphere, sizes: TableSizes, state: State
    ) -> Coordinates:
        """The texture coordinates of states; each field has the shape of its variables."""
        air, h, half = atmosphere, state.altitude_m, sizes.mu // 2
        to_ground = ray_lengths.ground_distance(air, h, state.mu, state.hits_ground)
        to_top = distance_to_top(air.ground_radius_m, air.top_altitude_m, h, state.mu)
        down = texture_coordinate(_share(to_ground, *self._down(air, h)), half)
        up = texture_coordinate(_share(to_top, *self._up(air, h)), half)
        return Coordinates(
            texture_coordinate(ray_lengths.unit_of_altitude(air, h), sizes.altitude),
            np.where(state.hits_ground, 0.5 - 0.5 * down, 0.5 + 0.5 * up),
            texture_coordinate(0.5 * (1.0 + state.nu), sizes.nu),
            texture_coordinate(self.unit_of_sun(air, state.mu_s), sizes.mu_s),
        )

    def to_state(
        self, atmosphere: Atmosphere, sizes: TableSizes, coordinates: Coordinates
    ) -> State:
        """The states at texture coordinates; nu is not yet held to what mu and mu_s allow."""
        air, half = atmosphere, sizes.mu // 2
        h = ray_lengths.altitude_of_unit(air, unit_range(coordinates.altitude, sizes.altitude))
        hits_ground = coordinates.mu < 0.5
        down = _length(unit_range(1.0 - 2.0 * coordinates.mu, half), *self._down(air, h))
        up = _length(unit_range(2.0 * coordinates.mu - 1.0, half), *self._up(air, h))
        # Nodes of 2008 below the shortest ray stand for it.
        down = np.maximum(down, ray_lengths.to_ground(air, h)[0])
        up = np.maximum(up, ray_lengths.to_top(air, h)[0])
        return State(
            h,
            np.where(
                hits_ground,
                ray_lengths.mu_of_ground_distance(air, h, down),
                ray_lengths.mu_of_top_distance(air, h, up),
            ),
            self.sun_of_unit(air, unit_range(coordinates.mu_s, sizes.mu_s)),
            np.clip(2.0 * unit_range(coordinates.nu, sizes.nu) - 1.0, -1.0, 1.0),
            hits_ground,
        )

    def _down(self, air: Atmosphere, altitude_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        shortest, longest = ray_lengths.to_ground(air, altitude_m)
        return shortest if self.from_shortest else np.zeros_like(shortest), longest

    def _up(self, air: Atmosphere, altitude_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        shortest, longest = ray_lengths.to_top(air, altitude_m)
        return shortest if self.from_shortest else np.zeros_like(shortest), longest


def _unit_of_sun_2017(air: Atmosphere, mu_s: ArrayLike) -> FloatArray:
    """Steepest at the horizon."""
    a = _sun_share(air, mu_s)
    return np.maximum(1.0 - a / _sun_share(air, air.mu_s_min), 0.0) / (1.0 + a)


def _sun_of_unit_2017(air: Atmosphere, unit: FloatArray) -> FloatArray:
    longest = _sun_share(air, air.mu_s_min)
    a = np.minimum(longest * (1.0 - unit) / (1.0 + unit * longest), longest)
    return ray_lengths.mu_of_top_distance(air, 0.0, _length(a, *ray_lengths.to_top(air, 0.0)))


def _sun_share(air: Atmosphere, mu_s: ArrayLike) -> FloatArray:
    """Length of the sun's ray to the ground: 0 from the zenith, 1 from the horizon."""
    length = distance_to_top(air.ground_radius_m, air.top_altitude_m, 0.0, mu_s)
    return _share(length, *ray_lengths.to_top(air, 0.0))


def _unit_of_sun_2008(air: Atmosphere, mu_s: ArrayLike) -> FloatArray:
    above = np.asarray(mu_s, dtype=float) - air.mu_s_min
    return np.maximum(-np.expm1(-_SUN_STEEPNESS_2008 * above) / _span_2008(air), 0.0)


def _sun_of_unit_2008(air: Atmosphere, unit: FloatArray) -> FloatArray:
    above = -np.log1p(-unit * _span_2008(air)) / _SUN_STEEPNESS_2008
    return np.clip(air.mu_s_min + above, -1.0, 1.0)


def _span_2008(air: Atmosphere) -> float:
    return float(-np.expm1(-_SUN_STEEPNESS_2008 * (1.0 - air.mu_s_min)))


def _share(length: FloatArray, shortest: FloatArray, longest: FloatArray) -> FloatArray:
    """Place of a length between two; 0 where there is no room between them."""
    room = longest - shortest
    over = length - shortest
    shape = np.broadcast(over, room).shape
    return np.maximum(np.divide(over, room, out=np.zeros(shape), where=room > 0), 0.0)


def _length(share: FloatArray, shortest: FloatArray, longest: FloatArray) -> FloatArray:
    return shortest + share * (longest - shortest)


_BY_YEAR: dict[str, Parametrisation] = {
    "2017": Parametrisation(True, _unit_of_sun_2017, _sun_of_unit_2017),
    "2008": Parametrisation(False, _unit_of_sun_2008, _sun_of_unit_2008),
}


def parametrisation_of(year: Year) -> Parametrisation:
    """The parametrisation published in a year.

    Raises:
        ValueError: none was.
    """
    if year not in _BY_YEAR:
        raise ValueError(f'parametrisation must be "2017" or "2008", not {year!r}')
    return _BY_YEAR[year]


def texture_coordinate(unit: ArrayLike, size: int) -> FloatArray:
    """Texture coordinate of a place in [0, 1] between an axis's first and last node."""
    return 0.5 / size + np.asarray(unit, dtype=float) * (1.0 - 1.0 / size)


def unit_range(coordinate: ArrayLike, size: int) -> FloatArray:
    """The inverse of `texture_coordinate`."""
    return (np.asarray(coordinate, dtype=float) - 0.5 / size) / (1.0 - 1.0 / size)


def node_coordinates(size: int) -> FloatArray:
    """Texture coordinates (size,) of an axis's nodes."""
    return (np.arange(size) + 0.5) / size


def node_states(atmosphere: Atmosphere, sizes: TableSizes, year: Year) -> State:
    """The states at a scattering table's nodes; they broadcast to its shape.

    A node's nu is moved to the nearest angle that its mu and mu_s allow.
    """
    axes = np.ix_(*(node_coordinates(size) for size in sizes.scattering_shape))
    at = parametrisation_of(year).to_state(atmosphere, sizes, Coordinates(*axes))
    return at._replace(nu=allowed_nu(at.mu, at.mu_s, at.nu))


def allowed_nu(mu: FloatArray, mu_s: FloatArray, nu: FloatArray) -> FloatArray:
    """The nearest cosine between two directions whose zenith angles are given."""
    sines = np.sqrt((1.0 - mu) * (1.0 + mu) * (1.0 - mu_s) * (1.0 + mu_s))
    return np.clip(nu, mu * mu_s - sines, mu * mu_s + sines)


def transmittance_coordinates(
    atmosphere: Atmosphere, shape: tuple[int, ...], altitude_m: ArrayLike, mu: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Texture coordinates (altitude, mu) in a transmittance table of a shape."""
    air, h = atmosphere, np.asarray(altitude_m, dtype=float)
    length = distance_to_top(air.ground_radius_m, air.top_altitude_m, h, mu)
    shortest, longest = ray_lengths.to_top(air, h)
    return (
        texture_coordinate(ray_lengths.unit_of_altitude(air, h), shape[0]),
        texture_coordinate((length - shortest) / (longest - shortest), shape[1]),
    )


def transmittance_state(
    atmosphere: Atmosphere, shape: tuple[int, ...], altitude: ArrayLike, mu: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Altitude in m and mu at texture coordinates (altitude, mu)."""
    h = ray_lengths.altitude_of_unit(atmosphere, unit_range(altitude, shape[0]))
    shortest, longest = ray_lengths.to_top(atmosphere, h)
    length = shortest + unit_range(mu, shape[1]) * (longest - shortest)
    return h, ray_lengths.mu_of_top_distance(atmosphere, h, length)


def irradiance_coordinates(
    atmosphere: Atmosphere, shape: tuple[int, ...], altitude_m: ArrayLike, mu_s: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Texture coordinates (altitude, mu_s) in an irradiance table of a shape."""
    height = np.asarray(altitude_m, dtype=float) / atmosphere.top_altitude_m
    sun = 0.5 + 0.5 * np.asarray(mu_s, dtype=float)
    return texture_coordinate(height, shape[0]), texture_coordinate(sun, shape[1])


def irradiance_state(
    atmosphere: Atmosphere, shape: tuple[int, ...], altitude: ArrayLike, mu_s: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Altitude in m and mu_s at texture coordinates (altitude, mu_s)."""
    h = unit_range(altitude, shape[0]) * atmosphere.top_altitude_m
    return h, 2.0 * unit_range(mu_s, shape[1]) - 1.0

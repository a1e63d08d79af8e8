"""Where a point, a view and a sun lie in a table of scattering.

A table's nodes are the centres of a texture's texels: along an axis of n nodes the texture
coordinate runs from 0.5 / n at the first to 1 - 0.5 / n at the last (Bruneton 2017). The axis
of mu is two textures in one: its first half holds rays that meet the ground, from the horizon
(first node) down, its second half those that do not, ending at the horizon (last node).
"""

from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.tables.sizes import TableSizes
from vrut_lite.numeric_types import FloatArray

Year = Literal["2017", "2008"]


class State(NamedTuple):
    """A point of the air, a view from it and the sun; the fields broadcast.

    `mu` and `mu_s` are cosines of the zenith angles of view and sun, `nu` the cosine between
    them. `hits_ground` tells whether the view meets the ground: at the horizon, where radiance
    jumps, mu alone could not tell.
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


class Parametrisation(Protocol):
    """A module that maps states to coordinates of the scattering tables and back."""

    def to_coordinates(
        self, atmosphere: Atmosphere, sizes: TableSizes, state: State
    ) -> Coordinates:
        """The coordinates of a state."""

    def to_state(
        self, atmosphere: Atmosphere, sizes: TableSizes, coordinates: Coordinates
    ) -> State:
        """The state at coordinates."""


def parametrisation_of(year: Year) -> Parametrisation:
    """The parametrisation published in a year.

    Raises:
        ValueError: none was.
    """
    from bruneton_sky.tables import parametrisation_2008, parametrisation_2017

    if year == "2017":
        return parametrisation_2017
    if year == "2008":
        return parametrisation_2008
    raise ValueError(f'parametrisation must be "2017" or "2008", not {year!r}')


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

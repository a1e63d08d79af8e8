"""From the radiance at the nodes to the source function there: the integral over directions.

Light that arrives at a point as L(direction) leaves it, scattered, as the integral of
P(cosine) L. In spherical harmonics that multiplies each coefficient of degree l by
chi_l = 2 pi integral P(x) P_l(x) dx (the Funk-Hecke theorem). chi_0 = 1, so that scattering
conserves energy exactly, whatever the number of directions.

So the radiance is projected on harmonics about the zenith, even in azimuth, each coefficient
multiplied by chi_l, and the sum tabulated by direction. Both ways go azimuth first, then zenith
angle: a fifth of the work of one matrix. All matrices depend on the planet's radii and the sizes
only. Of molecules, whose phase function has degrees 0 and 2 only, four coefficients are kept.

The source function is looked up by lines between the tabulated directions. With the function's own
values at the nodes it would be too large between them wherever it is hollow, as it is beside the
lobe that haze scatters forward; the values of `fit_lines` keep its integral.
"""

from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.solver.grid import Directions, azimuths, make_directions
from bruneton_sky.solver.sizes import HIGHER, SolverSizes
from vrut_lite.numeric_types import FloatArray

SingleArray = NDArray[np.float32]
# Points of the quadrature of a phase function.
_GAUSS_POINTS = 512
# Gauss points between neighbouring nodes of a fit: harmonics of degree 32 bend little there.
_FIT_POINTS = 8
# (l, m) of the harmonics that molecules scatter, and what turns a harmonic's coefficient into
# that of 1, 3 mu^2 - 1, mu sin(theta) cos(phi), sin^2(theta) cos(2 phi). The Rayleigh phase
# function 3 / (16 pi) (1 + x^2) has chi_0 = 1, chi_2 = 1 / 10.
_RAYLEIGH_HARMONICS = ((0, 0), (2, 0), (2, 1), (2, 2))
_RAYLEIGH_FACTORS = np.sqrt([1.0, 5.0 / 4.0, 15.0, 15.0 / 4.0]) * [1.0, 0.1, 0.1, 0.1]
_RAYLEIGH_FACTORS /= np.sqrt(4.0 * np.pi)


class ScatteringOperator(NamedTuple):
    """The matrices, float32; harmonics are ordered by m, then l.

    Attributes:
        directions: over which the radiance at the nodes is given.
        turn_in: (m, azimuths) by how many azimuths there are, cosines times the azimuth's weight;
            m below that many.
        polar_in: (altitudes, harmonics, mu), times the weight of mu.
        polar_out, turn_out: (source mu, harmonics) and (source azimuths, m), such that lines
            between them fit the harmonics; the azimuths are uniform in sin(phi / 2).
        degree: (harmonics,), l of each.
        first: (m + 1,), where the harmonics of each m begin.
    """

    directions: Directions
    turn_in: dict[int, SingleArray]
    polar_in: SingleArray
    polar_out: SingleArray
    turn_out: SingleArray
    degree: NDArray[np.int64]
    first: NDArray[np.int64]

    def project(self, radiance: SingleArray) -> SingleArray:
        """Coefficients (altitudes, harmonics, n) of radiance (altitudes, mu, azimuths, n).

        Only of the first harmonics, whose m these azimuths resolve.
        """
        turn_in = self.turn_in[radiance.shape[2]]
        turned = np.matmul(turn_in, radiance)
        shape = radiance.shape[0], self.first[len(turn_in)], radiance.shape[-1]
        coefficients = np.empty(shape, dtype=np.float32)
        for m, part in enumerate(self._parts(shape[1])):
            np.matmul(self.polar_in[:, part], turned[:, :, m], out=coefficients[:, part])
        return coefficients

    def scatter(
        self,
        coefficients: SingleArray,
        chi: SingleArray,
        more: tuple[NDArray[np.int64], SingleArray] | None = None,
    ) -> SingleArray:
        """Source function (altitudes, mu, azimuths, n * 4) of phase functions' chi (altitudes or 1,
        degrees, 4).

        Four wavelengths lie side by side. The coefficients may be only the first ones. `more`:
        places and values of coefficients to add to the scattered ones.
        """
        harmonics, columns = coefficients.shape[1:]
        by_column = np.tile(chi[:, self.degree[:harmonics]], columns // chi.shape[2])
        scattered = coefficients * by_column
        if more is not None:
            known = more[0] < harmonics
            scattered[:, more[0][known]] += more[1][:, known]
        parts = self._parts(harmonics)
        shape = len(coefficients), len(self.polar_out), len(parts), columns
        turned = np.empty(shape, dtype=np.float32)
        for m, part in enumerate(parts):
            np.matmul(self.polar_out[:, part], scattered[:, part], out=turned[:, :, m])
        return np.matmul(self.turn_out[:, : len(parts)], turned)

    def scatter_by_molecules(
        self, coefficients: SingleArray, anisotropy: float, more: SingleArray | None = None
    ) -> SingleArray:
        """The source function of molecules of an anisotropy: coefficients (altitudes, 4, n).

        `more` (altitudes, 3, n): to add to those of degree 2 before they are scattered.
        """
        index = [self.first[m] + degree - m for degree, m in _RAYLEIGH_HARMONICS]
        dipoles = [1.0, anisotropy, anisotropy, anisotropy]
        factors = (_RAYLEIGH_FACTORS * dipoles).astype(np.float32)[:, None]
        few = coefficients[:, index]
        if more is not None:
            few[:, 1:] += more
        return np.ascontiguousarray(few * factors)

    def _parts(self, harmonics: int) -> list[slice]:
        """The slice of each m among the first `harmonics` harmonics."""
        ends = self.first[self.first <= harmonics]
        return [slice(*pair) for pair in pairwise(ends)]


@lru_cache(maxsize=4)
def scattering_operator(
    ground_radius_m: float, altitude_m: tuple[float, ...], sizes: SolverSizes
) -> ScatteringOperator:
    """The operator of a planet at the nodes' altitudes."""
    directions = make_directions(ground_radius_m, np.array(altitude_m), sizes.direction_mu)
    m = np.arange(sizes.degree + 1)
    counts = {sizes.direction_azimuth, sizes.azimuths_of(3), sizes.azimuths_of(HIGHER)}
    source_mu = np.linspace(-1.0, 1.0, sizes.source_mu)
    orders = range(sizes.degree + 1)
    polar_in = np.concatenate([legendre(order, sizes.degree, directions.mu) for order in orders])
    polar_out = fit_lines(
        lambda mu: np.concatenate([legendre(order, sizes.degree, mu) for order in orders]).T,
        source_mu,
        lambda mu: 0.5 * mu + 0.5,
        # In the zenith the azimuth must not matter.
        keep_ends=True,
    )
    source_azimuth = 2.0 * np.arcsin(np.linspace(0.0, 1.0, sizes.source_azimuth))
    turn_out = fit_lines(
        lambda turn: np.cos(np.outer(turn, m)), source_azimuth, lambda turn: np.sin(0.5 * turn)
    )
    return ScatteringOperator(
        directions,
        {count: _turn_matrix(m, count) for count in counts},
        (polar_in * directions.weight).transpose(1, 0, 2).astype(np.float32, "C"),
        polar_out.astype(np.float32, "C"),
        turn_out.astype(np.float32),
        np.concatenate([np.arange(order, sizes.degree + 1) for order in orders]),
        np.concatenate([[0], np.cumsum(sizes.degree + 1 - m)]),
    )


def _turn_matrix(m: NDArray[np.int64], count: int) -> SingleArray:
    """cos(m phi) (m, azimuths) times 2 pi / count, for the m that `count` azimuths resolve."""
    cosines = np.cos(np.outer(m[m < count], azimuths(count))) * (2.0 * np.pi / count)
    return np.asarray(cosines, dtype=np.float32)


def legendre(order: int, degree: int, mu: ArrayLike) -> FloatArray:
    """Functions (degree - order + 1, ...) whose products with cos(order * phi) are orthonormal.

    Degrees from `order` to `degree`; on the sphere, with the azimuth's factor of 2 for
    order > 0 contained. The three-term recurrence in the degree is stable.
    """
    x = np.asarray(mu, dtype=float)
    sine = np.sqrt(np.maximum((1.0 - x) * (1.0 + x), 0.0))
    first = np.full_like(x, np.sqrt((1.0 if order == 0 else 2.0) / (4.0 * np.pi)))
    for m in range(1, order + 1):
        first = first * sine * np.sqrt((2.0 * m + 1.0) / (2.0 * m))
    rows = [first, x * np.sqrt(2.0 * order + 3.0) * first]
    for l in range(order + 2, degree + 1):  # noqa: E741
        scale = np.sqrt((4.0 * l * l - 1.0) / (l * l - order * order))
        below = np.sqrt(((l - 1.0) ** 2 - order * order) / (4.0 * (l - 1.0) ** 2 - 1.0))
        rows.append(scale * (x * rows[-1] - below * rows[-2]))
    return np.stack(rows[: degree - order + 1])


def phase_coefficients(phase: Callable[[FloatArray], FloatArray], degree: int) -> FloatArray:
    """chi_l (degree + 1,) of a phase function of the cosine, normalised so that chi_0 = 1."""
    x, w = gauss_cosines()
    legendre_p = np.polynomial.legendre.legvander(x, degree)
    chi = 2.0 * np.pi * (w * phase(x)) @ legendre_p
    return np.asarray(chi / chi[0])


@lru_cache(maxsize=1)
def gauss_cosines() -> tuple[FloatArray, FloatArray]:
    """Cosines and weights (n,) over which phase functions are integrated."""
    return np.polynomial.legendre.leggauss(_GAUSS_POINTS)


def fit_lines(
    function: Callable[[FloatArray], FloatArray],
    node: FloatArray,
    place: Callable[[FloatArray], FloatArray],
    keep_ends: bool = False,
) -> FloatArray:
    """Values (n, k) at nodes (n,) that fit a function best where lines connect them.

    Args:
        function: of a coordinate (m,), to (m, k).
        node: the coordinate at the nodes, over which the squared difference is integrated.
        place: of a coordinate, what the lines are straight over; uniform from 0 to 1 at the nodes.
        keep_ends: leave the function's own values at the first and the last node.
    """
    root, weight = np.polynomial.legendre.leggauss(_FIT_POINTS)
    half = 0.5 * np.diff(node)[:, None]
    x = (0.5 * (node[:-1] + node[1:])[:, None] + half * root).ravel()
    index = np.arange(node.size)
    share = np.maximum(1.0 - np.abs(place(x)[:, None] * (node.size - 1) - index), 0.0)
    weighted = share.T * (half * weight).ravel()
    if not keep_ends:
        return np.asarray(np.linalg.solve(weighted @ share, weighted @ function(x)), float)
    values = function(node)
    free, ends = weighted[1:-1], share[:, [0, -1]]
    rest = function(x) - ends @ values[[0, -1]]
    values[1:-1] = np.linalg.solve(free @ share[:, 1:-1], free @ rest)
    return values

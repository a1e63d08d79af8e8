"""From the radiance at the nodes to the source function there: the integral over directions.

The radiance is projected on spherical harmonics, each coefficient multiplied by the phase
function's, and the sum tabulated by direction. Both ways go azimuth first, then zenith angle:
a fifth of the work of one matrix. All matrices depend on the planet's radii and the sizes only.

Of molecules, whose phase function has degrees 0 and 2 only, four coefficients are kept.
"""

from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.solver.directions import Directions, azimuths, make_directions
from bruneton_sky.solver.harmonics import legendre
from bruneton_sky.solver.linear_fit import fit_lines
from bruneton_sky.solver.sizes import HIGHER, SolverSizes

FloatArray = NDArray[np.float32]
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
    turn_in: dict[int, FloatArray]
    polar_in: FloatArray
    polar_out: FloatArray
    turn_out: FloatArray
    degree: NDArray[np.int64]
    first: NDArray[np.int64]

    def project(self, radiance: FloatArray) -> FloatArray:
        """Coefficients (altitudes, harmonics, n) of radiance (altitudes, mu, azimuths, n).

        Only of the harmonics whose m so many azimuths can tell, which are the first of them.
        """
        turn_in = self.turn_in[radiance.shape[2]]
        turned = np.matmul(turn_in, radiance)
        shape = radiance.shape[0], self.first[len(turn_in)], radiance.shape[-1]
        coefficients = np.empty(shape, dtype=np.float32)
        for m, part in enumerate(self._parts(shape[1])):
            np.matmul(self.polar_in[:, part], turned[:, :, m], out=coefficients[:, part])
        return coefficients

    def scatter(self, coefficients: FloatArray, chi: NDArray[np.float64]) -> FloatArray:
        """Source function (altitudes, mu, azimuths, n) of a phase function's chi (degrees,).

        The coefficients may be the first of them only.
        """
        weighted = self.polar_out * chi[self.degree].astype(np.float32)
        parts = self._parts(coefficients.shape[1])
        shape = len(coefficients), len(weighted), len(parts), coefficients.shape[2]
        turned = np.empty(shape, dtype=np.float32)
        for m, part in enumerate(parts):
            np.matmul(weighted[:, part], coefficients[:, part], out=turned[:, :, m])
        return np.matmul(self.turn_out[:, : len(parts)], turned)

    def scatter_by_molecules(self, coefficients: FloatArray) -> FloatArray:
        """The source function of molecules: coefficients (altitudes, 4, n)."""
        index = [self.first[m] + degree - m for degree, m in _RAYLEIGH_HARMONICS]
        factors = _RAYLEIGH_FACTORS.astype(np.float32)[:, None]
        return np.ascontiguousarray(coefficients[:, index] * factors)

    def _parts(self, harmonics: int) -> list[slice]:
        """Where each m stands among the first so many harmonics."""
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


def _turn_matrix(m: NDArray[np.int64], count: int) -> FloatArray:
    """cos(m phi) (m, azimuths) times 2 pi / count, but for the m that so few would mistake."""
    cosines = np.cos(np.outer(m[m < count], azimuths(count))) * (2.0 * np.pi / count)
    return np.asarray(cosines, dtype=np.float32)

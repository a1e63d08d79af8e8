"""Polarised light between the solver's nodes: Stokes's Q and U beside the radiance I.

By the plane of a view and the zenith, with theta the direction of rising zenith angle and phi that
of rising azimuth from the sun: Q = |E_theta|^2 - |E_phi|^2 and U = 2 E_theta E_phi. The sky is its
own mirror image in the sun's vertical plane: Q is even in the azimuth, U odd. Along a ray the plane
stays the same. V is left out: sunlight has none, and what spheres make of U hardly changes I.

Harmonics. I = sum i_lm Y_lm, with the functions Y_lm of `scattering_operator.legendre`;

    Q = sum (e_lm W_lm + b_lm X_lm) cos(m phi),  U = sum (e_lm X_lm + b_lm W_lm) sin(m phi),
    W, X = N (d^l_m,-2 +- d^l_m,2) / 2,  N = (-1)^m ((2 - (m = 0)) (2 l + 1) / (4 pi))^(1/2),

with Wigner's functions d (Hovenier, van der Mee and Domke 2004, appendix B). A scattering matrix
with P22 = P11, that of spheres, scatters degree by degree:

    i' = chi11 i + chi12 e,  e' = chi12 i + chi22 e,  b' = chi33 b,
    chi12 = 2 pi int P12 d^l_0,2 dx,  chi22 +- chi33 = 2 pi int (P11 +- P33) d^l_2,+-2 dx.

Molecules of anisotropy D have chi11, chi12, chi22 = (1, -6^(1/2), 6) D / 10 at l = 2 and no others
but chi11 = 1 at l = 0. So Q and U add -6^(1/2) e_2m to i_2m, and what molecules scatter is known
from the coefficients b1, b2, b3 of 3 mu^2 - 1, mu s cos(phi), s^2 cos(2 phi), with s = sin(theta):

    Q' = -3 s^2 b1 + s mu b2 cos(phi) - (1 + mu^2) b3 cos(2 phi),
    U' = -s b2 sin(phi) + 2 mu b3 sin(2 phi).

Light that particles scatter nearly straight on, a share f that delta-M counts as not scattered,
keeps its polarisation: chi12 becomes chi12 / (1 - f), chi22 and chi33 (chi - f) / (1 - f).
"""

import math
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import (
    molecules_polarisation,
    particles_phase,
    particles_polarisation,
    rayleigh_phase,
)
from bruneton_sky.solver.delta_m import forward_shares
from bruneton_sky.solver.grid import Directions, azimuths, make_directions
from bruneton_sky.solver.particles import kind_phases, kinds_of, shares_at
from bruneton_sky.solver.scattering_operator import fit_lines, gauss_cosines
from bruneton_sky.solver.sizes import SolverSizes
from vrut_lite.numeric_types import FloatArray

Lanes = NDArray[np.float32]
# Ratio of chi12 to chi11 of molecules at degree 2.
MOLECULES_RATIO = -math.sqrt(6.0)


def wigner(m: int, s: int, degree: int, mu: ArrayLike) -> FloatArray:
    """Wigner's functions d^l_ms(mu) (degree + 1, ...) for l from 0, zero below max(m, |s|); m >= 0.

    The recurrence in l is stable (Varshalovich et al. 1988, equation 4.8.2).
    """
    x = np.asarray(mu, dtype=float)
    rows = np.zeros((degree + 1, *x.shape))
    lowest = max(m, abs(s))
    if lowest > degree:
        return rows
    near, far = np.sqrt(np.maximum(0.5 + 0.5 * x, 0.0)), np.sqrt(np.maximum(0.5 - 0.5 * x, 0.0))
    size = math.sqrt(math.comb(2 * lowest, lowest + (s if m >= abs(s) else m)))
    sign = (-1) ** (m - s) if m >= abs(s) or s < 0 else 1
    rows[lowest] = sign * size * near ** abs(m + s) * far ** abs(m - s)
    for l in range(lowest, degree):  # noqa: E741
        if l == 0:
            rows[1] = x
            continue
        below = math.sqrt((l * l - m * m) * (l * l - s * s))
        above = math.sqrt(((l + 1) ** 2 - m * m) * ((l + 1) ** 2 - s * s))
        level = (2 * l + 1) * (l * (l + 1) * x - m * s)
        rows[l + 1] = (level * rows[l] - (l + 1) * below * rows[l - 1]) / (l * above)
    return rows


def polarised_harmonics(degree: int, m: int, mu: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """W and X (degrees, ...) of an order m, for the degrees from max(m, 2)."""
    lowest = max(m, 2)
    plus, minus = (wigner(m, s, degree, mu)[lowest:] for s in (2, -2))
    l = np.arange(lowest, degree + 1)  # noqa: E741
    norm = (-1) ** m * np.sqrt((2.0 * l + 1.0) * (2.0 if m else 1.0) / (4.0 * np.pi))
    norm = norm.reshape(-1, *(1,) * np.ndim(mu))
    return 0.5 * norm * (plus + minus), 0.5 * norm * (minus - plus)


def harmonics_at(degree: int, mu: FloatArray, turn: FloatArray) -> FloatArray:
    """Q and U of each harmonic of e and of b (2, 2, harmonics, n) at directions (n,)."""
    parts = []
    for m in range(degree + 1):
        w, x = polarised_harmonics(degree, m, mu)
        cosine, sine = np.cos(m * turn), np.sin(m * turn)
        parts.append(np.stack([[w * cosine, x * cosine], [x * sine, w * sine]]))
    return np.concatenate(parts, axis=2)


def molecules_terms(mu: FloatArray, turn: FloatArray) -> FloatArray:
    """Q and U of molecules (2, 3, n) at directions (n,), for unit coefficients b1, b2, b3."""
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    q = -3.0 * sine**2, sine * mu * np.cos(turn), -(1.0 + mu * mu) * np.cos(2.0 * turn)
    u = np.zeros_like(mu), -sine * np.sin(turn), 2.0 * mu * np.sin(2.0 * turn)
    return np.stack([np.stack(q), np.stack(u)])


class PolarisedOperator(NamedTuple):
    """Matrices between Q and U at the nodes, their coefficients, and tables; float32.

    Coefficients (altitudes, 2, harmonics, n) are e and b; harmonics are ordered by m, then l.

    Attributes:
        directions: over which Q and U at the nodes are given; fewer than those of the radiance.
        turn_in: (2, m, azimuths): cosines and sines times the azimuth's weight.
        polar_in: for each m (altitudes, 2 * degrees, 2 * mu), times the weight of mu.
        polar_out: for each m (2 * source mu, 2 * degrees).
        turn_out: (2, source azimuths, m): cosines, and sines over the sine of the azimuth.
        degree: (harmonics,), l of each.
        radiance_index: (harmonics,), where the radiance has the same harmonics.
    """

    directions: Directions
    turn_in: Lanes
    polar_in: list[Lanes]
    polar_out: list[Lanes]
    turn_out: Lanes
    degree: NDArray[np.int64]
    radiance_index: NDArray[np.int64]

    def project(self, polarised: Lanes) -> Lanes:
        """Coefficients of Q and U (2, altitudes, mu, azimuths, n)."""
        turned = np.concatenate(
            [np.matmul(turn, part) for turn, part in zip(self.turn_in, polarised, strict=True)], 1
        )
        shape = len(turned), 2, self.degree.size, turned.shape[-1]
        out, start = np.empty(shape, np.float32), 0
        for m, matrix in enumerate(self.polar_in):
            count = matrix.shape[1] // 2
            both = np.matmul(matrix, turned[:, :, m])
            out[:, :, start : start + count] = both.reshape(len(turned), 2, count, -1)
            start += count
        return out

    def tables(self, coefficients: Lanes) -> Lanes:
        """Q, and U over the sine of the azimuth (2, altitudes, mu, azimuths, n)."""
        altitudes, columns = len(coefficients), coefficients.shape[-1]
        rows, orders = len(self.polar_out[0]) // 2, len(self.polar_out)
        turned, start = np.empty((2, altitudes, rows, orders, columns), np.float32), 0
        for m, matrix in enumerate(self.polar_out):
            count = matrix.shape[1] // 2
            some = coefficients[:, :, start : start + count].reshape(altitudes, -1, columns)
            both = np.matmul(matrix, some).reshape(altitudes, 2, rows, columns)
            turned[:, :, :, m] = both.swapaxes(0, 1)
            start += count
        return np.matmul(self.turn_out[:, None, None], turned)


@lru_cache(maxsize=4)
def polarised_operator(
    ground_radius_m: float, altitude_m: tuple[float, ...], sizes: SolverSizes
) -> PolarisedOperator:
    """The operator of a planet at the nodes' altitudes."""
    directions = make_directions(ground_radius_m, np.array(altitude_m), sizes.polarised_mu)
    degree = polarised_degree(sizes)
    orders, turn = range(degree + 1), azimuths(sizes.polarised_azimuth)
    angles, weight = np.outer(orders, turn), 2.0 * np.pi / turn.size
    source_mu = np.linspace(-1.0, 1.0, sizes.polarised_mu)
    polar_in, polar_out = [], []
    for m in orders:
        at_nodes = np.stack(polarised_harmonics(degree, m, directions.mu)) * directions.weight
        polar_in.append(_both_ways(*np.moveaxis(at_nodes, 2, 1)))
        by_mu = fit_lines(partial(_w_and_x, degree, m), source_mu, lambda mu: 0.5 * mu + 0.5)
        polar_out.append(_both_ways(*np.split(by_mu, 2, axis=1)))
    source_azimuth = 2.0 * np.arcsin(np.linspace(0.0, 1.0, sizes.polarised_azimuth + 2))
    turn_out = [
        fit_lines(function, source_azimuth, lambda turn: np.sin(0.5 * turn))
        for function in (
            lambda turn: np.cos(np.outer(turn, orders)),
            lambda turn: np.sin(np.outer(turn, orders)) / np.sin(turn)[:, None],
        )
    ]
    # Where the radiance's harmonics of each m begin, less m.
    first = [m * sizes.degree - m * (m - 1) // 2 for m in orders]
    pairs = [(l, m) for m in orders for l in range(max(m, 2), degree + 1)]  # noqa: E741
    return PolarisedOperator(
        directions,
        (np.stack([np.cos(angles), np.sin(angles)]) * weight).astype(np.float32),
        polar_in,
        polar_out,
        np.stack(turn_out).astype(np.float32),
        np.array([l for l, _ in pairs]),  # noqa: E741
        np.array([first[m] + l for l, m in pairs]),  # noqa: E741
    )


def _w_and_x(degree: int, m: int, mu: FloatArray) -> FloatArray:
    """W and X (n, 2 * degrees) of an order m."""
    return np.concatenate(polarised_harmonics(degree, m, mu)).T


def polarised_degree(sizes: SolverSizes) -> int:
    """Highest degree of the harmonics of Q and U: that which the azimuths resolve."""
    return min(sizes.polarised_azimuth - 1, sizes.degree)


def _both_ways(w: FloatArray, x: FloatArray) -> Lanes:
    """The matrices [[W, X], [X, W]] of matrices (..., i, j)."""
    rows = np.concatenate([w, x], axis=-1), np.concatenate([x, w], axis=-1)
    return np.ascontiguousarray(np.concatenate(rows, axis=-2), dtype=np.float32)


def particles_chi(atmosphere: Atmosphere, sizes: SolverSizes, altitude_m: FloatArray) -> FloatArray:
    """chi12, chi22, chi33 (3, altitudes or 1, degrees, C) of particles without the peak."""
    kinds = kinds_of(atmosphere)
    each = np.stack([_kind_chi(atmosphere, kind, sizes) for kind in kinds])
    if len(kinds) == 1:
        return each[0][:, None]
    shares = shares_at(atmosphere, sizes.degree, altitude_m)
    return np.einsum("akc,kplc->palc", shares, each)


def _kind_chi(atmosphere: Atmosphere, name: str, sizes: SolverSizes) -> FloatArray:
    """The same (3, degrees, C) of one kind of particles."""
    degree = polarised_degree(sizes)
    x, weight = gauss_cosines()
    phase = weight[:, None] * particles_phase(atmosphere, name, x)
    phase /= phase.sum(axis=0)
    p12, p33 = particles_polarisation(atmosphere, name, x)
    made = wigner(0, 2, degree, x) @ (phase * p12)
    plus = wigner(2, 2, degree, x) @ (phase * (1.0 + p33))
    minus = wigner(2, -2, degree, x) @ (phase * (1.0 - p33))
    peak = forward_shares(atmosphere, sizes.degree)[name]
    kept = 0.5 * np.stack([2.0 * made, plus + minus, plus - minus])
    kept[1:] -= peak
    return np.asarray(kept / (1.0 - peak))


def polarised_phases(
    atmosphere: Atmosphere, degree: int, nu: FloatArray, altitude_m: FloatArray
) -> tuple[FloatArray, list[FloatArray]]:
    """P12 in sr^-1 of molecules (n,), for their light over Rayleigh's phase function (see
    `gather_first`), and of particles at each altitude (n, C), per unit of scattering in thinned
    air."""
    molecules = rayleigh_phase(nu) * molecules_polarisation(atmosphere, nu)
    made = [particles_polarisation(atmosphere, kind, nu)[0] for kind in kinds_of(atmosphere)]
    kinds = kind_phases(atmosphere, degree, nu) * np.stack(made)
    shares = shares_at(atmosphere, degree, altitude_m if atmosphere.mixed else [0.0])
    return molecules, [np.asarray((share[:, None] * kinds).sum(axis=0)) for share in shares]

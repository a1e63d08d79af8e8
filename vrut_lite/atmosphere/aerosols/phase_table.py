"""A phase function as a table, one row a wavelength, and how it polarises.

Nodes are uniform in sin(theta / 2): dense toward the sun, where particles scatter most, and the
square of the coordinate is (1 - nu) / 2, which kernels and shaders have without an arc cosine.
"""

import hashlib
from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

# Nodes: lines between them leave 3e-5 of Cornette and Shanks' lobe at g = 0.8.
PHASE_NODES = 1024
# Ratios of single-precision tables.
_ROUNDING = 1e-5


class PhaseTable:
    """Phase functions (C, PHASE_NODES) in sr^-1; their integral over the sphere is 1.

    Equal and hashable by content, so that it can be a part of a cache's key.

    Args:
        values: (C, PHASE_NODES), at least 0; each row is scaled to the integral 1.
        ratios: P12 / P11 and P33 / P11 (2, C, PHASE_NODES) of the scattering matrix, which for
            spheres has P22 = P11 and P44 = P33 (Bohren and Huffman 1983, equation 4.77). Without
            them light keeps its polarisation and gets none: 0 and 1.

    Raises:
        ValueError: the shape is another one, or a value is negative or no number; ratios are those
            of no particle.
    """

    def __init__(self, values: ArrayLike, ratios: ArrayLike | None = None):
        table = np.array(values, dtype=float)
        if table.ndim != 2 or table.shape[1] != PHASE_NODES:
            raise ValueError(f"a phase table has {PHASE_NODES} angles, not the shape {table.shape}")
        if not (np.isfinite(table).all() and table.min() >= 0.0 and table.any(axis=1).all()):
            raise ValueError("a phase function is a number of at least 0 at each angle, not all 0")
        self.values = table / _integral(table)[:, None]
        self.values.flags.writeable = False
        self.ratios = None if ratios is None else _checked_ratios(ratios, table)

    @classmethod
    def of_function(cls, phase: Callable[[FloatArray], FloatArray]) -> "PhaseTable":
        """The table of a function of the cosine (n,), which gives (C, n) or, for one row, (n,)."""
        return cls(np.atleast_2d(phase(node_cosines())))

    @classmethod
    def of_angles(
        cls, angle_rad: ArrayLike, phase: ArrayLike, ratios: ArrayLike | None = None
    ) -> "PhaseTable":
        """The table of values (C, n) or (n,) at rising scattering angles (n,) from 0 to pi.

        Between angles the logarithm is linear in the angle, and so are `ratios` (2, C, n).

        Raises:
            ValueError: the angles do not rise from 0 to pi, or a value is not above 0.
        """
        angle, value = np.asarray(angle_rad, float), np.atleast_2d(np.asarray(phase, float))
        whole = angle.ndim == 1 and angle.size > 1 and bool((np.diff(angle) > 0.0).all())
        if not (whole and np.allclose(angle[[0, -1]], (0.0, np.pi), atol=1e-6)):
            raise ValueError("scattering angles must rise from 0 to 180 degrees")
        if value.shape[1:] != angle.shape or not (value > 0.0).all():
            raise ValueError("a phase function needs one value above 0 for each angle")
        at = 2.0 * np.arcsin(node_places())
        between = [np.exp(np.interp(at, angle, np.log(row))) for row in value]
        if ratios is None:
            return cls(between)
        rows = np.asarray(ratios, float)
        return cls(between, [[np.interp(at, angle, row) for row in each] for each in rows])

    @classmethod
    def mixed(cls, tables: Sequence["PhaseTable"], weights: ArrayLike) -> "PhaseTable":
        """The mean of tables of the same wavelengths by weights (tables, C)."""
        rows = np.concatenate([table.values for table in tables])
        ratios = np.concatenate([table._whole_ratios() for table in tables], axis=1)
        return cls(rows, ratios).at_rows(np.hstack([np.diag(row) for row in np.asarray(weights)]))

    def __call__(self, nu: ArrayLike) -> FloatArray:
        """The phase function (..., C) at cosines (...,)."""
        place = np.sqrt(np.clip(0.5 - 0.5 * np.asarray(nu, dtype=float), 0.0, 1.0))
        return np.stack([np.interp(place, node_places(), row) for row in self.values], axis=-1)

    def polarisation(self, nu: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """P12 / P11 and P33 / P11 (..., C) at cosines (...,)."""
        place = np.sqrt(np.clip(0.5 - 0.5 * np.asarray(nu, dtype=float), 0.0, 1.0))
        p12, p33 = (
            np.stack([np.interp(place, node_places(), row) for row in rows], axis=-1)
            for rows in self._whole_ratios()
        )
        return p12, p33

    def _whole_ratios(self) -> FloatArray:
        """The ratios (2, C, PHASE_NODES), those of light that keeps its polarisation if none."""
        if self.ratios is not None:
            return self.ratios
        return np.stack([np.zeros_like(self.values), np.ones_like(self.values)])

    def coefficients(self, degree: int) -> FloatArray:
        """Legendre coefficients chi (C, degree + 1), of which the first is 1."""
        x, weight = _fine_cosines()
        legendre = np.polynomial.legendre.legvander(x, degree)
        chi = 2.0 * np.pi * (self(x).T * weight) @ legendre
        return np.asarray(chi / chi[:, :1])

    def mean_cosine(self) -> FloatArray:
        """The asymmetry (C,)."""
        return np.asarray(self.coefficients(1)[:, 1])

    def at_rows(self, weights: ArrayLike) -> "PhaseTable":
        """The rows that weights (rows, C) blend, none of them negative."""
        share = np.asarray(weights, dtype=float)
        values = share @ self.values
        if self.ratios is None:
            return PhaseTable(values)
        # A row of no weight is refused by its values.
        return PhaseTable(values, share @ (self.values * self.ratios) / np.maximum(values, 1e-300))

    @cached_property
    def _digest(self) -> bytes:
        ratios = b"" if self.ratios is None else self.ratios.tobytes()
        return hashlib.blake2b(self.values.tobytes() + ratios, digest_size=16).digest()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PhaseTable) and self._digest == other._digest

    def __hash__(self) -> int:
        return hash(self._digest)

    def __repr__(self) -> str:
        return f"PhaseTable({len(self.values)} wavelengths, {self._digest.hex()[:8]})"


def _checked_ratios(ratios: ArrayLike, values: FloatArray) -> FloatArray:
    """Checks the ratios and copies them to a read-only array.

    Interpolated and mixed, they may exceed what a particle can do by rounding only.
    """
    table = np.array(ratios, dtype=float)
    if table.shape != (2, *values.shape):
        raise ValueError(f"ratios of a phase table have the shape (2, *values), not {table.shape}")
    length = np.hypot(*table)
    if not (np.isfinite(table).all() and length.max() <= 1.0 + _ROUNDING):
        raise ValueError("squares of P12 / P11 and P33 / P11 must be numbers with a sum up to 1")
    table /= np.maximum(length, 1.0)
    table.flags.writeable = False
    return table


def node_places() -> FloatArray:
    """sin(theta / 2) (PHASE_NODES,) of the nodes."""
    return np.linspace(0.0, 1.0, PHASE_NODES)


def node_cosines() -> FloatArray:
    """Cosines (PHASE_NODES,) of the nodes' angles."""
    return np.asarray(1.0 - 2.0 * node_places() ** 2)


def _integral(table: FloatArray) -> FloatArray:
    """Integral (C,) over the sphere of lines between the nodes: d omega = 8 pi s ds."""
    s = node_places()
    low, high = table[:, :-1], table[:, 1:]
    step, start = np.diff(s), s[:-1]
    # Integrals of (low + t (high - low)) (start + t step) over t from 0 to 1.
    parts = start * 0.5 * (low + high) + step * (low / 6.0 + high / 3.0)
    return np.asarray(8.0 * np.pi * (parts * step).sum(axis=1))


def _fine_cosines() -> tuple[FloatArray, FloatArray]:
    """Cosines and weights (n,) by Gauss's rule in pieces: a table of lines has many kinks.

    Two points between each pair of nodes, in the coordinate s: d nu = 4 s ds.
    """
    s = node_places()
    root, weight = np.polynomial.legendre.leggauss(3)
    half = 0.5 * np.diff(s)[:, None]
    at = (0.5 * (s[:-1] + s[1:])[:, None] + half * root).ravel()
    return 1.0 - 2.0 * at * at, (half * weight).ravel() * 4.0 * at

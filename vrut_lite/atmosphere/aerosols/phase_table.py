"""A phase function as a table, one row a wavelength.

Nodes are uniform in sin(theta / 2): dense toward the sun, where particles scatter most, and the
square of the coordinate is (1 - nu) / 2, which kernels and shaders have without an arc cosine.
"""

import hashlib
from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

# Nodes: lines between them leave 3e-5 of Cornette and Shanks' lobe at g = 0.8.
PHASE_NODES = 1024


class PhaseTable:
    """Phase functions (C, PHASE_NODES) in sr^-1; their integral over the sphere is 1.

    Equal and hashable by content, so that it can be a part of a cache's key.

    Args:
        values: (C, PHASE_NODES), at least 0; each row is scaled to the integral 1.

    Raises:
        ValueError: the shape is another one, or a value is negative or no number.
    """

    def __init__(self, values: ArrayLike):
        table = np.array(values, dtype=float)
        if table.ndim != 2 or table.shape[1] != PHASE_NODES:
            raise ValueError(f"a phase table has {PHASE_NODES} angles, not the shape {table.shape}")
        if not (np.isfinite(table).all() and table.min() >= 0.0 and table.any(axis=1).all()):
            raise ValueError("a phase function is a number of at least 0 at each angle, not all 0")
        self.values = table / _integral(table)[:, None]
        self.values.flags.writeable = False

    @classmethod
    def of_function(cls, phase: Callable[[FloatArray], FloatArray]) -> "PhaseTable":
        """The table of a function of the cosine (n,), which gives (C, n) or, for one row, (n,)."""
        return cls(np.atleast_2d(phase(node_cosines())))

    @classmethod
    def of_angles(cls, angle_rad: ArrayLike, phase: ArrayLike) -> "PhaseTable":
        """The table of values (C, n) or (n,) at rising scattering angles (n,) from 0 to pi.

        Between angles the logarithm is linear in the angle.

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
        return cls([np.exp(np.interp(at, angle, np.log(row))) for row in value])

    def __call__(self, nu: ArrayLike) -> FloatArray:
        """The phase function (..., C) at cosines (...,)."""
        place = np.sqrt(np.clip(0.5 - 0.5 * np.asarray(nu, dtype=float), 0.0, 1.0))
        return np.stack([np.interp(place, node_places(), row) for row in self.values], axis=-1)

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
        return PhaseTable(np.asarray(weights, dtype=float) @ self.values)

    @cached_property
    def _digest(self) -> bytes:
        return hashlib.blake2b(self.values.tobytes(), digest_size=16).digest()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PhaseTable) and self._digest == other._digest

    def __hash__(self) -> int:
        return hash(self._digest)

    def __repr__(self) -> str:
        return f"PhaseTable({len(self.values)} wavelengths, {self._digest.hex()[:8]})"


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

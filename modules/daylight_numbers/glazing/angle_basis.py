"""Angle bases of measured glazing: patches of a hemisphere in rings of equal polar angle.

Klems 1994, "A new method for predicting the solar heat gain of complex fenestration systems", in
the numbering of LBNL's WINDOW and of Radiance's bsdf_m.c: rings from the normal outwards, patches
of a ring from azimuth 0 on, the first with its middle there.

A direction is that in which light travels on behind the pane. Its coordinates are x = up x z,
y = z x x and z, the normal that points to where the light goes. Light from a direction has the
number of the patch into which it would travel straight on: an unscattered beam keeps its number.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vrut_lite.numeric_types import BoolArray, FloatArray, IntArray

# A patch's neighbours are looked up on a circle around its middle: its radius in radii of a disc of
# the patch's solid angle, and the number of places.
_BESIDE, _AROUND = 1.8, 24


@dataclass(frozen=True)
class AngleBasis:
    """A basis of N patches: each ring's upper polar angle in degrees and its number of patches."""

    name: str
    upper_deg: tuple[float, ...]
    count: tuple[int, ...]

    def __len__(self) -> int:
        return sum(self.count)

    @cached_property
    def _edges_deg(self) -> FloatArray:
        return np.array([0.0, *self.upper_deg])

    @cached_property
    def _ring(self) -> IntArray:
        return np.repeat(np.arange(len(self.count)), self.count)

    @cached_property
    def _first(self) -> IntArray:
        return np.concatenate([[0], np.cumsum(self.count)[:-1]])

    @cached_property
    def projected_sr(self) -> FloatArray:
        """Solid angles (N,) weighted by the cosine; their sum is pi."""
        sine2 = np.sin(np.radians(self._edges_deg)) ** 2
        return np.asarray((np.pi * np.diff(sine2) / self.count)[self._ring])

    @cached_property
    def solid_sr(self) -> FloatArray:
        """Solid angles (N,)."""
        cosine = np.cos(np.radians(self._edges_deg))
        return np.asarray((-2.0 * np.pi * np.diff(cosine) / self.count)[self._ring])

    @cached_property
    def middles(self) -> FloatArray:
        """Unit vectors (N, 3) in the middle of each patch; that of a cap is its axis."""
        polar = 0.5 * (self._edges_deg[:-1] + self._edges_deg[1:])
        polar[np.array(self.count) == 1] = 0.0
        turn = 2.0 * np.pi * (np.arange(len(self)) - self._first[self._ring])
        turn /= np.array(self.count)[self._ring]
        sine, cosine = np.sin(np.radians(polar))[self._ring], np.cos(np.radians(polar))[self._ring]
        return np.stack([sine * np.cos(turn), sine * np.sin(turn), cosine], axis=1)

    def patch_of(self, directions: FloatArray) -> IntArray:
        """Patches (...) of unit vectors (..., 3) with z >= 0."""
        x, y, z = np.moveaxis(np.asarray(directions, float), -1, 0)
        polar = np.degrees(np.arctan2(np.hypot(x, y), z))
        ring = np.searchsorted(self._edges_deg[1:-1], polar, side="right")
        number = np.array(self.count)[ring]
        turn = np.floor(np.arctan2(y, x) / (2.0 * np.pi) * number + 0.5).astype(np.int64)
        return np.asarray(self._first[ring] + np.mod(turn, number))

    @cached_property
    def half_turned(self) -> IntArray:
        """The patch (N,) half a turn around the axis from each."""
        return self.patch_of(self.middles * [-1.0, -1.0, 1.0])

    @cached_property
    def neighbours(self) -> BoolArray:
        """Which patches (N, N) lie around each."""
        axis = np.where(np.abs(self.middles[:, 2:]) > 0.9, [[1.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]])
        along = np.cross(axis, self.middles)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        across = np.cross(self.middles, along)
        radius = _BESIDE * np.sqrt(self.solid_sr / np.pi)
        turn = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
        around = np.cos(turn)[:, None, None] * along + np.sin(turn)[:, None, None] * across
        at = np.cos(radius)[:, None] * self.middles + np.sin(radius)[:, None] * around
        found = np.zeros((len(self), len(self)), bool)
        number = np.broadcast_to(np.arange(len(self)), at.shape[:2])
        above = at[..., 2] > 0.0
        found[number[above], self.patch_of(at)[above]] = True
        np.fill_diagonal(found, False)
        return found


_KLEMS = (
    AngleBasis(
        "LBNL/Klems Full",
        (5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 90.0),
        (1, 8, 16, 20, 24, 24, 24, 16, 12),
    ),
    AngleBasis(
        "LBNL/Klems Half", (6.5, 19.5, 32.5, 46.5, 61.5, 76.5, 90.0), (1, 8, 12, 16, 20, 12, 4)
    ),
    AngleBasis("LBNL/Klems Quarter", (9.0, 27.0, 46.0, 66.0, 90.0), (1, 8, 12, 12, 8)),
)
KLEMS = {basis.name.lower(): basis for basis in _KLEMS}
KLEMS_FULL = _KLEMS[0]

"""A surface over a square as triangles: small where it matters, without a crack between sizes.

Right-angled triangles are halved at the middle of their longest side; a middle may only be used
if the triangles on both of its sides exist (Lindstrom et al. 1996, "Real-time, continuous level of
detail rendering of height fields"; Evans et al. 2001, "Right-triangulated irregular networks").
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import IntArray

# Corners (n, 3, 2) of triangles in lattice units: both ends of the longest side, the right angle.
WantsSplit = Callable[[IntArray], NDArray[np.bool_]]


def adaptive_triangles(size: int, wants_split: WantsSplit) -> tuple[IntArray, IntArray]:
    """Triangles over the lattice square [0, size] x [0, size], `size` a power of two.

    Args:
        size: side in lattice units.
        wants_split: which of some triangles are too coarse.

    Returns:
        Points (V, 2) on the lattice, and triangles (F, 3), all turning alike.
    """
    used = _closed(_wanted_middles(size, wants_split), size)
    corners = _halved_where(size, lambda found: np.isin(_key(_middle(found)), used))
    points, faces = np.unique(_key(corners), return_inverse=True)
    return np.stack([points >> 32, points & 0xFFFFFFFF], axis=1), faces.reshape(-1, 3)


def _wanted_middles(size: int, wants_split: WantsSplit) -> IntArray:
    """Keys of the middles at which triangles would be halved, whatever their neighbours want."""
    middles = []

    def remember(corners: IntArray) -> NDArray[np.bool_]:
        wanted = wants_split(corners)
        middles.append(_key(_middle(corners[wanted])))
        return wanted

    _halved_where(size, remember)
    return np.unique(np.concatenate(middles))


def _halved_where(size: int, halve: WantsSplit) -> IntArray:
    """The triangles (F, 3, 2) that are left when all that `halve` says are halved, and so on."""
    low, high = (0, 0), (size, size)
    corners = np.array([[low, high, (size, 0)], [high, low, (0, size)]], dtype=np.int64)
    done = []
    while len(corners):
        divisible = np.abs(corners[:, 0] - corners[:, 1]).max(axis=1) > 1
        split = np.zeros(len(corners), dtype=bool)
        split[divisible] = halve(corners[divisible])
        done.append(corners[~split])
        a, b, c = np.moveaxis(corners[split], 1, 0)
        m = (a + b) // 2
        corners = np.concatenate([np.stack([c, a, m], axis=1), np.stack([b, c, m], axis=1)])
    return np.concatenate(done)


def _closed(keys: IntArray, size: int) -> IntArray:
    """With every middle, from the finest on, the four points of the triangles on its two sides."""
    waiting = np.unique(keys)
    closed = [waiting[:0]]
    spacing = 1
    while spacing < size:
        for diagonal in (False, True):
            points = np.stack([waiting >> 32, waiting & 0xFFFFFFFF], axis=1)
            odd = (points // spacing) % 2 == 1
            here = odd.all(axis=1) if diagonal else odd.any(axis=1) & ~odd.all(axis=1)
            closed.append(waiting[here])
            steps = (
                [(1, 1), (1, -1), (-1, 1), (-1, -1)]
                if diagonal
                else [(1, 0), (-1, 0), (0, 1), (0, -1)]
            )
            around = (points[here][:, None] + spacing * np.array(steps)).reshape(-1, 2)
            inside = np.all((around >= 0) & (around <= size), axis=1)
            waiting = np.unique(np.concatenate([waiting[~here], _key(around[inside])]))
        spacing *= 2
    return np.unique(np.concatenate(closed))


def _middle(corners: IntArray) -> IntArray:
    return (corners[:, 0] + corners[:, 1]) // 2


def _key(points: IntArray) -> IntArray:
    return np.asarray((points[..., 0] << 32) | points[..., 1])

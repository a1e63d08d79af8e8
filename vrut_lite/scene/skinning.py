"""Morph targets and skins, as glTF 2.0 has them (sections 3.7.2.2 and 3.7.3)."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def morphed(values: Floats, deltas: list[tuple[float, Floats]]) -> Floats:
    """Positions or normals (V, 3) plus weighted displacements (V, 3)."""
    moved = values.astype(np.float64)
    for weight, delta in deltas:
        moved += weight * delta
    return moved


def skin_matrices(joints: NDArray[np.int64], weights: Floats, palette: Floats) -> Floats:
    """One matrix (V, 4, 4) a vertex: the joints' (J, 4, 4) by weight.

    joints and weights are (V, 4 n). Weights are scaled to a sum of 1; a vertex without any follows
    its first joint.
    """
    total = weights.sum(axis=1, keepdims=True)
    whole = np.where(total > 0, weights / np.where(total > 0, total, 1.0), 0.0)
    whole[:, 0] += np.where(total[:, 0] > 0, 0.0, 1.0)
    matrices = np.zeros((len(joints), 4, 4))
    for column in range(joints.shape[1]):
        matrices += whole[:, column, None, None] * palette[joints[:, column]]
    return matrices


def bent_positions(positions: Floats, matrices: Floats) -> Floats:
    """Points (V, 3), each by its own matrix."""
    moved = np.einsum("vij,vj->vi", matrices[:, :3, :3], positions)
    return np.asarray(moved + matrices[:, :3, 3])


def bent_normals(normals: Floats, matrices: Floats) -> Floats:
    """Normals (V, 3) by the cofactors of each matrix, not of unit length."""
    rows = matrices[:, :3, :3]
    cofactors = np.stack([np.cross(rows[:, i - 2], rows[:, i - 1]) for i in range(3)], axis=1)
    return np.asarray(np.einsum("vij,vj->vi", cofactors, normals))

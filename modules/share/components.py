"""Principal components."""

import numpy as np

from vrut_lite.numeric_types import Float32Array


def principal(gram: Float32Array, count: int) -> Float32Array:
    """The first eigenvectors (n, <= count) of a symmetric matrix (n, n), the strongest first."""
    vectors = np.linalg.eigh(np.asarray(gram, float))[1]
    return np.asarray(vectors[:, ::-1][:, :count], np.float32)

"""Phase functions for volumes of air made by hand."""

import numpy as np

from vrut_lite.array import Array


def lobe(g=0.0, factor=1.0, form=0.0, angles=8192):
    """factor (1 + form nu^2) / (1 + g^2 - 2 g nu)^1.5 at angles uniform in sin(angle / 2)."""
    nu = 1.0 - 2.0 * np.linspace(0.0, 1.0, angles) ** 2
    values = factor * (1.0 + form * nu * nu) / (1.0 + g * g - 2.0 * g * nu) ** 1.5
    return Array(np.repeat(values[:, None], 3, axis=1).astype(np.float32))

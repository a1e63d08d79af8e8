"""Candela that a luminaire sends in each direction, as a scene's table."""

from typing import NamedTuple

import numpy as np

from vrut_lite.numeric_types import Float32Array, FloatArray

MOST_ANGLES = 721
# Angles that files round.
NEARLY_DEG = 0.1


class Photometry(NamedTuple):
    """A luminaire's light: `table` (181, 73) in [0, 1], and the candela where it is 1.

    Rows go from the luminaire's axis to its opposite, columns once around it from its own +X by
    +Y. The axis is the nadir of type C, and where lamps of types A and B are aimed.
    """

    candela: float
    table: Float32Array

    @classmethod
    def of(cls, table: FloatArray) -> "Photometry":
        """The photometry of candela (181, 73)."""
        most = float(table.max())
        return cls(most, (table / max(most, 1e-30)).astype(np.float32))

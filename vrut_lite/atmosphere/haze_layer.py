"""Layers of haze that sunlight passes, as messages carry them."""

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from vrut_lite import checks
from vrut_lite.numeric_types import FloatArray, Vector

# Wavelengths of their optical depths.
HAZE_NM = (680.0, 550.0, 440.0)
_MOST_HEIGHT_M, _MOST_DEPTH = 1e6, 1e4
_LEAST_DEPTH = 1e-12


class HazeLayer(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A layer of aerosol: exponential from the ground up, or a tent about a peak.

    `optical_depth` is vertical, at `HAZE_NM`; `height_m` is the scale height, with a peak at the
    altitude `peak_m` the tent's half width.
    """

    height_m: float
    optical_depth: Vector
    peak_m: float | None = None

    def depth_at(self, wavelength_nm: ArrayLike) -> FloatArray:
        """Vertical depth (n,): its logarithm is a parabola of the wavelength's."""
        log_depth = np.log(np.maximum(self.optical_depth, _LEAST_DEPTH))
        parabola = np.polyfit(np.log(HAZE_NM), log_depth, 2)
        return np.asarray(np.exp(np.polyval(parabola, np.log(wavelength_nm))))

    def check(self) -> None:
        """A height to divide by, and depths."""
        checks.number(self, "height_m", 1.0, _MOST_HEIGHT_M)
        checks.light(self, "optical_depth", _MOST_DEPTH)
        if self.peak_m is not None:
            checks.number(self, "peak_m", -_MOST_HEIGHT_M, _MOST_HEIGHT_M)

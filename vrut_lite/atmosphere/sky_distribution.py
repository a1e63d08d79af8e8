"""Luminance distributions of the sky: the five-term form that CIE S 011 and Perez share."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

# Lowest cosine of the zenith angle at which the gradation is evaluated: 0.6 degrees up.
_LOWEST = 0.01
# The same where Perez's b is above 0 and the gradation would grow without bound: 15 degrees up.
_LOWEST_RISING = float(np.sin(np.radians(15.0)))


class Distribution(NamedTuple):
    """(1 + a exp(b / cos z)) (1 + c (exp(d gamma) - k) + e cos^2 gamma); arrays (...,) of hours.

    z is a direction's zenith angle, gamma its angle from the sun.
    """

    a: ArrayLike
    b: ArrayLike
    c: ArrayLike
    d: ArrayLike
    e: ArrayLike
    k: ArrayLike = 0.0

    def relative_luminance(self, cos_zenith: ArrayLike, cos_gamma: ArrayLike) -> FloatArray:
        """Luminance (...,) in an arbitrary unit, 0 or more; the arguments' shapes broadcast."""
        return np.maximum(self.gradation(cos_zenith) * self.indicatrix(cos_gamma), 0.0)

    def gradation(self, cos_zenith: ArrayLike) -> FloatArray:
        """The factor (...,) from horizon to zenith; monotonic."""
        a, b = (np.asarray(term, dtype=float) for term in (self.a, self.b))
        lowest = np.where(b > 0.0, _LOWEST_RISING, _LOWEST)
        return np.asarray(1.0 + a * np.exp(b / np.maximum(cos_zenith, lowest)))

    def indicatrix(self, cos_gamma: ArrayLike) -> FloatArray:
        """The factor (...,) by the angle from the sun."""
        c, d, e, k = (np.asarray(term, dtype=float) for term in (self.c, self.d, self.e, self.k))
        cosine = np.clip(cos_gamma, -1.0, 1.0)
        return np.asarray(1.0 + c * (np.exp(d * np.arccos(cosine)) - k) + e * cosine * cosine)


class Overcast(NamedTuple):
    """Moon and Spencer's overcast sky, CIE's sixteenth: three times as bright above as below."""

    def relative_luminance(self, cos_zenith: ArrayLike, cos_gamma: ArrayLike) -> FloatArray:
        """Luminance (...,) over the zenith's."""
        cosine, _ = np.broadcast_arrays(np.asarray(cos_zenith, dtype=float), cos_gamma)
        return (1.0 + 2.0 * np.maximum(cosine, 0.0)) / 3.0

"""Sums over the upper hemisphere, by directions counted from the sun's azimuth."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.atmosphere.sky_distribution import Distribution, Overcast
from vrut_lite.numeric_types import FloatArray


class HemisphereNodes(NamedTuple):
    """Directions (n,) of a half hemisphere beside the sun, for skies that are alike on both sides.

    `weight` holds twice the solid angle times the cosine from the zenith: the weights sum to pi.
    """

    cos_zenith: FloatArray
    cos_azimuth: FloatArray
    weight: FloatArray

    def cos_gamma(self, sun_zenith_rad: ArrayLike) -> FloatArray:
        """Cosine (..., n) of the angle from suns (...,)."""
        zenith = np.asarray(sun_zenith_rad, dtype=float)[..., None]
        sine = np.sqrt(1.0 - self.cos_zenith**2)
        return np.cos(zenith) * self.cos_zenith + np.sin(zenith) * sine * self.cos_azimuth


@lru_cache(maxsize=4)
def nodes(count: int) -> HemisphereNodes:
    """`count` squared of them: Gauss-Legendre in the zenith angle's cosine, midpoints around."""
    x, w = np.polynomial.legendre.leggauss(count)
    mu, weight = 0.5 * (x + 1.0), 0.5 * w
    around = (np.arange(count) + 0.5) * np.pi / count
    shape = (count, count)
    solid = np.broadcast_to((weight * mu)[:, None] * 2.0 * np.pi / count, shape)
    return HemisphereNodes(np.repeat(mu, count), np.tile(np.cos(around), count), solid.ravel())


def horizontal(
    distribution: Distribution | Overcast, sun_zenith_rad: ArrayLike, count: int = 64
) -> FloatArray:
    """Illuminance (...,) of level ground in the unit of a distribution of skies (...,)."""
    at = nodes(count)
    if isinstance(distribution, Distribution):
        terms = (np.asarray(term, dtype=float)[..., None] for term in distribution)
        distribution = Distribution(*terms)
    values = distribution.relative_luminance(at.cos_zenith, at.cos_gamma(sun_zenith_rad))
    return values @ at.weight

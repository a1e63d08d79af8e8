"""Glare: light that an eye scatters around bright sources, in pictures for display.

CIE 146:2002, the general equation of disability glare: a source of illuminance E (lx) at the eye
adds, at an angle theta of 0.1 to 100 degrees from it, the veiling luminance

    E (10 / theta^3 + (5 / theta^2 + 0.1 p / theta) (1 + (age / 62.5)^4) + 0.0025 p),

here at an age of 25 years with brown eyes (pigmentation p = 0.5). Light within 0.1 degrees stays
where it is. A pixel loses the light that it scatters to others in the picture, so that light is
kept and an even picture does not change; light from outside the picture is left out. Angles are
those of the picture's middle.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vrut_lite.lazy import lazy
from vrut_lite.numeric_types import FloatArray

_fft = lazy("scipy.fft")
_LEAST_DEG = 0.1
_AGE_TERM, _PIGMENTATION = 1.0 + (25.0 / 62.5) ** 4, 0.5
# Pixels from the middle within which the function is averaged, and points on a pixel's edge.
_NEAR_PX, _POINTS = 2, 9


def scattered(angle_deg: FloatArray) -> FloatArray:
    """Scattered share per steradian at angles (...) in degrees; 0 below 0.1 degrees."""
    theta = np.maximum(angle_deg, _LEAST_DEG)
    wide = (5.0 / theta**2 + 0.1 * _PIGMENTATION / theta) * _AGE_TERM
    share = 10.0 / theta**3 + wide + 0.0025 * _PIGMENTATION
    return np.where(angle_deg < _LEAST_DEG, 0.0, share)


def with_glare(
    radiance: NDArray[np.floating], amount: float, pixel_rad: float
) -> NDArray[np.float64]:
    """A picture (h, w, 3) with glare; `amount` 1 is an eye's, 0 none.

    `pixel_rad` is the angle that a pixel in the middle sees.
    """
    size = radiance.shape[:2]
    spectrum, own = _transfer(size, pixel_rad)
    shape = _padded(size)
    known = np.where(np.isfinite(radiance), radiance, 0.0).astype(np.float64)
    # In 64 bits: rounding the sun's disc to 32 would show in the sky.
    blurred = _fft.irfft2(
        _fft.rfft2(known, shape, axes=(0, 1)) * spectrum[..., None], shape, axes=(0, 1)
    )[: size[0], : size[1]]
    return radiance + amount * (blurred - own[..., None] * known)


def _padded(size: tuple[int, int]) -> tuple[int, int]:
    height, width = (_fft.next_fast_len(2 * side - 1, real=True) for side in size)
    return height, width


@lru_cache(maxsize=2)
def _transfer(size: tuple[int, int], pixel_rad: float) -> tuple[NDArray[np.complex128], FloatArray]:
    """The kernel's transform, and the share (h, w) that a pixel scatters to others."""
    shape = _padded(size)
    offsets = (np.abs(np.fft.fftfreq(side, 1.0 / side)) for side in shape)
    down, across = np.meshgrid(*offsets, indexing="ij")
    kernel = _per_pixel(down, across, pixel_rad)
    near = np.argwhere((down <= _NEAR_PX) & (across <= _NEAR_PX))
    within = (np.arange(_POINTS) + 0.5) / _POINTS - 0.5
    y, x = np.meshgrid(within, within)
    for row, column in near:
        place = down[row, column] + y, across[row, column] + x
        kernel[row, column] = _per_pixel(*place, pixel_rad).mean()
    kernel[0, 0] = 0.0
    spectrum = _fft.rfft2(kernel)
    own = _fft.irfft2(_fft.rfft2(np.ones(size), shape) * spectrum, shape)
    return spectrum, own[: size[0], : size[1]]


def _per_pixel(down_px: FloatArray, across_px: FloatArray, pixel_rad: float) -> FloatArray:
    return scattered(np.degrees(np.hypot(down_px, across_px) * pixel_rad)) * pixel_rad**2

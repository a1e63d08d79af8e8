"""Smooth reflectance spectra of colours: a sigmoid of a polynomial of the wavelength.

Jakob and Hanika 2019, "A Low-Dimensional Function Space for Efficient Spectral Upsampling": 0 < R <
1 everywhere, and the colour under D65 is the given one. Coefficients are found by damped
Gauss-Newton steps from grey, the colour being led from grey to its own in steps.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from daylight_numbers.spectra.daylight import d65
from daylight_numbers.spectra.eye_responses import HIGHEST_NM, LOWEST_NM, response_matrix
from vrut_lite.geometry.colour import SRGB_FROM_XYZ
from vrut_lite.numeric_types import FloatArray

# Channels outside are brought to these: a sigmoid gets to neither end.
_LEAST, _MOST = 1e-3, 1.0 - 1e-3
_STEPS, _ITERATIONS, _LAST_ITERATIONS = 12, 4, 40
_DAMPING = 1e-9
_STEP_NM = 5.0


def reflectances_of(rgb: ArrayLike, wavelength_nm: ArrayLike) -> FloatArray:
    """Reflectances (N, W) of colours (N, 3), linear sRGB from 0 to 1, at wavelengths (W,) in nm.

    Grey is the same at all wavelengths. The colour under D65 is the given one to rounding; channels
    of 0 and 1 are taken as 0.001 and 0.999.
    """
    colours = np.asarray(rgb, float)
    unique, which = np.unique(colours, axis=0, return_inverse=True)
    grey = (unique == unique[:, :1]).all(axis=1)
    at = _polynomial(np.asarray(wavelength_nm, float))
    found = np.empty((len(unique), len(at)))
    found[grey] = np.clip(unique[grey, :1], 0.0, 1.0)
    found[~grey] = _sigmoid(coefficients_of(unique[~grey]) @ at.T)
    return found[which.reshape(-1)]


def coefficients_of(rgb: FloatArray) -> FloatArray:
    """Coefficients (N, 3) of the polynomials of colours (N, 3), the square's first."""
    target = np.clip(rgb, _LEAST, _MOST)
    grey = target.mean(axis=1, keepdims=True)
    found = np.zeros_like(target)
    found[:, 2] = ((grey - 0.5) / np.sqrt(grey * (1.0 - grey)))[:, 0]
    for step in range(1, _STEPS + 1):
        share = step / _STEPS
        led = (1.0 - share) * grey + share * target
        for _ in range(_LAST_ITERATIONS if step == _STEPS else _ITERATIONS):
            found = _better(found, led)
    return found


def _better(found: FloatArray, target: FloatArray) -> FloatArray:
    """The coefficients (N, 3) after a damped step; the same where it brings no colour nearer."""
    at, colour_of = _fine()
    value = found @ at.T
    off = _sigmoid(value) @ colour_of - target
    slope = 0.5 * (1.0 + value * value) ** -1.5
    jacobian = np.einsum("nw,wi,wc->nci", slope, at, colour_of)
    square = np.swapaxes(jacobian, 1, 2) @ jacobian
    damped = square + (_DAMPING * np.eye(3))
    move = np.linalg.solve(damped, np.swapaxes(jacobian, 1, 2) @ off[..., None])[..., 0]
    error = np.linalg.norm(off, axis=1)
    for _ in range(6):
        tried = found - move
        better = np.linalg.norm(_sigmoid(tried @ at.T) @ colour_of - target, axis=1) < error
        if better.all():
            return tried
        move = np.where(better[:, None], move, 0.4 * move)
    return np.where(better[:, None], tried, found)


def _sigmoid(value: FloatArray) -> FloatArray:
    return np.asarray(0.5 + 0.5 * value / np.sqrt(1.0 + value * value))


def _polynomial(wavelength_nm: FloatArray) -> FloatArray:
    """Powers 2, 1 and 0 (W, 3) of the wavelength as a share of the visible range."""
    x = (wavelength_nm - LOWEST_NM) / (HIGHEST_NM - LOWEST_NM)
    return np.stack([x * x, x, np.ones_like(x)], axis=-1)


@lru_cache(maxsize=1)
def _fine() -> tuple[FloatArray, FloatArray]:
    """The powers (n, 3), and the linear sRGB (n, 3) under D65 of each wavelength alone."""
    nm = np.arange(LOWEST_NM, HIGHEST_NM + 1.0, _STEP_NM)
    rgb = d65(nm)[:, None] * response_matrix(tuple(nm.tolist()))[:, :3] @ SRGB_FROM_XYZ.T
    return _polynomial(nm), rgb / rgb.sum(axis=0)

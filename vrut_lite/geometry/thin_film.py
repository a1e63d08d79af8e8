"""Thin films: reflectance of soap, oil or oxide on a surface in sunlight, in linear sRGB.

KHR_materials_iridescence, after Belcour and Barla 2017 ("A Practical Extension to Microfacet Theory
for the Modeling of Varying Iridescence"). The interference of all reflections within the film is
summed in closed form (Airy) for both polarisations, wavelength by wavelength, and weighed by the
sun's spectrum: glTF's own four Gaussians stop after two orders, and tint white by equal energy.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.geometry.colour import integration_matrix, solar_irradiance
from vrut_lite.numeric_types import Float32Array, FloatArray

FILM_SHAPE = (48, 24, 32)
_NM = tuple(np.arange(390.0, 731.0, 10.0))
# Film thickness (nm) above which interference colours average out.
MOST_NM = 4000.0
_LEAST_MU = 1e-3
# Largest reflectance at normal incidence: a perfect mirror has no index.
_MOST_F0 = 0.9999


def film_reflectance(
    mu: ArrayLike, f0: ArrayLike, ior: float, thickness_nm: ArrayLike
) -> FloatArray:
    """Reflectance (..., 3) at view cosines of surfaces that without film have `f0` (all (...,)).

    The film's index is `ior`; the surface below reflects like a dielectric of `f0` to air.
    """
    mu, f0, thickness = np.broadcast_arrays(
        *(np.asarray(value, float)[..., None] for value in (mu, f0, thickness_nm))
    )
    root = np.sqrt(np.clip(f0, 0.0, _MOST_F0))
    below = (1.0 + root) / (1.0 - root)
    sine2 = 1.0 - mu * mu
    in_film, in_body = np.sqrt(1.0 - sine2 / ior**2), np.sqrt(1.0 - sine2 / below**2)
    turn = np.exp(4j * np.pi * ior * thickness * in_film / np.array(_NM))
    weights = _weights()
    total = np.zeros((*mu.shape[:-1], 3))
    # Perpendicular to the plane of incidence, and in it.
    for first, second in (
        (_ratio(mu, ior * in_film), _ratio(ior * in_film, below * in_body)),
        (_ratio(ior * mu, in_film), _ratio(below * in_film, ior * in_body)),
    ):
        amplitude = (first + second * turn) / (1.0 + first * second * turn)
        total += 0.5 * (np.abs(amplitude) ** 2 @ weights)
    return np.clip(total, 0.0, 1.0)


def _ratio(one: FloatArray, other: FloatArray) -> FloatArray:
    return np.asarray((one - other) / (one + other))


@lru_cache(maxsize=1)
def _weights() -> FloatArray:
    """Weights (n, 3) of wavelengths in the sun's red, green and blue; columns sum to 1."""
    colours = integration_matrix(_NM) * solar_irradiance(_NM)[:, None]
    return np.asarray(colours / colours.sum(axis=0))


@lru_cache(maxsize=64)
def film_table(ior: float, least_nm: float, most_nm: float) -> Float32Array:
    """Schlick's f0 (thicknesses, 24, 32, 3) that gives the film's reflectance with an f90 of 1.

    Thicknesses run in equal steps, the surface's own reflectance as the square of equal steps from
    0 to 1, view cosines in equal steps from 0 to 1. Each channel belongs to a surface with that
    reflectance in the same channel. One thickness gives one layer.
    """
    layers = 1 if least_nm == most_nm else FILM_SHAPE[0]
    thickness_nm = np.linspace(min(least_nm, MOST_NM), min(most_nm, MOST_NM), layers)
    f0 = np.linspace(0.0, 1.0, FILM_SHAPE[1]) ** 2
    mu = np.maximum(np.linspace(0.0, 1.0, FILM_SHAPE[2]), _LEAST_MU)
    seen = film_reflectance(
        mu, f0[:, None], float(np.clip(ior, 1.0, 4.0)), thickness_nm[:, None, None]
    )
    at_grazing = ((1.0 - mu) ** 5)[:, None]
    table = np.clip((seen - at_grazing) / (1.0 - at_grazing), 0.0, 1.0).astype(np.float32)
    table.flags.writeable = False
    return table

"""An atmosphere for compiled code: its numbers, and the light that a ray through it loses.

Rays and optical paths are those of `bruneton_sky.kernels`, whose helpers this imports: one
geometry for both. A ray is (altitude, radius, perigee radius, perigee altitude, y, radius * mu).
"""

import math
from typing import NamedTuple

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.kernels import _exponential_path, _layered_path, _ray
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
compiled = njit(cache=True, nogil=True, error_model="numpy")
make_ray = _ray


class Medium(NamedTuple):
    """An atmosphere as compiled code reads it; coefficients (2 or 3, C), lengths in m."""

    radius: float
    top: float
    rayleigh_scale: float
    mie_scale: float
    extinction: FloatArray
    scattering: FloatArray
    absorber_altitude: FloatArray
    absorber_density: FloatArray
    g: float
    albedo: FloatArray
    # Three wavelengths stand for all where distances are drawn.
    picked: NDArray[np.intp]


def medium_of(atmosphere: Atmosphere) -> Medium:
    """An atmosphere of any number of wavelengths."""
    molecules, aerosol = atmosphere.rayleigh_scattering, atmosphere.mie_scattering
    extinction = [molecules, atmosphere.mie_extinction, atmosphere.absorption_extinction]
    count = len(molecules)
    return Medium(
        atmosphere.ground_radius_m,
        atmosphere.top_altitude_m,
        atmosphere.rayleigh_scale_height_m,
        atmosphere.mie_scale_height_m,
        np.array(extinction),
        np.array([molecules, aerosol]),
        np.array(atmosphere.absorber_altitude_m),
        np.array(atmosphere.absorber_density),
        atmosphere.mie_g,
        np.array(atmosphere.ground_albedo),
        np.array([count // 8, count // 2, count - 1 - count // 8]),
    )


@compiled
def dim(medium, ray, altitude, y, scale, weight):  # type: ignore[no-untyped-def]
    """Multiply weights by a scale and by the exact transmittance of a ray as far as y."""
    rayleigh = path_to(ray, altitude, y, medium.rayleigh_scale)
    mie = path_to(ray, altitude, y, medium.mie_scale)
    absorbed = _layered_path(ray, y, medium.absorber_altitude, medium.absorber_density)
    extinction = medium.extinction
    for c in range(weight.size):
        depth = extinction[0, c] * rayleigh + extinction[1, c] * mie + extinction[2, c] * absorbed
        weight[c] *= scale * math.exp(-depth)


@compiled
def path_to(ray, altitude, y, scale):  # type: ignore[no-untyped-def]
    """Metres of sea-level air of a scale height, from the start of a ray to y."""
    start, end = math.exp(-ray[0] / scale), math.exp(-altitude / scale)
    return _exponential_path(ray, start, altitude, y, end, scale)


@compiled
def y_at_top(medium, ray):  # type: ignore[no-untyped-def]
    """y where a ray leaves the atmosphere."""
    return max(math.sqrt(max(medium.top - ray[3], 0.0)), ray[4])


@compiled
def densities(medium, altitude):  # type: ignore[no-untyped-def]
    """Relative densities of molecules and aerosol."""
    return math.exp(-altitude / medium.rayleigh_scale), math.exp(-altitude / medium.mie_scale)


@compiled
def absorber_at(altitude, nodes, density):  # type: ignore[no-untyped-def]
    """The absorber's relative density."""
    for k in range(nodes.size - 1):
        if nodes[k] <= altitude < nodes[k + 1]:
            part = (altitude - nodes[k]) / (nodes[k + 1] - nodes[k])
            return density[k] + part * (density[k + 1] - density[k])
    return 0.0


@compiled
def distance_to(ray, y):  # type: ignore[no-untyped-def]
    """Metres from the ray's start."""
    return y * math.sqrt(y * y + 2.0 * ray[2]) - ray[5]


@compiled
def dot(a, b):  # type: ignore[no-untyped-def]
    """Scalar product of arrays or tuples."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]

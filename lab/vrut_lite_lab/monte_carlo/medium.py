"""An atmosphere for the compiled path tracer: its parameters, and transmittances along rays.

Rays and optical paths are those of `path_kernels`: one geometry for the whole package. A ray is
(altitude, radius, perigee radius, perigee altitude, y, radius * mu), see `geometry`.
"""

import math
from typing import NamedTuple

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.optical_path import TENT
from bruneton_sky.path_kernels import (
    compiled,
    exponential_layers_path,
    exponential_path,
    layered_path,
    layers_density,
)
from bruneton_sky.phase import particles_phase

from vrut_lite.numeric_types import FloatArray

# Weights of wavelengths that share a path: their scattering to this power (0 makes weak ones noisy,
# -2 strong ones). The second number is the least scattering, as a share of the strongest.
IMPORTANCE_POWER, LEAST_SCATTERING = -1.5, 1e-2
# Nodes of the aerosol's phase function, uniform in sin(theta / 2): lines between them leave 1e-5 of
# a lobe with g = 0.9.
_PHASE_NODES = 8193
_TENT = np.array(TENT)


class Medium(NamedTuple):
    """An atmosphere as compiled code reads it; coefficients (6 or 5, C) in 1/m, lengths in m.

    Extinction of molecules, aerosol, absorber, fog, aerosol aloft and of the stratosphere;
    scattering of the same without the absorber. The scales of fog and aloft are 0 where there is
    none; `veil` (3,) is the stratosphere's tent: its foot, peak and end.
    `phase` (1 or 3, nodes, C) in sr^-1 is the aerosol's phase function and, where the medium
    polarises, P12 and P33 of its scattering matrix; `turn` (nodes - 1,) is the cumulated chance
    that its mean over the wavelengths gives a turn between two nodes; others are fog's and those
    of aerosol aloft. `anisotropy` is the part of the molecules' light that follows Rayleigh's
    matrix.
    """

    radius: float
    top: float
    mie_scale: float
    aloft_scale: float
    fog_scale: float
    veil: FloatArray
    extinction: FloatArray
    scattering: FloatArray
    # The molecules' layers (4, n), see `ExponentialLayers.array`.
    molecules: FloatArray
    absorber_altitude: FloatArray
    absorber_density: FloatArray
    phase: FloatArray
    turn: FloatArray
    fog_phase: FloatArray
    fog_turn: FloatArray
    aloft_phase: FloatArray
    aloft_turn: FloatArray
    veil_phase: FloatArray
    veil_turn: FloatArray
    albedo: FloatArray
    # The weight (C,) with which each wavelength's share of a path starts.
    importance: FloatArray
    polarises: bool
    anisotropy: float


def medium_of(atmosphere: Atmosphere, polarises: bool) -> Medium:
    """An atmosphere of any number of wavelengths, with scattering matrices or phases alone.

    Particles without ratios of a matrix keep light's polarisation.
    """
    molecules, aerosol = atmosphere.rayleigh_scattering, atmosphere.mie_scattering
    aloft, fog = atmosphere.aloft_scattering, atmosphere.fog_scattering
    scattering = [molecules, aerosol, fog, aloft, atmosphere.stratosphere_scattering]
    peak_m, half_width_m = atmosphere.stratosphere_peak_m, atmosphere.stratosphere_half_width_m
    extinction = [
        atmosphere.molecule_extinction,
        atmosphere.mie_extinction,
        atmosphere.absorption_extinction,
        atmosphere.fog_extinction,
        atmosphere.aloft_extinction,
        atmosphere.stratosphere_extinction,
    ]
    return Medium(
        atmosphere.ground_radius_m,
        atmosphere.top_altitude_m,
        atmosphere.mie_scale_height_m,
        atmosphere.aloft_scale_height_m if atmosphere.has_aloft else 0.0,
        atmosphere.fog_scale_height_m if atmosphere.foggy else 0.0,
        peak_m + half_width_m * np.array([-1.0, 0.0, 1.0]),
        np.array(extinction),
        np.array(scattering),
        atmosphere.molecule_layers.array(),
        np.array(atmosphere.absorber_altitude_m),
        np.array(atmosphere.absorber_density),
        *_phase_and_turn(atmosphere, "aerosol", polarises),
        *_phase_and_turn(atmosphere, "fog", polarises),
        *_phase_and_turn(atmosphere, "aloft", polarises),
        *_phase_and_turn(atmosphere, "stratosphere", polarises),
        np.array(atmosphere.ground_albedo),
        _importance(np.sum(scattering, axis=0)),
        polarises,
        atmosphere.rayleigh_anisotropy,
    )


def _phase_and_turn(
    atmosphere: Atmosphere, name: str, polarises: bool
) -> tuple[FloatArray, FloatArray]:
    squared = np.linspace(0.0, 1.0, _PHASE_NODES) ** 2
    nu = 1.0 - 2.0 * squared
    phase = particles_phase(atmosphere, name, nu)
    mean = phase.mean(axis=1)
    turn = np.cumsum(0.5 * (mean[:-1] + mean[1:]) * np.diff(squared))
    rows = [phase]
    if polarises:
        table = atmosphere.table_of(name)
        p12, p33 = (0.0, 1.0) if table is None else table.polarisation(nu)
        rows += [p12 * phase, p33 * phase]
    return np.ascontiguousarray(rows), turn / turn[-1]


def _importance(scattering: FloatArray) -> FloatArray:
    strongest = float(scattering.max())
    if strongest == 0.0:
        return np.ones_like(scattering)
    relative = np.maximum(scattering / strongest, LEAST_SCATTERING)
    return np.asarray(relative**IMPORTANCE_POWER)


@compiled
def dim(medium, ray, altitude, y, scale, weight):  # type: ignore[no-untyped-def]
    """Multiply weights (C,) by a scale and by a ray's transmittance as far as y."""
    rayleigh = molecules_to(medium, ray, altitude, y)
    mie = path_to(ray, altitude, y, medium.mie_scale)
    aloft = 0.0
    if medium.aloft_scale > 0.0:
        aloft = path_to(ray, altitude, y, medium.aloft_scale)
    absorbed = 0.0
    if medium.extinction[2].any():
        absorbed = layered_path(ray, y, medium.absorber_altitude, medium.absorber_density)
    fog = 0.0
    if medium.fog_scale > 0.0:
        fog = path_to(ray, altitude, y, medium.fog_scale)
    veil = 0.0
    if medium.extinction[5].any():
        veil = layered_path(ray, y, medium.veil, _TENT)
    extinction = medium.extinction
    for c in range(weight.size):
        depth = extinction[0, c] * rayleigh + extinction[1, c] * mie + extinction[2, c] * absorbed
        depth += extinction[3, c] * fog + extinction[4, c] * aloft + extinction[5, c] * veil
        weight[c] *= scale * math.exp(-depth)


@compiled
def path_to(ray, altitude, y, scale):  # type: ignore[no-untyped-def]
    """Metres of sea-level air of a scale height, from the start of a ray to y."""
    start, end = math.exp(-ray[0] / scale), math.exp(-altitude / scale)
    return exponential_path(ray, start, altitude, y, end, scale)


@compiled
def molecules_to(medium, ray, altitude, y):  # type: ignore[no-untyped-def]
    """The same of the molecules."""
    layers = medium.molecules
    start, end = layers_density(layers, ray[0]), layers_density(layers, altitude)
    return exponential_layers_path(ray, start, altitude, y, end, layers)


@compiled
def y_at_top(medium, ray):  # type: ignore[no-untyped-def]
    """Coordinate y at which a ray leaves the atmosphere."""
    return max(math.sqrt(max(medium.top - ray[3], 0.0)), ray[4])


@compiled
def meets_ground(ray):  # type: ignore[no-untyped-def]
    """Whether a ray ends on the ground."""
    return ray[4] < 0.0 and ray[3] <= 0.0


@compiled
def densities(medium, altitude):  # type: ignore[no-untyped-def]
    """Relative densities of molecules, aerosol, fog, aerosol aloft and of the stratosphere."""
    fog = math.exp(-altitude / medium.fog_scale) if medium.fog_scale > 0.0 else 0.0
    thin = layers_density(medium.molecules, altitude)
    haze = math.exp(-altitude / medium.mie_scale)
    aloft = math.exp(-altitude / medium.aloft_scale) if medium.aloft_scale > 0.0 else 0.0
    low, peak = medium.veil[0], medium.veil[1]
    veil = max(1.0 - abs(altitude - peak) / (peak - low), 0.0)
    return thin, haze, fog, aloft, veil


@compiled
def absorber_at(medium, altitude):  # type: ignore[no-untyped-def]
    """The absorber's relative density."""
    nodes, density = medium.absorber_altitude, medium.absorber_density
    for k in range(nodes.size - 1):
        if nodes[k] <= altitude < nodes[k + 1]:
            part = (altitude - nodes[k]) / (nodes[k + 1] - nodes[k])
            return density[k] + part * (density[k + 1] - density[k])
    return 0.0


@compiled
def distance_to(ray, y):  # type: ignore[no-untyped-def]
    """Metres from a ray's start."""
    return y * math.sqrt(y * y + 2.0 * ray[2]) - ray[5]


@compiled
def dot(a, b):  # type: ignore[no-untyped-def]
    """Scalar product of arrays or tuples."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def cosine_at(point, direction, radius):  # type: ignore[no-untyped-def]
    """Cosine of a direction's zenith angle at a point of that radius, in [-1, 1]."""
    return min(max(dot(point, direction) / radius, -1.0), 1.0)

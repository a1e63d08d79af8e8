"""Simple clouds for tests: a slab whose light can be computed analytically."""

import numpy as np

from vrut_lite.array import Array
from vrut_lite.daylight.cloud_density import density, distance_up_m
from vrut_lite.daylight.clouds import CloudLayer, CloudsChanged
from vrut_lite.daylight.sun_aloft import sun_aloft

# Scattering of molecules at 635, 550 and 465 nm (Bucholtz 1995), with a scale height of 8 km.
MOLECULES_PER_M = (6.6e-6, 1.19e-5, 2.36e-5)
# As cloud_light.glsl has them.
OCTAVES = ((2.0, 1.0), (0.8, 0.03), (0.28, 0.0066))


def slab(**changes):
    """A layer of density 1 everywhere, except for the fades at its base and its top."""
    known = {
        "base_m": 1000.0,
        "thickness_m": 1000.0,
        "extinction_per_m": 1e-3,
        "coverage": 1.0,
        "threshold": -1.0,
        "column_density": 0.985,
        "drift_m": (0.0, 0.0),
        "phase": (0.85, -0.3, 0.9),
        "weather": Array(np.full((8, 8), 65535, np.uint16)),
        "shape": Array(np.full((8, 8, 8), 255, np.uint8)),
        "detail": Array(np.zeros((8, 8, 8), np.uint8)),
    }
    return CloudLayer(**(known | changes))


def rough_layer(**changes):
    """A broken layer with small noise arrays."""
    random = np.random.default_rng(4)
    return slab(
        threshold=0.35,
        coverage=0.5,
        column_density=0.4,
        extinction_per_m=0.03,
        weather=Array(random.integers(0, 65536, (64, 64)).astype(np.uint16)),
        shape=Array(random.integers(0, 256, (16, 16, 16)).astype(np.uint8)),
        detail=Array(random.integers(0, 256, (8, 8, 8)).astype(np.uint8)),
        **changes,
    )


def clouds_of(layer):
    """The message of one layer, or of none."""
    return CloudsChanged(layers=() if layer is None else (layer,), source="test")


def henyey_greenstein(nu, g):
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * nu) ** 1.5)


def slab_radiance(layer, eye_m, view, sun):
    """Radiance, transmittance and mean distance of the slab from below, in fine steps.

    The source's terms are those of the shader; single scattering, the first, is exact.
    """
    near = distance_up_m(eye_m[1], layer.base_m, view[1])
    far = distance_up_m(eye_m[1], layer.base_m + layer.thickness_m, view[1])
    steps = 4000
    t = near + (np.arange(steps) + 0.5) / steps * (far - near)
    points = np.array(eye_m) + t[:, None] * view
    extinction = layer.extinction_per_m * density(layer, points, eye_m)
    depth = (np.cumsum(extinction) - 0.5 * extinction) * (far - near) / steps
    height = points[:, 1] - layer.base_m
    to_sun = layer.extinction_per_m * (layer.thickness_m - height) / sun[1]
    g1, g2, share = layer.phase
    nu = float(np.dot(view, sun))
    phase = share * henyey_greenstein(nu, g1) + (1 - share) * henyey_greenstein(nu, g2)
    scattered = phase * np.exp(-to_sun)
    for weight, slower in OCTAVES:
        scattered += weight * np.exp(-slower * to_sun) / (4 * np.pi)
    suns = sun_aloft(layer.base_m + height, sun[1])
    weight = extinction * np.exp(-depth) * (far - near) / steps
    radiance = (suns * (scattered * weight)[:, None]).sum(axis=0)
    return radiance, np.exp(-depth[-1]), (t * weight).sum() / weight.sum()


def slab_irradiance(layer, sun, nodes=8):
    """Irradiance of level ground by the slab's own light behind molecules, without theirs.

    Gauss in mu^2, even in azimuth; the sun (z = 0) sees both halves alike.
    """
    x, w = np.polynomial.legendre.leggauss(nodes)
    mu = np.sqrt(0.5 * (x + 1.0))
    azimuths = (np.arange(8) + 0.5) / 8 * np.pi
    total = np.zeros(3)
    for cosine, weight in zip(mu, w, strict=True):
        level = np.sqrt(1.0 - cosine**2)
        for azimuth in azimuths:
            view = np.array([level * np.cos(azimuth), cosine, level * np.sin(azimuth)])
            radiance, _, metres = slab_radiance(layer, (0.0, 0.0, 0.0), view, sun)
            air_m = 8000.0 * (1.0 - np.exp(-metres * cosine / 8000.0)) / cosine
            total += weight * radiance * np.exp(-air_m * np.array(MOLECULES_PER_M))
    return total * 0.5 * np.pi / len(azimuths)

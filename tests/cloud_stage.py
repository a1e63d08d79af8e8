"""Simple clouds for tests: a slab whose light can be computed analytically."""

import numpy as np
from clouds.model.cloud_density import density, distance_up_m
from clouds.model.cloud_transport import transport_tables
from discrete_ordinates import ordinates_of

from vrut_lite.array import Array
from vrut_lite.atmosphere.sunlight import sunlight_at_altitude
from vrut_lite.installed_parts import all_parts, heard_with
from vrut_lite.messages.clouds import CloudLayer, CloudsChanged

# Scattering of molecules at 635, 550 and 465 nm (Bucholtz 1995), with a scale height of 8 km.
MOLECULES_PER_M = (6.6e-6, 1.19e-5, 2.36e-5)


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


def slab_radiance(layer, eye_m, view, sun):
    """Radiance, transmittance and mean distance of the slab from below.

    Radiance is that of discrete ordinates, the others are integrals along the ray.
    """
    near = distance_up_m(eye_m[1], layer.base_m, view[1])
    far = distance_up_m(eye_m[1], layer.base_m + layer.thickness_m, view[1])
    steps = 4000
    t = near + (np.arange(steps) + 0.5) / steps * (far - near)
    points = np.array(eye_m) + t[:, None] * view
    extinction = layer.extinction_per_m * density(layer, points, eye_m)
    depth = (np.cumsum(extinction) - 0.5 * extinction) * (far - near) / steps
    weight = extinction * np.exp(-(1.0 - transport_tables().forward_share) * depth)
    ordinates = slab_ordinates(layer, sun)
    azimuth = np.arctan2(view[2], view[0]) - np.arctan2(sun[2], sun[0])
    suns = sunlight_at_altitude(layer.base_m + 0.5 * layer.thickness_m, sun[1])
    radiance = suns * ordinates.below(view[1], azimuth)
    return radiance, np.exp(-depth[-1]), (t * weight).sum() / weight.sum()


def slab_ordinates(layer, sun):
    """The slab's light by discrete ordinates."""
    depth = layer.extinction_per_m * layer.thickness_m * layer.column_density
    return ordinates_of(depth, float(sun[1]))


def slab_irradiance(layer, sun):
    """Irradiance of level ground by the slab's own light behind molecules, without theirs.

    Most of it comes from around the sun, and so through as much air.
    """
    suns = sunlight_at_altitude(layer.base_m + 0.5 * layer.thickness_m, sun[1])
    air_m = 8000.0 * (1.0 - np.exp(-(layer.base_m + 300.0) / 8000.0)) / sun[1]
    diffuse = slab_ordinates(layer, sun).diffuse * sun[1]
    return diffuse * suns * np.exp(-air_m * np.array(MOLECULES_PER_M))


def clouded(*layers):
    """The part of a `SceneState` that shows these layers."""
    return {"parts": heard_with(all_parts(), CloudsChanged(layers=layers, source="test"))}

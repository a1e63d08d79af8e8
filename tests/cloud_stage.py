"""Simple clouds for tests: a slab whose light can be computed analytically."""

import numpy as np

from vrut_lite.array import Array
from vrut_lite.daylight.clouds import CloudLayer, CloudsChanged


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
    """The message."""
    return CloudsChanged(layer=layer, source="test")

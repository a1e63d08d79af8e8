"""Bruneton's own tables at small sizes, and the twin's run with the same numbers."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.published.pipeline.pipeline import run_pipeline
from bruneton_sky.tables.sizes import TableSizes
from bruneton_sky.tables.tables import Tables
from numpy.typing import NDArray

SIZES = TableSizes(
    transmittance_altitude=16, transmittance_mu=64, irradiance_altitude=8, irradiance_mu_s=16,
    altitude=8, mu=32, nu=4, mu_s=8,
)  # fmt: skip
GROUND_RADIUS_M = 6_360_000.0
# Name of a step in our run, its order, and Bruneton's name of it.
STEPS = [
    ("transmittance", 0, "transmittance"),
    ("delta_irradiance", 1, "delta_irradiance_direct"),
    ("single_rayleigh", 1, "single_rayleigh"),
    ("single_mie", 1, "single_mie"),
    *(
        (name, order, f"{name}_order{order}")
        for order in (2, 3, 4)
        for name in ("scattering_density", "delta_irradiance", "delta_multiple_scattering")
    ),
]


@lru_cache(maxsize=1)
def reference() -> dict[str, NDArray[np.float64]]:
    """All arrays of bruneton_reference_small.npz (Bruneton 2017 on the CPU, float64)."""
    with np.load(Path(__file__).parents[1] / "data" / "bruneton_reference_small.npz") as arrays:
        return dict(arrays)


def reference_atmosphere() -> Atmosphere:
    """The atmosphere of those arrays, to their last digits."""
    data = reference()
    return replace(
        Atmosphere.earth(),
        rayleigh_scattering=tuple(data["rayleigh_scattering"]),
        absorption_extinction=tuple(data["absorption_extinction"]),
    )


def reference_tables() -> Tables:
    """The reference's arrays as our tables."""
    names = ("transmittance", "irradiance", "scattering", "single_mie")
    return Tables(
        atmosphere=reference_atmosphere(),
        sizes=SIZES,
        orders=4,
        parametrisation="2017",
        **{name: reference()[name] for name in names},
    )


@lru_cache(maxsize=1)
def twin_run() -> tuple[Tables, dict[tuple[str, int], NDArray[np.float64]]]:
    """The twin's tables with the reference's numbers, and every step's array."""
    steps = {}

    def keep(name: str, order: int, array: NDArray[np.float64]) -> None:
        steps[name, order] = array.copy()

    return run_pipeline(reference_atmosphere(), SIZES, 4, observe=keep), steps

"""Aerosol of the stratosphere: droplets of sulphuric acid in a tent about 20 km.

The background's optical depth of 0.005 is OPAC's (Hess, Koepke and Schult 1998, table 5); what a
layer has beyond it are the larger droplets that follow an eruption. The tent has mean and variance
of a Gaussian layer of 2.45 km, as lidars see it about its peak (Thomason and Vernier 2013).
"""

from functools import lru_cache
from pathlib import Path

import numpy as np

from vrut_lite.atmosphere.aerosols.components import Particles
from vrut_lite.atmosphere.aerosols.optics import AerosolLayer, layer_of

BACKGROUND_DEPTH_550 = 0.005
PEAK_M, HALF_WIDTH_M = 20_000.0, 6000.0
# Made by vrut_lite_lab.stratosphere.
_FILE = Path(__file__).parents[1] / "data" / "stratosphere.npz"


@lru_cache(maxsize=4)
def stratosphere(optical_depth_550: float, peak_m: float = PEAK_M) -> AerosolLayer:
    """The layer with a vertical optical depth at 550 nm and its peak at an altitude in m."""
    background, volcanic = _modes()
    usual = min(optical_depth_550, BACKGROUND_DEPTH_550)
    column = background.times(usual).with_others(volcanic.times(optical_depth_550 - usual))
    return layer_of(column, HALF_WIDTH_M, peak_m)


@lru_cache(maxsize=1)
def _modes() -> tuple[Particles, ...]:
    """Columns of depth 1 at 550 nm, of the background and of an eruption."""
    with np.load(_FILE) as data:
        wavelength_nm, angle_rad = data["wavelength_nm"], data["angle_rad"]
        names = "optical_depth", "optical_depth", "phase_per_sr", "p12_per_sr", "p33_per_sr"
        tables = [data[name].astype(float) for name in names]
    return tuple(Particles(wavelength_nm, angle_rad, *mode) for mode in zip(*tables, strict=True))

"""Fog's droplets: water spheres by Mie's theory, of Deirmendjian's distribution C1.

Two fifths of their light are diffracted within 4 degrees. Multiple scattering is represented by
harmonics to degree 16, which cannot resolve such a peak; and with the peak counted as unscattered
light, fog would hide less than its visibility states. So the peak is spread over 24 degrees. The
values beyond, with the fogbow at 140 degrees, are Mie's; the mean cosine changes by 0.01.
"""

from functools import lru_cache
from pathlib import Path

import numpy as np

from vrut_lite.atmosphere.aerosols.phase_table import PhaseTable, node_cosines
from vrut_lite.numeric_types import FloatArray

# Made by vrut_lite_lab.fog_droplets.
FILE = Path(__file__).parents[1] / "data" / "fog_droplets.npz"
_SPREAD_RAD = np.radians(24.0)


@lru_cache(maxsize=8)
def droplets_phase(wavelength_nm: tuple[float, ...]) -> PhaseTable:
    """The phase function at wavelengths, linear between the tabulated five."""
    with np.load(FILE) as data:
        known, angle = data["wavelength_nm"], data["angle_rad"]
        p11, p12, p33 = (data[f"{name}_per_sr"].astype(float) for name in ("phase", "p12", "p33"))
    whole = PhaseTable.of_angles(angle, p11, [p12 / p11, p33 / p11])
    place = np.interp(wavelength_nm, known, np.arange(known.size))
    mixed = whole.at_rows(np.maximum(1.0 - np.abs(place[:, None] - np.arange(known.size)), 0.0))
    return PhaseTable([_spread_peak(row) for row in mixed.values], mixed.ratios)


def _spread_peak(row: FloatArray) -> FloatArray:
    """A row of a table whose light within `_SPREAD_RAD` falls evenly to that at its edge."""
    nu = node_cosines()
    inside = nu > np.cos(_SPREAD_RAD)
    edge = row[np.count_nonzero(inside)]
    bump = 0.5 * (1.0 + np.cos(np.pi * np.arccos(nu[inside]) / _SPREAD_RAD))
    # Nodes are uniform in sin(theta / 2): each stands for a solid angle in proportion to it.
    weight = np.sqrt(0.5 - 0.5 * nu[inside])
    height = weight @ (row[inside] - edge) / (weight @ bump)
    return np.concatenate([edge + height * bump, row[~inside]])

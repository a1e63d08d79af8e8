"""Make vrut_lite/atmosphere/data/stratosphere.npz: the stratosphere's droplets by Mie's theory.

    MIEPYTHON_USE_JIT=1 python -m vrut_lite_lab.stratosphere

Droplets of 75 % sulphuric acid do not absorb visible light and have the refractive index 1.43
(Palmer and Williams 1975, at 550 nm). Lognormal sizes: the background's have a mode radius of
0.07 um and sigma 1.86 (Jaenicke 1993, effective radius 0.18 um), those after an eruption an
effective radius of 0.4 um and sigma 1.5, between the 0.3 and 0.5 um of Pinatubo's first two years
(Russell et al. 1996). Takes a minute on one core.
"""

from typing import Any

import numpy as np

from vrut_lite.atmosphere.aerosols.mie import spheres_together
from vrut_lite_lab.checkout import ROOT

TARGET = ROOT / "vrut_lite" / "atmosphere" / "data" / "stratosphere.npz"
WAVELENGTH_NM = np.array([360.0, 400, 445, 500, 520, 550, 570, 600, 635, 700, 800])
_INDEX = 1.43
# Mode radius in um and sigma, of the background and after an eruption.
MODES = ((0.07, 1.86), (0.265, 1.5))
_REACH, _RADII = 5.0, 400


def main() -> None:
    """Compute and write both modes."""
    found = []
    for radius_um, sigma in MODES:
        deviations = np.linspace(-_REACH, _REACH, _RADII)
        spheres = np.exp(-0.5 * deviations**2)
        radii_um = radius_um * sigma**deviations
        index = np.full(WAVELENGTH_NM.size, _INDEX)
        one = spheres_together(radii_um, spheres, WAVELENGTH_NM, index)
        found.append(one.times(1.0 / float(np.interp(550.0, WAVELENGTH_NM, one.extinction))))
    tables = {
        "optical_depth": [each.extinction for each in found],
        "phase_per_sr": [each.phase for each in found],
        "p12_per_sr": [each.p12 for each in found],
        "p33_per_sr": [each.p33 for each in found],
    }
    values: dict[str, Any] = {name: np.array(table, np.float32) for name, table in tables.items()}
    np.savez_compressed(TARGET, wavelength_nm=WAVELENGTH_NM, angle_rad=found[0].angle_rad, **values)


if __name__ == "__main__":
    main()

"""Write the colour data that vrut_lite carries: CIE 1931 2-degree observer and the sun's spectrum.

Run once, with the extra `test` installed: python lab/vrut_lite_lab/extract_colour_data.py
Sources: CIE 1931 2-degree colour-matching functions (CIE 018:2019, through colour-science),
extraterrestrial irradiance of ASTM G-173-03 (through pvlib), averaged over 5 nm bins.
"""

import colour
import numpy as np
import pvlib

from vrut_lite_lab.checkout import ROOT

TARGET = ROOT / "vrut_lite" / "geometry" / "data" / "cie1931_astm_g173.csv"
WAVELENGTH_NM = np.arange(360, 831, 5)


def main() -> None:
    """Tabulate both at 5 nm and write one CSV."""
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    cmf = np.array([observer[float(w)] for w in WAVELENGTH_NM])
    spectrum = pvlib.spectrum.get_reference_spectra(standard="ASTM G173-03").extraterrestrial
    fine_nm = np.arange(350.0, 841.0, 0.5)
    fine = np.interp(fine_nm, spectrum.index.to_numpy(), spectrum.to_numpy())
    sun = [fine[np.abs(fine_nm - w) <= 2.5].mean() for w in WAVELENGTH_NM]
    header = (
        "CIE 1931 2-degree observer (CIE 018:2019); ASTM G-173-03 extraterrestrial, 5 nm means\n"
        "wavelength_nm, x_bar, y_bar, z_bar, solar_irradiance_W_m-2_nm-1"
    )
    table = np.column_stack([WAVELENGTH_NM, cmf, sun])
    np.savetxt(TARGET, table, fmt="%.9g", delimiter=",", header=header)


if __name__ == "__main__":
    main()

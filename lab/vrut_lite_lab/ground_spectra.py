"""Make vrut_lite/atmosphere/data/ground_reflectance.csv: reflectance of grounds by published data.

    pip download --no-deps earthlib==1.1.0 && unzip earthlib-1.1.0-py3-none-any.whl -d FOLDER
    python -m vrut_lite_lab.ground_spectra FOLDER/earthlib/data

`vrut_lite/atmosphere/data/NOTICE.ground_reflectance` names the sources.
"""

import csv
import sys
from pathlib import Path

import numpy as np

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.checkout import ROOT

TARGET = ROOT / "vrut_lite" / "atmosphere" / "data" / "ground_reflectance.csv"
WAVELENGTH_NM = np.arange(360.0, 831.0, 10.0)
# Classes of earthlib (LEVEL_3) whose median is a ground.
PAVED = ("road", "parking_lot", "sidewalk", "driveway", "bridge")
CLASSES = {"soil": ("soil",), "sand": ("sand",), "paving": PAVED}
# Absorption index of ice, each 10 nm from 400 (Warren and Brandt 2008, table IOP_2008).
ICE = (
    2.365e-11, 2.669e-11, 3.135e-11, 4.140e-11, 6.268e-11, 9.239e-11, 1.325e-10, 1.956e-10,
    2.861e-10, 4.172e-10, 5.889e-10, 8.036e-10, 1.076e-9, 1.409e-9, 1.813e-9, 2.289e-9, 2.839e-9,
    3.461e-9, 4.159e-9, 4.930e-9, 5.730e-9, 6.890e-9, 8.580e-9, 1.040e-8, 1.220e-8, 1.430e-8,
    1.660e-8, 1.890e-8, 2.090e-8, 2.400e-8, 2.900e-8, 3.440e-8, 4.030e-8, 4.300e-8, 4.920e-8,
    5.870e-8, 7.080e-8, 8.580e-8, 1.020e-7, 1.180e-7, 1.340e-7, 1.400e-7, 1.430e-7, 1.450e-7,
)  # fmt: skip
ICE_DENSITY_KG_M3 = 917.0
# Specific surface of snow a day old, m^2/kg, and shape parameters B and g of its grains (Libois et
# al. 2013, "Influence of grain shape on light penetration in snow", equation 6).
SNOW_SURFACE_M2_KG, SNOW_B, SNOW_G = 30.0, 1.6, 0.85
# Absorption of pure water (1/m), each 10 nm from 400 (Pope and Fry 1997); the last beyond 700 nm.
WATER = (
    0.00663, 0.00473, 0.00454, 0.00495, 0.00635, 0.00922, 0.00979, 0.0106, 0.0127, 0.0150, 0.0204,
    0.0325, 0.0409, 0.0434, 0.0474, 0.0565, 0.0619, 0.0695, 0.0896, 0.1351, 0.2224, 0.2644, 0.2755,
    0.2916, 0.3108, 0.340, 0.410, 0.439, 0.465, 0.516, 0.624,
)  # fmt: skip
# Chlorophyll of the open sea, mg/m^3.
CHLOROPHYLL = 0.3
# Reflectance of a wind-ruffled surface by half of a clear day's light: sun 40 degrees high and sky
# (Jin et al. 2004, figure 2), and the part of upward light that leaves the water.
SEA_SURFACE, LEAVES_WATER = 0.047, 0.49


def main(folder: Path) -> None:
    """Compute and write the table."""
    columns = {"grass": _grass()}
    columns |= {name: _median(folder, classes) for name, classes in CLASSES.items()}
    columns |= {"snow": _snow(), "water": _water()}
    rows = np.column_stack([WAVELENGTH_NM, *columns.values()])
    header = "wavelength_nm," + ",".join(columns)
    np.savetxt(TARGET, rows, fmt=["%g"] + ["%.4f"] * len(columns), delimiter=",", header=header)


def _grass() -> FloatArray:
    nm, albedo = np.loadtxt(
        ROOT / "lab/vrut_lite_lab/study/framework/data/albedo_grass.csv", delimiter=","
    ).T
    return np.interp(WAVELENGTH_NM, nm, albedo)


def _median(folder: Path, classes: tuple[str, ...]) -> FloatArray:
    """Median reflectance of the measured spectra of some classes; below 400 nm that at 400 nm."""
    with (folder / "spectra.csv").open() as lines:
        kept = [row["LEVEL_3"] in classes for row in csv.DictReader(lines)]
    spectra = np.fromfile(folder / "spectra.sli", "<f4").reshape(len(kept), -1)[kept]
    nm = 400.0 + 10.0 * np.arange(60)
    return np.interp(WAVELENGTH_NM, nm, np.median(spectra[:, :60], axis=0))


def _snow() -> FloatArray:
    """Diffuse albedo of deep clean snow (Libois et al. 2013, equation 6)."""
    nm = 400.0 + 10.0 * np.arange(len(ICE))
    absorption = 4.0 * np.pi * np.interp(WAVELENGTH_NM, nm, ICE) / (1e-9 * WAVELENGTH_NM)
    grains = 3.0 * ICE_DENSITY_KG_M3 * SNOW_SURFACE_M2_KG * (1.0 - SNOW_G)
    return np.exp(-4.0 * np.sqrt(2.0 * SNOW_B * absorption / grains))


def _water() -> FloatArray:
    """Albedo of the open sea: its surface, and light from below (Morel and Prieur 1977)."""
    nm = WAVELENGTH_NM
    absorbed = np.interp(nm, 400.0 + 10.0 * np.arange(len(WATER)), WATER)
    # Plants and dissolved matter (Morel 1991), particles and water (Morel 1988).
    absorbed = absorbed + 0.06 * CHLOROPHYLL**0.65 * np.exp(-0.014 * (nm - 440.0))
    particles = 0.30 * CHLOROPHYLL**0.62
    share = 0.002 + 0.02 * (0.5 - 0.25 * np.log10(CHLOROPHYLL)) * 550.0 / nm
    scattered_back = 0.5 * 0.00288 * (nm / 500.0) ** -4.32 + share * particles
    return SEA_SURFACE + LEAVES_WATER * 0.33 * scattered_back / absorbed


if __name__ == "__main__":
    main(Path(sys.argv[1]))

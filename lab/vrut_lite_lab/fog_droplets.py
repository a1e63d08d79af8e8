"""Make vrut_lite/atmosphere/data/fog_droplets.npz: the phase function of fog's droplets by Mie.

    python -m vrut_lite_lab.fog_droplets

Deirmendjian's cloud C1 (1969, "Electromagnetic Scattering on Spherical Polydispersions"):
n(r) ~ r^6 exp(-1.5 r), r in micrometres, effective radius 6; water's refractive index by Hale and
Querry 1973.
"""

import numpy as np

from vrut_lite.atmosphere.aerosols.mie import spheres_together
from vrut_lite_lab.checkout import ROOT

TARGET = ROOT / "vrut_lite" / "atmosphere" / "data" / "fog_droplets.npz"
WAVELENGTH_NM = np.array([400.0, 475.0, 550.0, 625.0, 700.0])
WATER = np.array([1.339, 1.336, 1.333, 1.332, 1.331])


def main() -> None:
    """Compute and write the table."""
    radius_um = np.geomspace(0.5, 25.0, 400)
    # Spheres of a step of ln r.
    spheres = radius_um**7 * np.exp(-1.5 * radius_um)
    water = spheres_together(radius_um, spheres, WAVELENGTH_NM, WATER)
    np.savez_compressed(
        TARGET,
        wavelength_nm=WAVELENGTH_NM,
        angle_rad=water.angle_rad,
        phase_per_sr=water.phase.astype(np.float32),
        p12_per_sr=water.p12.astype(np.float32),
        p33_per_sr=water.p33.astype(np.float32),
    )


if __name__ == "__main__":
    main()

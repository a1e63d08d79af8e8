"""Make tests/data/twilight_truth.npz: twilight by another method than the table's.

Run from the repository's root: python -m vrut_lite_lab.twilight_fit.make_truth
Some ten minutes on one core. The first order is exact, the others are the backward path
tracer's, with standard errors: no grid, no harmonics, no bins. Suns and directions are none of
the table's.
"""

import time

import numpy as np
from bruneton_sky import single_scattering

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.monte_carlo import monte_carlo_stokes
from vrut_lite_lab.twilight_fit.air import WAVELENGTH_NM, air
from vrut_lite_lab.twilight_fit.solve_skies import SINGLE_SAMPLES, cosine_to_sun

TRUTH = ROOT / "tests" / "data" / "twilight_truth.npz"
TURBIDITIES = (2.0, 3.0, 6.0)
# Paths a direction: more where fewer of them find the sun.
PATHS = {
    0.25: 2**15, -0.75: 2**15, -1.75: 2**16, -2.75: 2**16, -3.75: 2**17, -4.75: 2**17,
    -5.75: 2**18, -7.25: 2**18, -9.25: 2**19,
}  # fmt: skip
DIRECTIONS = 4
NOTES = """Sky radiance at the ground in twilight, W m^-2 sr^-1 nm^-1, and its standard error:
exact first order plus backward vector Monte Carlo (vrut_lite_lab.monte_carlo) of all others.
Spherical, top 120 km, no refraction; molecules, aerosol and ozone as in twilight_fit/air.py; made
by vrut_lite_lab.twilight_fit.make_truth. turbidity_sun_view_azimuth: rows of turbidity, the sun's
elevation, the view's elevation and its azimuth from the sun (deg); wavelength_nm; radiance,
error (row, wavelength)."""


def directions(seed: int) -> tuple[FloatArray, FloatArray]:
    """View elevations and azimuths (DIRECTIONS,) in degrees, even in the table's v and azimuth."""
    random = np.random.default_rng((2026, seed))
    elevation = np.degrees(np.arcsin(random.uniform(0.1, 0.98, DIRECTIONS) ** 2))
    return elevation, random.uniform(0.0, 180.0, DIRECTIONS)


def trace(turbidity: float, sun_deg: float, seed: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rows (n, 4), radiance and standard error (n, C) of one sun."""
    atmosphere, (view_deg, azimuth_deg) = air(turbidity), directions(seed)
    mu, mu_s = np.sin(np.radians(view_deg)), np.sin(np.radians(sun_deg))
    nu = cosine_to_sun(mu, sun_deg, np.radians(azimuth_deg))
    first = single_scattering(atmosphere, 0.0, mu, mu_s, nu, samples=SINGLE_SAMPLES)
    light, _, _ = monte_carlo_stokes(
        atmosphere, 0.0, mu, mu_s, nu, paths=PATHS[sun_deg], seed=seed, max_order=3
    )
    sun = np.full_like(view_deg, sun_deg)
    rows = np.stack([np.full_like(sun, turbidity), sun, view_deg, azimuth_deg], axis=-1)
    return rows, first + light.total(2), light.total_error(2)


def main() -> None:
    """Write the file."""
    suns = [(turbidity, sun) for turbidity in TURBIDITIES for sun in PATHS]
    parts = []
    for seed, (turbidity, sun) in enumerate(suns):
        parts.append(trace(turbidity, sun, seed))
        print(f"turbidity {turbidity:g}, sun {sun}: {time.process_time():.0f} CPU s", flush=True)
    rows, radiance, error = (np.concatenate(part) for part in zip(*parts, strict=True))
    np.savez_compressed(
        TRUTH,
        turbidity_sun_view_azimuth=rows,
        wavelength_nm=WAVELENGTH_NM,
        radiance=radiance.astype(np.float32),
        error=error.astype(np.float32),
        notes=np.array(NOTES),
    )
    print(f"{TRUTH.name}: {TRUTH.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()

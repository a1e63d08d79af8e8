"""Trace the light scattered twice and more, for the fit and for the truth it is held against.

Run from the repository's root: python -m tools.twilight_fit.trace_tables
Some twenty minutes on one core. Writes out/twilight/multiple.npz, which `fit.py` reads, and
tests/data/twilight_truth.npz, whose directions, suns and one of whose turbidities the fit never
sees.
"""

import time
from pathlib import Path

import numpy as np
from bruneton_sky import single_scattering
from numpy.typing import NDArray

from tools.twilight_fit.air import TOP_M, WAVELENGTH_NM, air
from tools.twilight_fit.monte_carlo import ORDERS, scattered_radiance
from vrut_lite.geometry.colour import solar_irradiance

FloatArray = NDArray[np.float64]
ROOT = Path(__file__).parents[2]
MULTIPLE = ROOT / "out" / "twilight" / "multiple.npz"
TRUTH = ROOT / "tests" / "data" / "twilight_truth.npz"
# In this order: the seeds count on.
TURBIDITIES = (2.0, 6.0, 4.0)
SUN_DEG = np.array([2, 1, 0, -1, -2, -3, -4, -5, -6, -7, -8, -10, -12, -15], dtype=float)
# The view's elevation has the coordinate v = sqrt(sin): dense at the horizon.
VIEW_V = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 1.0])
AZIMUTH_DEG = np.arange(0.0, 181.0, 30.0)
TRUTH_TURBIDITIES = (2.0, 4.0, 6.0, 3.0)
TRUTH_SUN_DEG = (0.5, -0.5, -1.5, -2.5, -3.5, -4.5, -5.5, -7.5, -9.0)
TRUTH_DIRECTIONS = 6
TRUTH_PATHS = 4


def paths_for(sun_deg: float) -> int:
    """More paths where fewer of them find the sun."""
    return 8_000 if sun_deg > -3.5 else 25_000 if sun_deg > -9.0 else 50_000


def trace_multiple() -> None:
    """Write means and standard errors [turbidity, sun, v, azimuth, wavelength] of orders 2 to 8."""
    shape = (len(TURBIDITIES), SUN_DEG.size, VIEW_V.size, AZIMUTH_DEG.size, WAVELENGTH_NM.size)
    mean, error = np.empty(shape), np.empty(shape)
    started = time.monotonic()
    for index in np.ndindex(*shape[:4]):
        t, s, v, a = index
        sun_deg = float(SUN_DEG[s])
        if VIEW_V[v] == 1.0 and a > 0:
            mean[index], error[index] = mean[t, s, v, 0], error[t, s, v, 0]
            continue
        orders, error[index] = scattered_radiance(
            air(TURBIDITIES[t]),
            float(VIEW_V[v] ** 2),
            float(np.radians(AZIMUTH_DEG[a])),
            float(np.sin(np.radians(sun_deg))),
            paths_for(sun_deg),
            seed=int(np.ravel_multi_index(index, shape[:4])),
        )
        mean[index] = orders[1:].sum(axis=0)
        if v == 0 and a == 0:
            print(f"{index[:2]} of {shape[:2]}, {time.monotonic() - started:.0f} s", flush=True)
    MULTIPLE.parent.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(MULTIPLE, mean=mean, error=error)


def trace_truth() -> None:
    """Write radiance and its standard error at random directions, all orders, in W per nm."""
    random = np.random.default_rng(2026)
    rows = []
    for turbidity in TRUTH_TURBIDITIES:
        for sun_deg in TRUTH_SUN_DEG:
            for _ in range(TRUTH_DIRECTIONS):
                # Even in v: a share of the directions stands near the horizon.
                elevation = np.degrees(np.arcsin(random.uniform(0.1, 0.98) ** 2))
                rows.append((turbidity, sun_deg, elevation, random.uniform(0.0, 180.0)))
    radiance, error = zip(*(_truth(i, *row) for i, row in enumerate(rows)), strict=True)
    np.savez_compressed(
        TRUTH,
        turbidity_sun_view_azimuth=np.array(rows),
        wavelength_nm=WAVELENGTH_NM,
        radiance=np.array(radiance).astype(np.float32),
        error=np.array(error).astype(np.float32),
        notes=np.array(
            "Sky radiance at the ground in twilight, W m^-2 sr^-1 nm^-1, and its standard error: "
            "exact first order plus backward Monte Carlo of orders 2 to "
            f"{ORDERS}. Spherical, top {TOP_M / 1000:.0f} km, no refraction; Rayleigh, aerosol "
            "and ozone as in tools/twilight_fit/air.py; made by tools/twilight_fit/"
            "trace_tables.py. Columns: turbidity, sun's elevation, view's elevation, azimuth "
            "from the sun (deg)."
        ),
    )


def _truth(
    seed: int, turbidity: float, sun_deg: float, view_deg: float, azimuth_deg: float
) -> tuple[FloatArray, FloatArray]:
    mu, mu_s = np.sin(np.radians([view_deg, sun_deg]))
    azimuth = float(np.radians(azimuth_deg))
    nu = mu * mu_s + np.sqrt((1 - mu**2) * (1 - mu_s**2)) * np.cos(azimuth)
    atmosphere = air(turbidity)
    first = single_scattering(atmosphere, 0.0, mu, mu_s, nu, samples=48)
    orders, error = scattered_radiance(
        atmosphere,
        float(mu),
        azimuth,
        float(mu_s),
        TRUTH_PATHS * paths_for(sun_deg),
        seed=10**6 + seed,
    )
    sun = solar_irradiance(WAVELENGTH_NM)
    return sun * (first + orders[1:].sum(axis=0)), sun * error


if __name__ == "__main__":
    trace_multiple()
    trace_truth()

"""Solve the twilight skies of the table: all orders of scattering, spectrum by spectrum.

Run from the repository's root: python -m vrut_lite_lab.twilight_fit.solve_skies
Some twenty minutes on one core. Writes out/twilight/sky_<turbidity>.npz, which `make_table.py`
reads: on a grid twice as fine as the table's in sun, height and azimuth, so that what the table
loses between its nodes is known.
"""

import time

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import mie_phase, molecules_phase
from bruneton_sky.single_scattering_kernels import fast_scattered_without_phase
from bruneton_sky.solver import SolverSizes, SourceField, multiple_scattering, solve
from dynamic_skylight.twilight_table import sin_elevation_of

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.twilight_fit.air import air

SKIES = ROOT / "out" / "twilight"
TURBIDITIES = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0)
SUN_DEG = np.arange(2.0, -15.1, -0.5)
VIEW_V, VIEW_A = np.linspace(0.0, 1.0, 47), np.linspace(0.0, 1.0, 25)
SINGLE_SAMPLES = 96
ORDERS = 9
# Twilight asks for many suns (the planet's shadow) and many bins (the long slant rays), and for
# fewer directions than `SolverSizes.converged` has. Doubling the suns or the bins changes the
# higher orders by 0.4 % at most, rms, for suns down to -9 deg, and by 1.4 % at -12 deg.
SIZES = SolverSizes(
    altitude=48,
    mu_s=224,
    direction_mu=28,
    direction_azimuth=14,
    later_azimuth=14,
    degree=16,
    source_mu=48,
    source_azimuth=24,
    steps=256,
    node_bins=88,
    multiple_bins=64,
)


def solved(atmosphere: Atmosphere) -> SourceField:
    """The source function at these sizes: nine orders, and the tail of all others."""
    return solve(atmosphere, ORDERS, SIZES, all_orders=True)


def sky_radiance(field: SourceField, sun_deg: float, mu: FloatArray, nu: FloatArray) -> FloatArray:
    """Radiance (n, C) at the ground toward zenith cosines and cosines to the sun (n,).

    W m^-2 sr^-1 nm^-1; the first order exact, the others the solver's.
    """
    mu_s = float(np.sin(np.radians(sun_deg)))
    rayleigh, mie = fast_scattered_without_phase(
        field.atmosphere, 0.0, mu, mu_s, nu, samples=SINGLE_SAMPLES
    )
    cosine = nu[:, None]
    air = field.atmosphere
    first = rayleigh * molecules_phase(air, cosine) + mie * mie_phase(air, cosine)
    return first + multiple_scattering(field, 0.0, mu, mu_s, nu)


def cosine_to_sun(mu: FloatArray, sun_deg: float, azimuth_rad: FloatArray) -> FloatArray:
    """Cosine (...,) of the angle between view and sun: the spherical law of cosines."""
    e = np.radians(sun_deg)
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    return np.asarray(np.clip(mu * np.sin(e) + sine * np.cos(e) * np.cos(azimuth_rad), -1.0, 1.0))


def sky_on_grid(field: SourceField) -> FloatArray:
    """Radiance [sun, v, a, C] on the grid of this file."""
    mu, azimuth = np.meshgrid(sin_elevation_of(VIEW_V), 2.0 * np.arcsin(VIEW_A), indexing="ij")
    rays = mu.ravel()
    skies = [sky_radiance(field, e, rays, cosine_to_sun(rays, e, azimuth.ravel())) for e in SUN_DEG]
    return np.array(skies).reshape(SUN_DEG.size, *mu.shape, -1)


def main() -> None:
    """Solve every turbidity that has no file yet."""
    SKIES.mkdir(parents=True, exist_ok=True)
    for turbidity in TURBIDITIES:
        path = SKIES / f"sky_{turbidity:g}.npz"
        if path.exists():
            continue
        radiance = sky_on_grid(solved(air(turbidity)))
        np.savez(path, radiance=radiance.astype(np.float32))
        print(f"turbidity {turbidity:g}: {time.process_time():.0f} CPU s", flush=True)


if __name__ == "__main__":
    main()

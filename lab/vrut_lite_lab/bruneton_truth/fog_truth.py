"""Make tests/data/fog_truth.npz: light in and above ground fog, to judge the solver by.

Run from the repository's root: python -m vrut_lite_lab.bruneton_truth.fog_truth
Some ten minutes on one core. The first order is exact; the others are the backward path
tracer's, with standard errors. How the arrays are named stands in the file's own `notes`.
"""

from typing import Any

import numpy as np
from bruneton_sky import Atmosphere, earth_spectral, single_scattering

from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.monte_carlo import monte_carlo_irradiance, monte_carlo_radiance

TARGET = ROOT / "tests" / "data" / "fog_truth.npz"
WAVELENGTH_NM, AEROSOL_DEPTH, HEIGHT_M = (600.0, 450.0), 0.1, 100.0
VISIBILITIES_M, SUNS_DEG = (200.0, 1000.0), (60.0, 20.0, 5.0)
ALTITUDES_M, AZIMUTH_DEG = (2.0, 100.0, 800.0), 60.0
MU = (1.0, 0.5, 0.2, 0.02, -0.05, -0.3, -0.9)
# Under a low sun few paths find their way to the top of the fog.
PATHS = {60.0: 32768, 20.0: 65536, 5.0: 65536}
IRRADIANCE_PATHS = 131072
GAUSS_NODES = 64

NOTES = """Spectral radiance W m^-2 sr^-1 nm^-1 at 600 and 450 nm of
earth_spectral(wavelength).with_aerosol(0.1).with_fog(visibility_m, 100).
Rays (n,): visibility_m, sun_elevation_deg, altitude_m, mu, mu_s, nu; the view is 60 degrees of
azimuth from the sun; the radiance of the ground is left out. total, error (n, 2): all orders and
their standard error. multiple: of orders two and up. irradiance_* (visibility, sun, 2): of the
sky on level ground, all orders."""


def air_with_fog(visibility_m: float) -> Atmosphere:
    """The air of the truth."""
    air = earth_spectral(WAVELENGTH_NM).with_aerosol(AEROSOL_DEPTH)
    return air.with_fog(visibility_m, HEIGHT_M)


def main() -> None:
    """Trace all, and write the file."""
    rows: dict[str, list[Any]] = {}
    shape = len(VISIBILITIES_M), len(SUNS_DEG), len(WAVELENGTH_NM)
    light, noise = np.zeros(shape), np.zeros(shape)
    for i, visibility_m in enumerate(VISIBILITIES_M):
        air = air_with_fog(visibility_m)
        for k, elevation in enumerate(SUNS_DEG):
            mu_s = float(np.sin(np.radians(elevation)))
            sky = monte_carlo_irradiance(air, [mu_s], paths=IRRADIANCE_PATHS)
            light[i, k], noise[i, k] = sky.total()[0], sky.total_error()[0]
            for altitude_m in ALTITUDES_M:
                part = _rays(air, altitude_m, mu_s, PATHS[elevation])
                part |= {
                    "visibility_m": np.full(len(MU), visibility_m),
                    "sun_elevation_deg": np.full(len(MU), elevation),
                }
                for name, values in part.items():
                    rows.setdefault(name, []).append(values)
                print(visibility_m, elevation, altitude_m, flush=True)
    arrays: dict[str, Any] = {name: np.concatenate(parts) for name, parts in rows.items()}
    np.savez_compressed(
        TARGET, **arrays, irradiance=light, irradiance_error=noise, notes=np.array(NOTES)
    )


def _rays(air: Atmosphere, altitude_m: float, mu_s: float, paths: int) -> dict[str, Any]:
    """All views from one altitude."""
    mu = np.array(MU)
    sines = np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2))
    nu = mu * mu_s + sines * np.cos(np.radians(AZIMUTH_DEG))
    traced = monte_carlo_radiance(air, altitude_m, mu, mu_s, nu, paths=paths)
    first = single_scattering(air, altitude_m, mu, mu_s, nu, samples=GAUSS_NODES)
    multiple, error = traced.total(2), traced.total_error(2)
    return {
        "altitude_m": np.full(mu.size, altitude_m), "mu": mu, "mu_s": np.full(mu.size, mu_s),
        "nu": nu, "total": first + multiple, "multiple": multiple, "error": error,
    }  # fmt: skip


if __name__ == "__main__":
    main()

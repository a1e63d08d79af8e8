"""Make tests/data/haze_truth.npz: the module's own air in haze, to judge its sky by.

Run from the repository's root: python -m vrut_lite_lab.bruneton_truth.haze_truth
Some eight minutes on one core. The first order is exact; the others are the backward path
tracer's, with standard errors. How the arrays are named stands in the file's own `notes`.
"""

from typing import Any

import numpy as np
from bruneton_sky import single_scattering
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from numpy.typing import NDArray

from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.monte_carlo import monte_carlo_irradiance, monte_carlo_radiance

TARGET = ROOT / "tests" / "data" / "haze_truth.npz"
TURBIDITIES, SUNS_DEG = (3.0, 10.0), (60.0, 10.0, 2.0)
# Views above the horizon by altitude, each toward the sun and away from it.
MU = {0.0: (0.95, 0.5, 0.2, 0.08, 0.03, 0.01), 2000.0: (0.5, 0.05, -0.05, -0.3)}
COSINE_OF_AZIMUTH = (0.9, -0.9)
# In thick haze under a low sun few paths carry most of the light.
PATHS = {(3.0, 60.0): 65536, (10.0, 60.0): 65536, (3.0, 10.0): 131072, (3.0, 2.0): 131072}
MOST_PATHS = 262144
IRRADIANCE_PATHS = 131072
GAUSS_NODES = 64

NOTES = """Spectral radiance W m^-2 sr^-1 nm^-1 at the four wavelengths of the module's skylight,
air of BrunetonSkySettings(turbidity=..., aerosol="one-lobe"): optical depth 0.2, 0.8 at 550 nm.
Rays (n,): turbidity, sun_elevation_deg, altitude_m, mu, mu_s, nu; the radiance of the ground is
left out, its light scattered by the air is in. first, multiple, error (n, 4): order 1, exact, the
sum of orders two and up, and its standard error. irradiance, irradiance_error (turbidity, sun, 4):
of the sky on level ground, all orders, W m^-2 nm^-1."""


def main() -> None:
    """Trace all, and write the file."""
    parts: list[dict[str, NDArray[np.float64]]] = []
    light, noise = np.zeros((2, len(TURBIDITIES), len(SUNS_DEG), 4))
    for i, turbidity in enumerate(TURBIDITIES):
        for k, elevation_deg in enumerate(SUNS_DEG):
            parts += [_rays(turbidity, elevation_deg, altitude_m) for altitude_m in MU]
            air = atmosphere_of(BrunetonSkySettings(turbidity=turbidity, aerosol="one-lobe"))
            mu_s = [np.sin(np.radians(elevation_deg))]
            sky = monte_carlo_irradiance(air, mu_s, paths=IRRADIANCE_PATHS)
            light[i, k], noise[i, k] = sky.total()[0], sky.total_error()[0]
            print(turbidity, elevation_deg, flush=True)
    arrays: dict[str, Any] = {
        name: np.concatenate([part[name] for part in parts]) for name in parts[0]
    }
    np.savez_compressed(
        TARGET, **arrays, irradiance=light, irradiance_error=noise, notes=np.array(NOTES)
    )


def _rays(
    turbidity: float, elevation_deg: float, altitude_m: float
) -> dict[str, NDArray[np.float64]]:
    """All views from one altitude."""
    air = atmosphere_of(BrunetonSkySettings(turbidity=turbidity, aerosol="one-lobe"))
    mu_s = float(np.sin(np.radians(elevation_deg)))
    mu, turn = (a.ravel() for a in np.meshgrid(MU[altitude_m], COSINE_OF_AZIMUTH, indexing="ij"))
    nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * turn
    paths = PATHS.get((turbidity, elevation_deg), MOST_PATHS)
    traced = monte_carlo_radiance(air, altitude_m, mu, mu_s, nu, paths=paths)
    same = {"turbidity": turbidity, "sun_elevation_deg": elevation_deg, "altitude_m": altitude_m}
    return {
        **{name: np.full(mu.size, value) for name, value in same.items()},
        "mu": mu, "mu_s": np.full(mu.size, mu_s), "nu": nu,
        "first": single_scattering(air, altitude_m, mu, mu_s, nu, samples=GAUSS_NODES),
        "multiple": traced.total(2), "error": traced.total_error(2),
    }  # fmt: skip


if __name__ == "__main__":
    main()

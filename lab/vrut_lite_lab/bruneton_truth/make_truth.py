"""Make tests/data/bruneton_truth.npz: multiply scattered light to judge fast solvers by.

Run from the repository's root: python -m vrut_lite_lab.bruneton_truth.make_truth
Some nine minutes on one core. Air with ozone (`Atmosphere.earth()`), and the same with ten times
the aerosol; observers from the ground to 300 km; suns from overhead to 6 degrees down. The
first order is exact; the others are the backward path tracer's, with standard errors. How the
arrays are named and read stands in the file's own `notes`.
"""

import time
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from bruneton_sky import Atmosphere, single_scattering
from bruneton_sky.geometry import horizon_mu

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.monte_carlo import (
    MonteCarloEstimate,
    enter_atmosphere,
    monte_carlo_irradiance,
    monte_carlo_radiance,
)

TARGET = ROOT / "tests" / "data" / "bruneton_truth.npz"
# Zenith angles of the sun, and paths per ray: more in twilight, where fewer find the sun.
PATHS = {0: 32768, 30: 32768, 60: 32768, 80: 32768, 87: 32768, 90: 32768, 93: 65536, 96: 131072}
IRRADIANCE_PATHS = 65536
HAZY_PATHS = {30: 16384, 80: 16384, 87: 16384, 93: 32768}
HAZE = 10.0
AZIMUTHS_DEG = (0.0, 75.0, 180.0)
GROUND_VIEWS_DEG = (0.0, 30.0, 60.0, 80.0, 87.0, 89.5, 90.0)
# Views of an observer in the air: zenith angles, and degrees above his horizon.
AIR_VIEWS_DEG, HORIZON_DEG = (0.0, 60.0, 85.0, 120.0, 180.0), (1.0, 0.2, -0.2, -2.0)
AIR_ALTITUDES_M = (2_000.0, 12_000.0, 50_000.0)
SPACE_ALTITUDE_M = 300_000.0
# Views from space: to the ground, as shares of the way from straight down to the horizon, and
# to the limb, as altitudes of the ray's perigee.
DISC_SHARES, LIMB_M = (0.0, 0.5, 0.8, 0.95, 0.995), (3_000.0, 10_000.0, 25_000.0, 45_000.0)
HIGHEST_ORDER = 10

NOTES = """Spectral radiance of the sky, W m^-2 sr^-1 nm^-1, at 680, 550 and 440 nm, point sun, no
refraction, spherical; air: Atmosphere.earth() with ozone, solar irradiance included; where
aerosol_factor is 10, its mie_scattering and mie_extinction are ten times as large.
Rays (n,): altitude_m and mu of the observer, mu_s, nu (view to sun); the same in degrees as
sun_zenith_deg, view_zenith_deg, azimuth_deg (0 toward the sun). Observers at 300 km stand above
the air: entry_altitude_m, entry_mu, entry_mu_s say the same ray where it enters (for others they
repeat altitude_m, mu, mu_s). hits_ground: the ray ends there; the radiance of that ground is
left out, its light scattered by the air is in.
first (n, 3): order 1, exact. orders (n, 9, 3): orders 2 to 9, then 10 and above together;
orders_error: standard errors. multiple (n, 3) their sum, multiple_error its standard error
(orders of one path are not independent). Reflections by the ground count as scatterings.
irradiance (air, sun, 10, 3): sky irradiance on level ground by order, W m^-2 nm^-1, without the
sun; irradiance_error; total and its error: irradiance_total, irradiance_total_error (air, sun,
3); axes irradiance_aerosol_factor, irradiance_sun_zenith_deg."""


class TruthRays(NamedTuple):
    """Rays (n,) in degrees and metres."""

    altitude_m: FloatArray
    view_zenith_deg: FloatArray
    azimuth_deg: FloatArray


def all_rays(air: Atmosphere) -> TruthRays:
    """Observers and directions, the same for each sun."""
    rows = _around(0.0, GROUND_VIEWS_DEG)
    for altitude in AIR_ALTITUDES_M:
        rows += _around(altitude, _air_views(air, altitude))
    rows += _around(SPACE_ALTITUDE_M, _space_views(air))
    return TruthRays(*np.array(rows).T)


def _around(altitude: float, zeniths: tuple[float, ...]) -> list[tuple[float, float, float]]:
    """One azimuth is enough straight up and down."""
    return [
        (altitude, zenith, azimuth)
        for zenith in zeniths
        for azimuth in (AZIMUTHS_DEG if zenith % 180.0 else AZIMUTHS_DEG[:1])
    ]


def _air_views(air: Atmosphere, altitude: float) -> tuple[float, ...]:
    horizon = _horizon_deg(air, altitude)
    return (*AIR_VIEWS_DEG, *(horizon - above for above in HORIZON_DEG))


def _space_views(air: Atmosphere) -> tuple[float, ...]:
    down = 180.0 - _horizon_deg(air, SPACE_ALTITUDE_M)
    perigees = (air.ground_radius_m + np.array(LIMB_M)) / (air.ground_radius_m + SPACE_ALTITUDE_M)
    limb = 180.0 - np.degrees(np.arcsin(perigees))
    return (*(180.0 - share * down for share in DISC_SHARES), *(float(v) for v in limb))


def _horizon_deg(air: Atmosphere, altitude: float) -> float:
    return float(np.degrees(np.arccos(horizon_mu(air.ground_radius_m, altitude))))


def trace(
    air: Atmosphere, rays: TruthRays, sun_deg: float, paths: int, seed: int
) -> dict[str, FloatArray]:
    """The arrays of one sun, named as in NOTES."""
    mu, mu_s = np.cos(np.radians(rays.view_zenith_deg)), float(np.cos(np.radians(sun_deg)))
    mu = np.where(rays.view_zenith_deg == 90.0, 0.0, mu)
    sine = np.sin(np.radians(rays.view_zenith_deg)) * np.sin(np.radians(sun_deg))
    nu = np.clip(mu * mu_s + sine * np.cos(np.radians(rays.azimuth_deg)), -1.0, 1.0)
    suns = np.full_like(mu, mu_s)
    entry = enter_atmosphere(air, rays.altitude_m, mu, suns, nu)
    horizon = horizon_mu(air.ground_radius_m, rays.altitude_m)
    light = monte_carlo_radiance(
        air, rays.altitude_m, mu, suns, nu,
        paths=paths, seed=seed, max_order=HIGHEST_ORDER,
    )  # fmt: skip
    return {
        **rays._asdict(),
        "sun_zenith_deg": np.full_like(mu, sun_deg),
        "mu": mu,
        "mu_s": suns,
        "nu": nu,
        **dict(zip(("entry_altitude_m", "entry_mu", "entry_mu_s"), entry, strict=True)),
        "hits_ground": mu < horizon,
        "first": single_scattering(air, *entry, nu, samples=64),
        "orders": light.per_order[:, 1:],
        "orders_error": light.standard_error[:, 1:],
        "multiple": light.total(2),
        "multiple_error": light.total_error(2),
    }


def trace_radiance(clear: Atmosphere, hazy: Atmosphere) -> dict[str, FloatArray]:
    """All suns of both airs, one after the other."""
    rays = all_rays(clear)
    low = TruthRays(*(part[rays.altitude_m <= AIR_ALTITUDES_M[0]] for part in rays))
    jobs = [(clear, rays, 1.0, *item) for item in PATHS.items()]
    jobs += [(hazy, low, HAZE, *item) for item in HAZY_PATHS.items()]
    parts = []
    for seed, (air, some, factor, sun, paths) in enumerate(jobs):
        part = trace(air, some, float(sun), paths, seed)
        part["aerosol_factor"] = np.full_like(part["mu"], factor)
        parts.append(part)
        print(f"aerosol x{factor:g}, sun {sun} deg: {time.process_time():.0f} s", flush=True)
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def trace_irradiance(clear: Atmosphere, hazy: Atmosphere) -> dict[str, FloatArray]:
    """Sky irradiance of both airs for every sun."""
    suns = np.array(list(PATHS), dtype=float)
    light: list[MonteCarloEstimate] = [
        monte_carlo_irradiance(
            air, np.cos(np.radians(suns)), paths=IRRADIANCE_PATHS, seed=100 + i,
            max_order=HIGHEST_ORDER,
        )
        for i, air in enumerate((clear, hazy))
    ]  # fmt: skip
    return {
        "irradiance_aerosol_factor": np.array([1.0, HAZE]),
        "irradiance_sun_zenith_deg": suns,
        "irradiance": np.array([e.per_order for e in light]),
        "irradiance_error": np.array([e.standard_error for e in light]),
        "irradiance_total": np.array([e.total() for e in light]),
        "irradiance_total_error": np.array([e.total_error() for e in light]),
    }


def main() -> None:
    """Write the file."""
    clear = Atmosphere.earth()
    hazy = replace(
        clear,
        mie_scattering=tuple(HAZE * s for s in clear.mie_scattering),
        mie_extinction=tuple(HAZE * e for e in clear.mie_extinction),
    )
    arrays = trace_radiance(clear, hazy) | trace_irradiance(clear, hazy)
    exact = ("altitude_m", "mu", "mu_s", "nu", "entry_altitude_m", "entry_mu", "entry_mu_s")
    small: dict[str, Any] = {
        name: value if name in exact or value.dtype == bool else value.astype(np.float32)
        for name, value in arrays.items()
    }
    np.savez_compressed(TARGET, notes=np.array(NOTES), **small)
    print(f"{TARGET.name}: {TARGET.stat().st_size / 1e3:.0f} kB, {time.process_time():.0f} CPU s")


if __name__ == "__main__":
    main()

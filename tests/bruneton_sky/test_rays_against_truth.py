"""The rays of the sky-view table against Monte Carlo, from the ground to space."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.sky_view import limb_counts, table_counts
from bruneton_sky.sky_view.rays import SkyViewRays
from bruneton_sky.solver import SourceField
from numpy.typing import NDArray
from scalar_air import scalar_field
from spectral_rows import total_radiance

TRUTH = np.load(Path(__file__).parents[1] / "data" / "bruneton_truth.npz")


@lru_cache
def field(aerosol_factor: int) -> SourceField:
    """The truth's air, solved as for a picture."""
    earth = Atmosphere.earth()
    air = replace(
        earth,
        mie_scattering=tuple(np.multiply(earth.mie_scattering, aerosol_factor)),
        mie_extinction=tuple(np.multiply(earth.mie_extinction, aerosol_factor)),
    )
    return scalar_field(air)


def compare(
    chosen: NDArray[np.bool_], aerosol_factor: int = 1
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Differences of total radiance over the larger of truth and a thousandth of the brightest,
    and the truth's standard errors in the same measure; both (n, C)."""
    chosen = chosen & (TRUTH["aerosol_factor"] == aerosol_factor)
    total = TRUTH["first"][chosen] + TRUTH["multiple"][chosen]
    ours = np.empty_like(total)
    place = np.stack([TRUTH[name][chosen] for name in ("altitude_m", "mu_s", "hits_ground")])
    for altitude_m, mu_s, hits in np.unique(place, axis=1).T:
        same = ((altitude_m, mu_s, hits) == place.T).all(axis=1)
        ours[same] = as_in_a_table(chosen.nonzero()[0][same], altitude_m, mu_s, aerosol_factor)
    scale = np.maximum(total, 1e-3 * total.max())
    return (ours - total) / scale, TRUTH["multiple_error"][chosen] / scale


def as_in_a_table(
    index: NDArray[np.int64], altitude_m: float, mu_s: float, aerosol_factor: int
) -> NDArray[np.float64]:
    """Radiance (n, C) of rays of one observer, all to the ground or none, with the steps and bins
    that his table takes."""
    entry = {name: TRUTH[f"entry_{name}"][index] for name in ("altitude_m", "mu", "mu_s")}
    hits = TRUTH["hits_ground"][index].astype(bool)
    rows = SkyViewRays(
        entry["altitude_m"], entry["mu"], hits,
        entry["mu_s"][:, None], TRUTH["nu"][index][:, None], np.zeros(2),
    )  # fmt: skip
    solved = field(aerosol_factor)
    counts = table_counts(solved.atmosphere, altitude_m, mu_s)
    if altitude_m > solved.atmosphere.top_altitude_m and not hits[0]:
        counts = limb_counts(counts)
    return total_radiance(solved, rows, counts)[:, 0]


@pytest.mark.parametrize("altitude_m", [0.0, 2000.0, 12_000.0, 50_000.0, 300_000.0])
@pytest.mark.parametrize("zenith_deg", [0.0, 30.0, 60.0, 80.0, 87.0])
def test_total_radiance_by_day(altitude_m: float, zenith_deg: float) -> None:
    """The mean error of the total by day is below 0.25 %, that of 99 % of the rays below 0.5 %
    (issue's number) beyond the truth's own noise, views from space with the limb included; 3
    degrees above the horizon, where the limb lies in the planet's shadow, below 0.7 %."""
    chosen = (TRUTH["altitude_m"] == altitude_m) & (TRUTH["sun_zenith_deg"] == zenith_deg)
    error, noise = compare(chosen)
    assert np.abs(error).mean() < 2.5e-3
    assert np.quantile(np.abs(error) - 3.0 * noise, 0.99) < (5e-3 if zenith_deg < 84.0 else 7e-3)


@pytest.mark.parametrize(("zenith_deg", "most"), [(90.0, 6e-3), (93.0, 1e-2), (96.0, 4e-2)])
def test_total_radiance_in_twilight(zenith_deg: float, most: float) -> None:
    """With the sun at and below the horizon the mean error, noise of 0.3 to 2 % included, stays
    below what is named; the sun's axis has a node every degree there."""
    error, _ = compare(TRUTH["sun_zenith_deg"] == zenith_deg)
    assert np.abs(error).mean() < most


@pytest.mark.parametrize("zenith_deg", [30.0, 80.0, 87.0])
def test_total_radiance_through_ten_times_the_aerosol(zenith_deg: float) -> None:
    """Issue: within 1.5 % with aerosol times ten, noise of 0.2 to 0.5 % included."""
    error, _ = compare(TRUTH["sun_zenith_deg"] == zenith_deg, aerosol_factor=10)
    assert np.abs(error).mean() < 8e-3

"""Walls through a volume of air: against the integral, and against the published look-up."""

import numpy as np
import pytest
from air_truth import WALLS_M, exactly, white_wall
from bruneton_sky.air_volume import air_volume
from bruneton_sky.geometry import altitude_along
from bruneton_sky.published.precompute import march_tables
from bruneton_sky.tables.sizes import TableSizes
from bruneton_sky.tables.tables import Tables
from directions import towards
from long_parameters import mostly_long
from partial_tables import empty_tables, fill_along
from solved_air import field, found

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray

ASIDE_DEG = np.array([-1.0, -0.85, -0.7, -0.5, -0.35, -0.2, -0.1, -0.03, 0.02, 0.2, 0.5, 1.0])


@pytest.fixture(scope="module")
def finer_tables() -> Tables:
    """The same air's tables, four times as fine by altitude, sun and angle to it as published:
    to be filled where they are looked at."""
    sizes = TableSizes(
        transmittance_altitude=256, transmittance_mu=1024, altitude=128, nu=32, mu_s=128
    )
    return empty_tables(field(), sizes)


@pytest.mark.parametrize("elevation_deg", [60.0, 20.0, 5.0])
@pytest.mark.parametrize("altitude_m", [2.0, 300.0])
def test_walls_through_the_volume(altitude_m: float, elevation_deg: float) -> None:
    """Walls at 1, 10 and 100 km, white and black, by day: within 1 % of the twin's total (the
    issue's figure), where a wall has so much light in the channel as a hundredth of the white
    one's; 1.5 % within 45 degrees of the sun's azimuth, where straight lines between columns miss
    the light's curve by more."""
    solved, sun = field(), towards(elevation_deg)
    volume = air_volume(solved, altitude_m, sun, 1.2e5)
    wall = white_wall(solved, sun)
    for height in (-0.01, 0.4, 2.0, 8.0):
        for azimuth in (3.0, 20.0, 75.0, 170.0):
            view = towards(height, azimuth)
            light, through = exactly(solved, altitude_m, view, sun, WALLS_M)
            ours, passed = found(volume, view, WALLS_M)
            most = 1.5e-2 if azimuth < 45.0 else 1e-2
            assert np.all(np.abs(ours - light) <= most * (light + 1e-2 * wall))
            white = light + wall * through
            assert np.all(np.abs(ours + wall * passed - white) <= most * white)


@pytest.mark.parametrize(
    "sun_deg", mostly_long([60.0, 40.0, 25.0, 10.0], (60.0, 10.0).__contains__)
)
@pytest.mark.parametrize(("height", "azimuth"), [(2.0, 45.0), (5.0, 60.0), (20.0, 120.0)])
def test_walls_against_radiance_to_point(
    finer_tables: Tables, height: float, azimuth: float, sun_deg: float
) -> None:
    """White and black walls at 1, 10 and 100 km by day against the published look-up between two
    points: within 1 % (the issue's figure). Its tables are finer than published, for a difference
    of two interpolated values errs: those of the published sizes are up to 6 % from the integral
    here, these 0.5 % at most, which is held too."""
    solved, sun, view = field(), towards(sun_deg), towards(height, azimuth)
    air = solved.atmosphere
    eye = np.array([0.0, air.ground_radius_m + 2.0, 0.0])
    fill_along(solved, finer_tables, 2.0, view, sun, WALLS_M)
    light, through = finer_tables.radiance_to_point(eye, eye + WALLS_M[:, None] * view, sun)
    expected = rgb_from_spectrum(light, air.wavelength_nm)
    exact, _ = exactly(solved, 2.0, view, sun, WALLS_M)
    assert expected == pytest.approx(exact, rel=6e-3)
    black, passed = found(air_volume(solved, 2.0, sun, 1.2e5), view, WALLS_M)
    assert black == pytest.approx(expected, rel=1e-2)
    lit = np.asarray(air.solar_irradiance) / np.pi * sun[1]
    white = rgb_from_spectrum(light + lit * through, air.wavelength_nm)
    assert black + white_wall(solved, sun) * passed == pytest.approx(white, rel=1e-2)


@pytest.mark.parametrize(
    "altitude_m", mostly_long([300.0, 1000.0, 3000.0, 6000.0, 12e3], (3000.0).__eq__)
)
def test_far_walls_about_the_horizon(altitude_m: float) -> None:
    """From a hill to an airliner, black walls at 10 to 150 km, a degree about the horizon: within
    1 %, 60 degrees from the sun's azimuth and 140, whether the table reaches to the wall or half as
    far again. There rays change from ending at the reach to ending in the depth, and a step of a
    degree is kilometres of height: 5 % with rows that know nothing of that."""
    solved, sun = field(), towards(20.0)
    radius = solved.atmosphere.ground_radius_m
    dip = -np.degrees(np.arccos(radius / (radius + altitude_m)))
    for metres in (1e4, 2e4, 4e4, 8e4, 1.5e5):
        views = [towards(dip + aside, azimuth) for aside in ASIDE_DEG for azimuth in (60.0, 140.0)]
        stand = [view for view in views if _is_seen(radius, altitude_m, view, metres)]
        exact = [exactly(solved, altitude_m, v, sun, np.array([metres]))[0][0] for v in stand]
        for reach_m in (metres, 1.4 * metres):
            volume = air_volume(solved, altitude_m, sun, reach_m)
            light, _ = found(volume, np.array(stand), np.full(len(stand), metres))
            assert light == pytest.approx(np.array(exact), rel=1e-2)


def _is_seen(radius_m: float, altitude_m: float, view: FloatArray, metres: float) -> bool:
    """Whether a point is above the level, and not behind the horizon's ground."""
    there = float(altitude_along(radius_m, altitude_m, view[1], np.array([metres]))[0])
    perigee = (radius_m + altitude_m) * np.hypot(view[0], view[2]) - radius_m
    behind = perigee < 0.0 and metres > -(radius_m + altitude_m) * view[1]
    return there > 0.0 and not behind


def test_partial_tables_are_those_of_march_tables() -> None:
    """What is filled in along a ray must be what `march_tables` has at these nodes, within float32:
    other sums, the same rays."""
    solved, view, sun = field(), towards(5.0, 60.0), towards(25.0)
    sizes = TableSizes(altitude=8, mu=16, nu=4, mu_s=8)
    part, whole = empty_tables(solved, sizes), march_tables(solved, sizes)
    fill_along(solved, part, 2.0, view, sun, WALLS_M)
    for ours, all_of_it in zip((part.scattering, part.single_mie), whole, strict=True):
        filled = ours > 0.0
        assert filled.sum() > 100
        assert ours[filled] == pytest.approx(all_of_it[filled], rel=1e-4)

"""Nishita 1996: the grids of light, what a direction stands for, the published error."""

import numpy as np
import pytest
from bruneton_sky import single_scattering
from bruneton_sky.optical_path import optical_depth_to_top
from bruneton_sky.solver import multiple_scattering, solve
from measured_error import error_mw

from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.directions import directions
from vrut_lite_lab.study.models.light_grid import LightGrid
from vrut_lite_lab.study.models.model import cosines
from vrut_lite_lab.study.models.nishita93 import Nishita93
from vrut_lite_lab.study.models.nishita96 import Nishita96

SUN_RAD = 0.7
AIR = STUDY.bruneton_atmosphere()
SUN_IRRADIANCE = STUDY.solar_irradiance


def above_viewer(altitude_m):
    return np.array([[0.0, 0.0, STUDY.ground_radius_m + altitude_m]])


def exact_once(from_zenith_rad, altitude_m):
    """Light scattered once, per unit of solar irradiance."""
    mu, nu = np.cos(from_zenith_rad), np.cos(from_zenith_rad - SUN_RAD)
    return single_scattering(AIR, altitude_m, mu, np.cos(SUN_RAD), nu, samples=24) / SUN_IRRADIANCE


def test_light_from_below_is_air_and_ground():
    """At the top of the air, from the nadir: 32 steps of 1.9 km err by 1 %."""
    depth = optical_depth_to_top(AIR, 0.0, np.array([1.0, np.cos(SUN_RAD)]))
    ground = np.exp(-depth.sum(axis=0)) * np.cos(SUN_RAD) * STUDY.ground_albedo / np.pi
    seen = LightGrid(STUDY, SUN_RAD, np.pi).radiance(above_viewer(60_000.0))[0]
    np.testing.assert_allclose(seen, exact_once(np.pi, 60_000.0) + ground, rtol=0.01)


@pytest.mark.parametrize("from_zenith_rad", [0.0, SUN_RAD - np.pi / 2])
def test_light_from_above(from_zenith_rad):
    """5 km up, where aerosol no longer falls by steps: 6 % at most, 2 % at the violet end."""
    seen = LightGrid(STUDY, SUN_RAD, from_zenith_rad).radiance(above_viewer(5000.0))[0]
    exact = exact_once(from_zenith_rad, 5000.0)
    np.testing.assert_allclose(seen, exact, rtol=0.06)
    np.testing.assert_allclose(seen[0], exact[0], rtol=0.02)


def test_light_of_the_horizon_is_too_much():
    """Why the published second scattering would be too strong: steps of 55 km at the horizon."""
    seen = LightGrid(STUDY, SUN_RAD, np.pi / 2).radiance(above_viewer(0.0))[0]
    mu = 0.0
    nu = np.sin(SUN_RAD)
    exact = single_scattering(AIR, 0.0, mu, np.cos(SUN_RAD), nu, samples=24) / SUN_IRRADIANCE
    assert 3.5 < (seen / exact)[0] < 4.5


def test_grids_are_even_about_the_suns_plane():
    """Half a box is kept for both sides."""
    grid = LightGrid(STUDY, SUN_RAD, 0.3)
    point = np.array(
        [[3e4, 2e4, STUDY.ground_radius_m + 1e4], [3e4, -2e4, STUDY.ground_radius_m + 1e4]]
    )
    left, right = grid.radiance(point)
    np.testing.assert_array_equal(left, right)
    assert np.all(left > 0.0)


@pytest.mark.long
def test_second_scattering_is_too_strong():
    """1.5 times that of the solver at a high sun, 3.2 times at 75 degrees: so the model errs as
    little as Bruneton's, with half of his orders."""
    zenith, azimuth = directions()
    field = solve(AIR, 2)
    for sun_rad, share in ((0.4, 1.51), (1.3, 3.17)):
        seen = zenith, azimuth
        twice = Nishita96().sky_radiance(sun_rad, *seen) - Nishita93().sky_radiance(sun_rad, *seen)
        exact = multiple_scattering(field, 0.0, *cosines(sun_rad, *seen))
        assert twice.sum() / exact.sum() == pytest.approx(share, rel=0.1)


@pytest.mark.long
def test_quirk_leaves_zenith_and_nadir():
    """So the published second scattering is weaker by half and more, with a high sun."""
    zenith, azimuth = directions()
    once = Nishita93().sky_radiance(SUN_RAD, zenith, azimuth)
    right, published = (
        Nishita96(quirks).sky_radiance(SUN_RAD, zenith, azimuth) - once for quirks in (False, True)
    )
    assert published.sum() < 0.6 * right.sum()
    assert np.all(published > 0.0)


@pytest.mark.long
def test_error_against_the_measured_sky(measured_skies):
    """18.2 as published, where the search for the nearest direction does not work; ours is 17.9."""
    assert error_mw(Nishita96(quirks=True), measured_skies) == pytest.approx(18.2, abs=0.5)


@pytest.mark.long
def test_error_had_the_search_worked(measured_skies):
    """At 09:30, 11:00 and 12:30: 12.5, 12.4 and 8.0, where Bruneton's has 11.7, 12.7 and 9.0."""
    some = [measured_skies[k] for k in (0, 6, 10)]
    assert error_mw(Nishita96(), some) == pytest.approx(11.2, abs=0.1)

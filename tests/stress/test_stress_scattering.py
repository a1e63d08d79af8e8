"""Single scattering by every rule on any planet, and phase functions."""

from functools import partial

import numpy as np
import pytest
from bruneton_sky import phase, single_scattering
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.optical_path import optical_depth_to_top
from bruneton_sky.published.single_scattering import scattered_without_phase
from bruneton_sky.single_scattering_kernels import fast_scattered_without_phase
from long_parameters import mostly_long
from planets import EARTH, PLANETS, SHORT
from stress_cases import (
    assert_continuous,
    assert_light,
    assert_rising,
    assert_same_on_threads,
)

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase

planets = pytest.mark.parametrize("name", mostly_long(PLANETS, SHORT.__contains__))
CLASSICAL = ["midpoint", "trapezoid", "simpson"]


def rays(stress, count, air, height=None, sun=None):
    """Altitude, zenith angles of view and sun, relative azimuth, often near the horizon."""
    h = stress.within(count, 0.0, air.top_altitude_m, [1e-6, 2.0, air.top_altitude_m - 1e-6])
    h = h if height is None else np.full(count, height)
    horizon = np.arccos(horizon_mu(air.ground_radius_m, h))
    angles = []
    for _ in range(2):
        aside = stress.within(count, -1e-3, 1e-3, [0.0, 1e-9, -1e-9])
        near = stress.random.random(count) < 0.3
        even = stress.within(count, 0.0, np.pi, [np.pi / 2])
        angles.append(np.clip(np.where(near, horizon + aside, even), 0.0, np.pi))
    suns = angles[1] if sun is None else np.full(count, sun)
    return h, angles[0], suns, stress.within(count, 0.0, np.pi)


def cosines(view, sun, turn):
    """mu, mu_s and nu of two zenith angles and the relative azimuth."""
    mu, mu_s = np.cos(view), np.cos(sun)
    return mu, mu_s, np.clip(mu * mu_s + np.sin(view) * np.sin(sun) * np.cos(turn), -1.0, 1.0)


@planets
def test_light_scattered_once_is_light(stress, name):
    """Finite, not negative, and at most what air of single-scattering albedo 1 would scatter."""
    air = PLANETS[name]
    most = np.asarray(air.solar_irradiance) * float(phase.mie_phase(air, np.sign(air.mie_g)))
    most = np.maximum(most, np.asarray(air.solar_irradiance) * 3.0 / (8.0 * np.pi)) * 1.001
    for count in stress.batches("single_scattering (gauss-legendre)", 1500, most=3000):
        h, *angles = rays(stress, count, air)
        light = single_scattering(air, h, *cosines(*angles))
        assert_light(light)
        assert (light <= most).all()


@pytest.mark.parametrize("rule", CLASSICAL)
@planets
def test_classical_rules_give_light(stress, name, rule):
    """Even with few samples light is finite and not negative."""
    air = PLANETS[name]
    for count in stress.batches(f"single_scattering ({rule})", 300, most=1000):
        samples = (int(2 * stress.random.integers(1, 9)), int(2 * stress.random.integers(1, 5)))
        h, *angles = rays(stress, count, air)
        assert_light(single_scattering(air, h, *cosines(*angles), rule=rule, samples=samples))


@planets
def test_light_scattered_once_has_no_jump(stress, name):
    """Continuous in view, sun and altitude, except at the ground's horizon.

    Views stay on one side of the horizon, where the ground cuts rays. In nearly uniform air,
    rays of a few metres at its top have rounding errors of 2e-8 of the brightest.
    """
    air, most = PLANETS[name], 1e-3 if name == "even air" else 1e-6
    for count in stress.batches("single_scattering (gauss-legendre)", 200, most=200):
        h, view, sun, turn = rays(stress, count, air)
        h = np.minimum(h, air.top_altitude_m - 2e-6)
        view, sun = (np.clip(angle, 0.0, np.pi - 2e-6) for angle in (view, sun))
        horizon = np.arccos(horizon_mu(air.ground_radius_m, h))
        view = np.where(np.abs(view - horizon) <= 3e-6, horizon - 4e-6, view)

        def look(h, view, sun, turn):
            return single_scattering(air, h, *cosines(view, sun, turn))

        assert_continuous(lambda at, h, s, t: look(h, at, s, t), view, h, sun, turn, most=most)
        assert_continuous(lambda at, h, v, t: look(h, v, at, t), sun, h, view, turn, most=most)
        assert_continuous(lambda at, h, v, s: look(h, v, s, at), turn, h, view, sun, most=most)
        dips = np.arccos(horizon_mu(air.ground_radius_m, h + 1e-6))
        h = np.where((view >= horizon) & (view <= dips), h + 1.0, h)
        assert_continuous(
            look, np.minimum(h, air.top_altitude_m - 2e-6), view, sun, turn, most=most
        )


@planets
def test_kernels_hold_to_their_twin(stress, name):
    """The compiled kernels agree with the exact rule, finite and not negative.

    Their complementary error function errs by 1.3e-9 of it, so a path to a node by as much of
    the whole ray's: light by 4e-8 for each unit of optical depth to the horizon. Left out are rays
    that graze the ground within 1e-9, and those into the sun within 1e-6 of the horizon, which run
    along the edge of the planet's shadow: there the root of a rounding decides.
    """
    air = PLANETS[name]
    for count in stress.batches("fast_scattered_without_phase", 4000, most=500):
        place = float(stress.within(1, 0.0, air.top_altitude_m, [1e-6, 2.0])[0])
        sun = rays(stress, 1, air, place)[2][0]
        _, *angles = rays(stress, count, air, place, sun)
        horizon = float(np.arccos(horizon_mu(air.ground_radius_m, place)))
        away = np.abs(angles[0] - horizon)
        grazing = (away < 1e-9) | ((away < 1e-6) & (np.abs(sun - horizon) < 1e-6))
        mu, mu_s, nu = (part[~grazing] for part in cosines(*angles))
        args = (air, place, mu, float(mu_s[0]), nu)
        fast = fast_scattered_without_phase(*args)
        for kind in fast:
            assert_light(kind)
        if stress.random.random() < 0.2:
            bound = 4e-8 * (1.0 + float(optical_depth_to_top(air, 0.0, 0.0).max()))
            for one, other in zip(fast, scattered_without_phase(*args), strict=True):
                assert np.abs(one - other).max() <= bound * max(other.max(), 1e-300)


def test_kernels_are_the_same_on_two_threads(stress):
    """Two threads at once give the same bits."""
    for count in stress.batches("fast_scattered_without_phase", 3000):
        mu, _, nu = cosines(*rays(stress, count, EARTH, 2.0, np.arccos(0.05))[1:])
        assert_same_on_threads(fast_scattered_without_phase, EARTH, 2.0, mu, 0.05, nu)
        assert_same_on_threads(single_scattering, EARTH, 2.0, mu[:500], 0.05, nu[:500])


def test_phase_functions_are_shares_of_light(stress):
    """Finite, positive, smooth, falling with the angle from the sun, for g in (-1, 1)."""
    for count in stress.batches("phase functions", 60_000, most=3000):
        g = float(stress.within(1, -0.999, 0.999, [0.0, 0.8])[0])
        nu = np.minimum(stress.within(count, -1.0, 1.0, [0.0]), 1.0 - 2e-6)
        for function in (
            phase.rayleigh_phase,
            partial(cornette_shanks_phase, g=g),
            partial(phase.henyey_greenstein_phase, g=g),
        ):
            assert_light(function(nu))
            assert_continuous(function, nu)
        toward = np.sort(nu) if g >= 0.0 else np.sort(nu)[::-1]
        assert_rising(phase.henyey_greenstein_phase(toward, g), 1e-12)

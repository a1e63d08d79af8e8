"""Rays, optical depths and transmittances through the air of any planet."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from bruneton_sky import geometry
from bruneton_sky.optical_path import optical_depth_to_top
from bruneton_sky.sun_light import disc_light, seen_irradiance_rgb, sun_irradiance
from long_parameters import mostly_long
from planets import CLEAR, EARTH, PLANETS, SHORT
from stress_cases import (
    assert_continuous,
    assert_finite,
    assert_light,
    assert_rising,
    assert_same_on_threads,
)

planets = pytest.mark.parametrize("name", mostly_long(PLANETS, SHORT.__contains__))


def altitudes(stress, count, air, special=()):
    """Altitudes from the ground to the top, a millionth of a metre above the ground included."""
    return stress.within(count, 0.0, air.top_altitude_m, [1e-6, 1e-3, 2.0, *special])


def cosines(stress, count, air, altitude):
    """Zenith cosines from nadir to zenith, dense about the altitude's horizon."""
    mu = stress.within(count, -1.0, 1.0, [0.0])
    near = geometry.horizon_mu(air.ground_radius_m, altitude)
    near = near + stress.within(count, -1e-3, 1e-3, [0.0, 1e-9, -1e-9])
    return np.clip(np.where(stress.random.random(count) < 0.4, near, mu), -1.0, 1.0)


@planets
def test_rays_end_where_they_should(stress, name):
    """Distances are finite and not negative, ends lie on the ground or the top."""
    air = PLANETS[name]
    planet = air.ground_radius_m, air.top_altitude_m
    for count in stress.batches("distance_to_top, _ground, altitude_along", 30_000):
        h = altitudes(stress, count, air)
        mu = cosines(stress, count, air, h)
        ray = geometry.make_ray(planet[0], h, mu)
        hits = ray.hits_ground()
        top, ground = (
            geometry.distance_to_top(*planet, h, mu),
            geometry.distance_to_ground(planet[0], h, mu),
        )
        assert_light(top)
        assert_light(ground[hits])
        level = np.abs(
            geometry.altitude_along(planet[0], h[~hits], mu[~hits], top[~hits]) - planet[1]
        )
        assert level.max(initial=0.0) <= 1e-9 * planet[0]
        level = np.abs(geometry.altitude_along(planet[0], h[hits], mu[hits], ground[hits]))
        assert level.max(initial=0.0) <= 1e-9 * planet[0]
        end, y = geometry.end_of_ray(ray, planet[1])
        assert_finite(y)
        assert np.isin(end, [0.0, planet[1]]).all()


@planets
def test_depth_to_the_top(stress, name):
    """Finite, not negative, continuous in both arguments, decreasing with altitude.

    On steeper rays it is smaller, except for the absorber, which is a layer.
    """
    air = PLANETS[name]
    depth = partial(optical_depth_to_top, air)
    for count in stress.batches("optical_depth_to_top", 20_000):
        h = altitudes(stress, count, air, air.absorber_altitude_m)
        mu = cosines(stress, count, air, h)
        lowest = geometry.horizon_mu(air.ground_radius_m, h)
        seen = np.minimum(np.maximum(mu, lowest), 1.0 - 2e-6)
        assert_light(depth(h, mu))
        assert_continuous(lambda at, h: np.exp(-depth(h, at)), seen, h)
        held = np.minimum(h, air.top_altitude_m - 1.0)
        assert_continuous(lambda at, mu: np.exp(-depth(at, mu)), held, np.abs(mu))
        once = replace(air, absorption_extinction=0.0)
        rays = np.sort(seen[: count // 2])
        place = float(held[0])
        rays = rays[rays >= geometry.horizon_mu(air.ground_radius_m, place)]
        falling = np.exp(-optical_depth_to_top(once, place, rays))
        assert_rising(falling, 1e-9)
        assert_rising(np.exp(-optical_depth_to_top(once, np.sort(h), 0.3)), 1e-9)


def test_depth_is_the_same_on_two_threads(stress):
    """Two threads give the same bits."""
    for count in stress.batches("optical_depth_to_top", 20_000):
        h = altitudes(stress, count, EARTH)
        mu = cosines(stress, count, EARTH, h)
        assert_same_on_threads(optical_depth_to_top, EARTH, h, mu)


@planets
def test_sunlight_from_the_ground_to_space(stress, name):
    """For observers up to the moon sunlight is at most that above the air.

    Without a jump as the sun sets, its disc cut by the horizon. Seen from the moon the next cosine
    that there is leads by a rock or through a film on the ground micrometres to a millimetre lower.
    """
    air = PLANETS[name]
    most = np.asarray(air.solar_irradiance) * (1.0 + 1e-12)
    for count in stress.batches("sun_irradiance, disc_light", 20, most=20):
        place = float(stress.within(1, 0.0, 4e8, [1e-6, air.top_altitude_m, 10_000.0])[0])
        place = place if stress.random.random() < 0.3 else min(place, air.top_altitude_m)
        mu_s = np.minimum(cosines(stress, count, air, np.full(count, place)), 1.0 - 2e-6)
        light = sun_irradiance(air, place, mu_s)
        assert_light(light)
        assert (light <= most).all()
        left = 1e-4 if place > air.top_altitude_m else 1e-6
        assert_continuous(partial(sun_irradiance, air, place), mu_s, most=left)

        def seen(at, place=place):
            return np.array([seen_irradiance_rgb(air, place, float(mu)) for mu in at])

        assert_light(seen(mu_s))
        assert_continuous(seen, mu_s, most=left)
        disc = disc_light(air, place, float(mu_s[0]))
        assert_light(disc.irradiance_rgb)


def test_thinner_fog_lets_more_through(stress):
    """The fog's extinction falls to zero as visibility rises from 1 m to the moon's distance."""
    for count in stress.batches("Atmosphere.with_fog", 300):
        visibility = np.sort(10.0 ** stress.within(count, 0.0, 8.6))
        fog = [CLEAR.with_fog(float(v), 50.0).fog_extinction[0] for v in visibility]
        assert_light(np.array(fog))
        assert_rising(-np.array(fog))
        assert fog[-1] == 0.0

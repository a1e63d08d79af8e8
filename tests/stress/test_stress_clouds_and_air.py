"""Clouds, the simple air of the Hosek-Wilkie sky, and all settings."""

from functools import cache

import numpy as np
import pytest
from bruneton_sky import single_scattering
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from clouds.layer import with_coverage
from clouds.model import cloud_density as clouds
from clouds.module import make_layers
from clouds.settings import CloudSettings
from dynamic_skylight.air import air_is_seen, air_volume
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.settings import DynamicSkyLightSettings
from hypothesis import given
from hypothesis import strategies as st
from stress_cases import assert_continuous, assert_finite, assert_light, assert_rising

from vrut_lite.kernel.settings import describe
from vrut_lite.sky.air_volume import look_up_air

EYE = np.array([0.0, 2.0, 0.0])


@cache
def layer():
    """A layer of coverage 0.5; its noise takes seconds, once a process."""
    return make_layers(CloudSettings(coverage=0.5))[1][0]


def places(stress, count):
    """Points (count, 3) in the layer, at its faces, below, above, far away and in space."""
    top = layer().base_m + layer().thickness_m
    level = stress.within(2 * count, -2e5, 2e5, [0.0, 5300.0]).reshape(count, 2)
    level = np.where(stress.random.random((count, 1)) < 0.05, level * 1e3, level)
    height = stress.within(count, 0.0, 2.0 * top, [layer().base_m, top, 1e-6])
    height = np.where(stress.random.random(count) < 0.05, 4e8, height)
    return np.stack([level[:, 0], height, level[:, 1]], axis=-1)


@pytest.mark.long
def test_cloud_density_is_a_share(stress):
    """In [0, 1] everywhere, zero outside the layer, continuous except at its faces.

    The faces themselves are at density 0: bases fade in, tops fade out.
    """
    for count in stress.batches("clouds.density", 20_000, most=8192):
        points = places(stress, count)
        density = clouds.density(layer(), points, EYE)
        assert_light(density)
        assert density.max() <= 1.0
        assert_finite(clouds.altitude_m(points, EYE))
        weather = clouds.weather_at(layer(), points[:, [0, 2]])
        assert_light(weather)
        assert weather.max() <= 1.0 + 1e-12
        near = points[np.abs(points[:, [0, 2]]).max(axis=1) < 2e5]
        near = near[near[:, 1] < 1e5]

        def look(at, x, z):
            return clouds.density(layer(), np.stack([x, at, z], axis=-1), EYE)

        # The envelope of tops is a square root, steep enough to show over a micrometre.
        assert_continuous(look, near[:, 1], near[:, 0], near[:, 2], most=1e-5)


@pytest.mark.long
def test_more_cloud_lets_less_through(stress):
    """Density is in [0, 1], rises with envelope and shape, and falls with detail."""
    form = layer().form
    for count in stress.batches("clouds.density_of, envelope", 400_000):
        rising = np.sort(stress.within(count, 0.0, 1.0))
        some, other = stress.random.random(2)
        assert_rising(clouds.density_of(rising, some, other, form))
        assert_rising(clouds.density_of(some, rising, other, form))
        assert_rising(-clouds.density_of(some, other, rising, form))
        column = clouds.column_of(stress.within(count, 0.0, 1.0), float(some), form)
        part = clouds.envelope(column, rising, form)
        assert_light(part)
        assert part.max() <= 1.0


@pytest.mark.long
def test_the_sun_through_clouds(stress):
    """Transmittance is in [0, 1] for any point and sun, level suns and the moon's distance too."""
    for count in stress.batches("clouds.sun_transmittance, distance_up_m", 60):
        for point, sun in zip(places(stress, count), stress.directions(count), strict=True):
            share = clouds.sun_transmittance(layer(), point, sun)
            assert 0.0 <= share <= 1.0, f"{point} {sun}"
            distance = clouds.distance_up_m(float(point[1]), layer().base_m, float(sun[1]))
            assert np.isfinite(distance)


@pytest.mark.long
def test_coverage_only_adds_cloud(stress):
    """Larger coverage has a lower threshold; 0 has no cloud and 1 no gap."""
    coverage = [0.0, 1e-6, 0.4, 0.999, 1.0]
    layers = [with_coverage(layer(), share) for share in coverage]
    assert_rising(-np.array([covered.threshold for covered in layers]))
    for covered in layers:
        assert 0.0 <= covered.column_density <= 1.0


def test_the_day_skys_air_is_light(stress):
    """Any haze, sun, height and reach: light and extinction finite and not negative, and smooth.

    Transmittance falls with distance; it may grow by no more than linear
    interpolation between slices errs (measured: 4e-4, less than is seen).
    """
    for count in stress.batches("dynamic_skylight.air_volume, look_up_air", 3000, most=250):
        turbidity = float(stress.within(1, 1.0, 10.0, np.arange(1.0, 11.0))[0])
        elevation = float(stress.within(1, -np.pi / 2, np.pi / 2, [0.0, 1e-9, -1e-9])[0])
        place = float(stress.within(1, 0.0, 9e4, [1e-6, 2.0, 6e4])[0])
        place = 4e8 if stress.random.random() < 0.1 else place
        reach = float(10.0 ** stress.within(1, -3.0, 8.0)[0])
        sun = (np.cos(elevation), np.sin(elevation), 0.0)
        day = Daylight(turbidity, 0.1, "disc", elevation, np.pi / 2, float(elevation > 0.0))
        air_is_seen(day.air_haze, place, reach)
        volume = air_volume(day, sun, place, reach)
        for part in (volume.light, volume.extinction):
            assert_light(part.values, f"{turbidity} {elevation} {place} {reach}")
        direction = stress.directions(count)
        distance = np.sort(stress.within(count, 0.0, 2.0 * reach, [1e-6, 1.0, reach]))
        seen = look_up_air(volume, direction, distance)
        for part in seen:
            assert_light(part, f"{turbidity} {elevation} {place} {reach}")
        assert seen.transmittance.max() <= 1.0
        one_way = look_up_air(volume, np.broadcast_to(direction[0], direction.shape), distance)
        assert_rising(-one_way.transmittance, 1e-3)


KINDS = [BrunetonSkySettings, CloudSettings, DynamicSkyLightSettings]


@pytest.mark.parametrize("kind", KINDS)
def test_settings_have_bounds(kind):
    """Every numeric setting has a minimum and a maximum, so that the range can be tested."""
    for spec in describe(kind).values():
        if spec.type in (int, float):
            assert None not in (spec.at_least, spec.at_most), spec.name


def any_value(spec):
    """A strategy for a setting's values, which often takes the ends."""
    if spec.choices:
        values = st.sampled_from(spec.choices)
    elif spec.type is int:
        values = st.integers(int(spec.at_least), int(spec.at_most))
    else:
        ends = st.sampled_from([spec.at_least, spec.at_most])
        values = ends | st.floats(spec.at_least, spec.at_most)
    return st.none() | values if spec.may_be_none else values


ANY_AIR = st.fixed_dictionaries(
    {name: any_value(spec) for name, spec in describe(BrunetonSkySettings).items()}
)


@given(chosen=ANY_AIR, height=st.sampled_from([0.0, 1e-6, 2000.0, 8848.0, -430.0]))
def test_every_setting_makes_an_air(chosen, height):
    """All settings within bounds, at any altitude, give an atmosphere with finite light."""
    air = atmosphere_of(BrunetonSkySettings(**chosen), height)
    light = single_scattering(air, [0.0, air.top_altitude_m], [0.1, -0.2], 0.3, [0.5, -0.5])
    assert_light(light)

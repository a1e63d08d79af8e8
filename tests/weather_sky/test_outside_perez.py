"""Weather outside Perez's fit: a neighbour's shape serves, the hour's totals are met."""

import logging
from datetime import UTC, datetime

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from weather_sky.conditions import KINDS, Conditions
from weather_sky.hemisphere import horizontal
from weather_sky.light import WeatherLight
from weather_sky.module import WeatherSky
from weather_sky.perez import AllWeather, all_weather
from weather_sky.year import irradiance_of_year

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, Fault, SetClock, SetSetting
from vrut_lite.messages.haze import DEFAULT_HAZE
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.weather import HOURS, SetWeather


def conditions(direct, diffuse, elevation_deg, kind="perez", dew_point_c=11.0, day=80):
    return Conditions(kind, direct, diffuse, dew_point_c, day, np.radians(elevation_deg), 1.0)


def light_of(weather):
    up = weather.apparent_elevation_rad
    return WeatherLight(weather, (np.cos(up), np.sin(up), 0.0), (0.2,) * 3, DEFAULT_HAZE)


def level_lux(cube):
    return LUMENS_PER_WATT * float(luminance(horizontal_irradiance(cube.astype(float))))


@pytest.mark.parametrize(("direct", "diffuse"), [(150, 50), (76, 30), (30, 10), (10, 5)])
def test_thin_light_below_a_high_sun(direct, diffuse):
    """Perez's fit is below 0 over the whole sky: its totals were 0 / 0. They are met to 0.5 %."""
    weather = conditions(direct, diffuse, 79.4)
    light = light_of(weather)
    assert weather.outside_perez
    efficacy = float(weather.state.diffuse_efficacy(1.97))
    assert level_lux(light._sky_cube) == pytest.approx(diffuse * efficacy, rel=0.01)
    facing = LUMENS_PER_WATT * float(luminance(light.sun().irradiance_rgb))
    assert facing == pytest.approx(weather.direct_lux)
    assert facing > 80.0 * direct


def test_direct_light_without_diffuse_is_no_night():
    """At noon 0 W/m² of the sky is a black sky, for it was measured; twilight has no place there.

    Where both are 0 below a sun of 5 degrees, files have rounded twilight away: it stands in.
    """
    noon = conditions(500.0, 0.0, 60.0)
    assert noon.diffuse_lux == 0.0
    assert noon.direct_lux > 40_000.0
    assert light_of(noon).background(16).cube[2].max() < 1e-6
    assert conditions(0.0, 0.0, 60.0).diffuse_lux == 0.0
    assert 400.0 < conditions(0.0, 0.0, 1.0).diffuse_lux < 1500.0


def test_every_kind_of_sky_has_a_neighbour():
    """Both factors are above 0 for all kinds, suns, brightnesses; most states stay as they are."""
    clearness, zenith, brightness = (
        grid.ravel()
        for grid in np.meshgrid(
            [1.0, 1.1, 1.3, 1.7, 2.4, 3.6, 5.3, 9.0, 12.0],
            np.radians(np.arange(0.0, 89.5, 4.0)),
            [0.01, 0.02, 0.04, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6],
        )
    )
    state = AllWeather(zenith, clearness, brightness)
    spread = state.distribution()
    columns = type(spread)(*(np.asarray(term)[:, None] for term in spread[:5]))
    assert columns.gradation(np.linspace(0.0, 1.0, 50)).min() > 0.0
    assert columns.indicatrix(np.cos(np.linspace(0.0, np.pi, 300))).min() > 0.0
    assert horizontal(spread, zenith, 16).min() > 0.01
    # Skies that Perez does describe stay as they are: most of them.
    assert 0.02 < state.is_outside.mean() < 0.2


@settings(max_examples=150, deadline=None)
@given(
    direct=st.floats(0.0, 1500.0),
    diffuse=st.one_of(st.floats(0.0, 5.0), st.floats(0.0, 1200.0)),
    elevation_deg=st.floats(-20.0, 90.0),
    dew_point_c=st.floats(-70.0, 40.0),
    kind=st.sampled_from(KINDS),
)
def test_any_weather_has_finite_light(direct, diffuse, elevation_deg, dew_point_c, kind):
    """No NaN, nothing negative, and both totals met, whatever an hour of a file may say."""
    weather = conditions(direct, diffuse, elevation_deg, kind, dew_point_c)
    light = light_of(weather)
    cube, sun = light._sky_cube, light.sun().irradiance_rgb
    for values in (cube, sun, light.ambient()):
        assert np.isfinite(values).all()
    assert cube.min() >= 0.0
    assert np.min(sun) >= 0.0
    assert level_lux(cube) == pytest.approx(weather.diffuse_lux, rel=0.02, abs=1e-6)
    if elevation_deg > 0.0:
        assert weather.direct_lux >= 20.0 * direct


def test_a_year_with_such_hours_has_no_nan():
    """Near the equator, thin light at noon and light of the sun alone among common hours."""
    noon = np.arange(HOURS) % 24 == 12
    direct, diffuse = np.where(noon, 150.0, 0.0), np.where(noon, 50.0, 0.0)
    diffuse[np.flatnonzero(noon)[::3]] = 0.0
    year = SetWeather(
        path="thin.epw", name="thin", latitude_deg=0.0, longitude_deg=0.0, altitude_m=0.0,
        utc_offset_h=0.0, direct_normal_w_m2=tuple(direct), diffuse_horizontal_w_m2=tuple(diffuse),
        dew_point_c=(11.0,) * HOURS,
    )  # fmt: skip
    sun, sky = irradiance_of_year(year)
    assert np.isfinite(sun).all()
    assert np.isfinite(sky).all()
    thin = noon & (diffuse > 0.0)
    expected = 50.0 * all_weather(150.0, 50.0, np.radians(10.0), 80).diffuse_efficacy(1.97)
    assert LUMENS_PER_WATT * luminance(sky[thin]) == pytest.approx(expected, rel=0.25)
    assert sky[noon & (diffuse == 0.0)].max() == 0.0


def test_it_is_said_once(caplog):
    """The module says that a neighbour's shape serves: the first time, not for every hour."""
    kernel, faults = Kernel(), []
    kernel.add_module(WeatherSky)
    kernel.tap(lambda message, sender: faults.append(message) if isinstance(message, Fault) else 0)
    for kind in (SunMoved, BackgroundChanged, KeyLightChanged):
        kernel.inject(Demand(consumer="test", message=kind.__name__, size=16))
    kernel.inject(SetPlace(latitude_deg=9.0, longitude_deg=0.0))
    for name, value in (("direct_normal_w_m2", 150.0), ("diffuse_horizontal_w_m2", 50.0)):
        kernel.inject(SetSetting(module="weather_sky", name=name, value=value))
    with caplog.at_level(logging.WARNING):
        for minute in (10, 30, 50):
            kernel.inject(SetClock(instant=datetime(2026, 3, 20, 12, minute, tzinfo=UTC)))
            kernel.pump_until_idle()
    assert kernel.last(BackgroundChanged) is not None
    kernel.close()
    assert not faults
    assert [record.getMessage().count("Perez") for record in caplog.records] == [1]

"""The cloudless sky of a year of weather, found in its own hours."""

from datetime import UTC, datetime, timedelta

import msgspec
import numpy as np
import pytest
from clouds.module import Clouds
from weather_sky.clear_year import ClearYear, meinel
from weather_sky.module import WeatherSky

from vrut_lite.geometry.colour import luminance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, SetClock, SetSetting
from vrut_lite.messages.cloudiness import CloudinessChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.weather import SetWeather
from vrut_lite.sky.suns import suns_of_year
from vrut_lite.weather.weather_file import read_weather

HOURS = np.arange(8760)


@pytest.fixture(scope="module")
def weather(year_file):
    return read_weather(year_file)


def test_the_files_clear_hours_are_found(weather):
    """A sunny hour's light is the season's clear sky's, within 6 % in the mean and 15 % each.

    Suns above 15 degrees: the file's clear sky is pvlib's, by another formula than Meinel's.
    """
    year, suns = ClearYear(weather), suns_of_year(weather).apparent_elevation_rad
    sunny = np.flatnonzero((np.array(weather.cloud_cover) == 0.0) & (suns > np.radians(15.0)))
    assert sunny.size > 200
    shares = np.array([year.cloudiness(int(row), "test").global_share for row in sunny])
    assert abs(shares.mean() - 1.0) < 0.06
    assert np.abs(shares - 1.0).max() < 0.15


def test_dirtier_air_is_a_dimmer_clear_sky(weather):
    """The level is the file's own: half of the sun all year is a clear sky with half of the sun."""
    halved = msgspec.structs.replace(
        weather, direct_normal_w_m2=tuple(0.5 * np.array(weather.direct_normal_w_m2))
    )
    for row in (2_500, 4_400, 8_000):
        full, half = (ClearYear(some).irradiances(row, 0.5) for some in (weather, halved))
        assert half.direct_normal_w_m2 == pytest.approx(0.5 * full.direct_normal_w_m2, rel=1e-9)
        assert half.diffuse_horizontal_w_m2 == pytest.approx(full.diffuse_horizontal_w_m2)


def test_polar_nights_and_missing_cover(weather):
    """Without any sun the clear sky is Meinel's; without cover, Kasten and Czeplak tell it."""
    dark = SetWeather(
        path="n", name="n", latitude_deg=80.0, longitude_deg=0.0, altitude_m=0.0, utc_offset_h=0.0,
        direct_normal_w_m2=(0.0,) * 8760, diffuse_horizontal_w_m2=(0.0,) * 8760,
        dew_point_c=(0.0,) * 8760,
    )  # fmt: skip
    found = ClearYear(dark).irradiances(4_000, 0.4)
    np.testing.assert_allclose(found, meinel(0.4, 4_000 // 24 + 1))
    assert ClearYear(dark).cloudiness(0, "test") == CloudinessChanged(
        cover=0.0,
        global_share=None,
        direct_share=0.0,
        sun_elevation_rad=float(suns_of_year(dark).apparent_elevation_rad[0]),
        source="test",
    )
    unknown = ClearYear(msgspec.structs.replace(weather, cloud_cover=()))
    told = [unknown.cloudiness(row, "test") for row in range(4_380, 4_404)]
    for hour in (hour for hour in told if hour.global_share is not None):
        left = 1.0 - 0.75 * hour.cover**3.4
        assert left == pytest.approx(np.clip(hour.global_share, 0.25, 1.0))


@pytest.fixture
def kernel(weather):
    """Prague under the file's weather; clouds that follow it when they are asked for."""
    kernel = Kernel()
    kernel.add_module(WeatherSky)
    kernel.add_module(Clouds)
    for kind in ("SunMoved", "KeyLightChanged", "CloudsChanged"):
        kernel.inject(Demand(consumer="test", message=kind))
    kernel.inject(SetPlace(latitude_deg=50.1, longitude_deg=14.4, altitude_m=200.0))
    kernel.inject(weather)
    kernel.pump_until_idle()
    yield kernel
    kernel.close()


def overcast_noon(weather):
    """Row and instant of an overcast noon in spring."""
    cover = np.array(weather.cloud_cover)
    row = int(np.flatnonzero((HOURS % 24 == 12) & (cover == 1.0) & (HOURS > 2_500))[0])
    start = datetime(2023, 1, 1, tzinfo=UTC)
    return row, start + timedelta(hours=row + 0.3 - weather.utc_offset_h)


def test_behind_clouds_the_sky_is_clear(kernel, weather):
    """The sun of an overcast hour is faint; where clouds are shown they hide a clear sky's sun.

    The light of such an hour has its clouds in it already: they would count twice.
    """
    row, noon = overcast_noon(weather)
    kernel.inject(SetClock(instant=noon))
    kernel.pump_until_idle()
    faint = float(luminance(kernel.last(KeyLightChanged).irradiance_rgb))
    kernel.inject(SetSetting(module="clouds", name="follow_weather", value=True))
    kernel.pump_until_idle()
    sun = kernel.last(SunMoved).apparent_elevation_rad
    clear = ClearYear(weather).irradiances(row, sun).direct_normal_w_m2
    key_light = kernel.last(KeyLightChanged)
    bright = 683.0 * float(luminance(key_light.irradiance_rgb))
    assert 683.0 * faint < 0.2 * bright
    assert bright == pytest.approx(105.0 * float(clear), rel=0.12), "about 105 lm/W"
    assert key_light.haze, "clouds aloft have less of it before them"
    kernel.inject(SetSetting(module="clouds", name="follow_weather", value=False))
    kernel.pump_until_idle()
    assert float(luminance(kernel.last(KeyLightChanged).irradiance_rgb)) == pytest.approx(faint)


def test_cloudiness_is_told_once_an_hour(kernel, weather):
    """Minutes of one hour have one cloudiness; the next hour tells its own, whoever is the sky."""
    heard = []
    kernel.tap(lambda said, _: heard.append(said) if type(said) is CloudinessChanged else None)
    _, noon = overcast_noon(weather)
    for minutes in (0, 5, 20, 60):
        kernel.inject(SetClock(instant=noon + timedelta(minutes=minutes)))
        kernel.pump_until_idle()
    assert len(heard) == 2

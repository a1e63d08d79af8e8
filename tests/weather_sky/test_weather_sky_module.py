"""The module on a real kernel: the hours of a weather file.

The contract of every sky is kept in tests/test_sky_contract.py.
"""

from datetime import UTC, datetime

import numpy as np
import pytest
from dynamic_skylight import sun_position
from weather_sky.conditions import Conditions
from weather_sky.module import WeatherSky
from weather_sky.perez import all_weather, precipitable_water_cm

from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, SetClock, SetSetting
from vrut_lite.message_codec import decode, to_plain
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.weather import SetWeather
from vrut_lite.weather.weather_file import read_weather


@pytest.fixture
def kernel():
    kernel = Kernel()
    kernel.add_module(WeatherSky)
    for kind in (SunMoved, BackgroundChanged, KeyLightChanged):
        kernel.inject(Demand(consumer="test", message=kind.__name__, size=64))
    kernel.inject(SetPlace(latitude_deg=50.1, longitude_deg=14.4, altitude_m=200.0))
    yield kernel
    kernel.close()


def at(kernel, *inputs):
    for message in inputs:
        kernel.inject(message)
        kernel.pump_until_idle()
    return kernel.last(SunMoved), kernel.last(KeyLightChanged), kernel.last(BackgroundChanged)


def lux_of_sky(background):
    cube = decode_float16(background.cube.values, background.radiance_scale).astype(float)
    return 683.0 * float(luminance(horizontal_irradiance(cube)))


def test_the_hours_illuminances_are_met(kernel, year_file):
    """Sun and sky of each sunlit hour of two days, by all kinds of sky: 0.5 % of what Perez says.

    EPW's watts are those of all wavelengths: his efficacies make them light, nothing else does.
    """
    weather = read_weather(year_file)
    at(kernel, weather)
    for day in (datetime(2026, 3, 3, tzinfo=UTC), datetime(2026, 6, 24, tzinfo=UTC)):
        for hour in range(5, 18, 3):
            when = day.replace(hour=hour, minute=12)
            sun, key, background = at(kernel, SetClock(instant=when))
            measured = weather.hour_at(when)
            if measured.diffuse_horizontal_w_m2 == 0.0 or sun.visible_disc_fraction == 0.0:
                continue
            state = all_weather(
                measured.direct_normal_w_m2,
                measured.diffuse_horizontal_w_m2,
                np.pi / 2 - sun.apparent_elevation_rad,
                when.timetuple().tm_yday,
            )
            water = precipitable_water_cm(measured.dew_point_c)
            direct = measured.direct_normal_w_m2 * state.direct_efficacy(water)
            diffuse = measured.diffuse_horizontal_w_m2 * state.diffuse_efficacy(water)
            assert 683.0 * luminance(key.irradiance_rgb) == pytest.approx(direct, rel=5e-3)
            assert lux_of_sky(background) == pytest.approx(diffuse, rel=5e-3)


@pytest.mark.parametrize("kind", ["cie-1", "cie-6", "cie-12", "cie-15", "cie-overcast"])
def test_general_skies_meet_what_is_asked(kernel, kind):
    """The form is CIE's, the amount is the settings'."""
    for name, value in (("distribution", kind), ("diffuse_horizontal_w_m2", 150.0)):
        at(kernel, SetSetting(module="weather_sky", name=name, value=value))
    when = datetime(2026, 6, 24, 9, tzinfo=UTC)
    sun, _, background = at(kernel, SetClock(instant=when))
    zenith = np.pi / 2 - sun.apparent_elevation_rad
    direct = Conditions(
        kind, None, 150.0, 11.0, 175, sun.apparent_elevation_rad, 1.0
    ).irradiances_w_m2[0]
    efficacy = all_weather(direct, 150.0, zenith, 175).diffuse_efficacy(precipitable_water_cm(11.0))
    assert lux_of_sky(background) == pytest.approx(150.0 * efficacy, rel=5e-3)


def test_the_sun_is_that_of_the_middle_of_the_hour(kernel, year_file):
    """Standard time, whatever the clock says within the hour; the place's own ephemeris agrees."""
    at(kernel, read_weather(year_file))
    middle = datetime(2026, 6, 24, 9, 30, tzinfo=UTC)
    seen = {at(kernel, SetClock(instant=middle.replace(minute=m)))[0] for m in (0, 17, 59)}
    assert len(seen) == 1
    exact = sun_position(middle, 50.1, 14.4, altitude_m=200.0)
    assert seen.pop().apparent_elevation_rad == pytest.approx(
        exact.apparent_elevation_rad, abs=np.radians(0.03)
    )


def test_at_sunrise_the_sun_is_that_of_the_sunlit_part(kernel, year_file):
    """Else half of all first hours would have direct light from below the horizon."""
    at(kernel, read_weather(year_file))
    # The sun rises at 03:50 UTC: of the hour from 3 to 4 the last ten minutes are sunlit.
    sun, _, _ = at(kernel, SetClock(instant=datetime(2026, 5, 4, 3, 10, tzinfo=UTC)))
    rise = next(
        minute
        for minute in range(60)
        if sun_position(
            datetime(2026, 5, 4, 3, minute, tzinfo=UTC), 50.1, 14.4, altitude_m=200.0
        ).apparent_elevation_rad
        > 0.0
    )
    exact = sun_position(
        datetime(2026, 5, 4, 3, (rise + 60) // 2, tzinfo=UTC), 50.1, 14.4, altitude_m=200.0
    )
    assert sun.apparent_elevation_rad > 0.0
    assert sun.apparent_elevation_rad == pytest.approx(
        exact.apparent_elevation_rad, abs=np.radians(0.1)
    )


def test_night_has_twilights_constant(kernel, year_file):
    """An hour deep in the night: no sun, an even sky of 0.65 millilux, until a night sky has it."""
    at(kernel, read_weather(year_file))
    _, key, background = at(kernel, SetClock(instant=datetime(2026, 1, 10, 0, 30, tzinfo=UTC)))
    assert key.irradiance_rgb == (0.0, 0.0, 0.0)
    assert lux_of_sky(background) == pytest.approx(6.5e-4, rel=0.05)


def test_a_journal_brings_the_weather_back(year_file):
    """The year itself is recorded, not a file's name."""
    weather = read_weather(year_file)
    assert decode(SetWeather, to_plain(weather), lambda handle: None) == weather

"""Sums over months and ranges, and radiation beside that of the weather file by pvlib's sun."""

import csv

import numpy as np
import pandas as pd
import pvlib
import pytest
from boxes import floor
from daylight_numbers.year.totals import (
    parse_totals,
    radiant_light,
    sums,
    totals_of,
    totals_table,
    write_totals,
)
from daylight_numbers.year.year import annual
from daylight_numbers.year.year_light import YearLight
from light_transport.rays.sky_nodes import GROUND_NODE
from standards_scenes import weather, work_in

from vrut_lite.geometry.frames import world_from_enu


def test_months_are_those_of_the_calendar_and_sum_to_the_year():
    months = parse_totals("month")
    hours = np.arange(8760)
    of_months = sums(np.ones((2, 8760), np.float32), hours, months)
    days = [31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31]
    np.testing.assert_array_equal(of_months, 24.0 * np.array([days, days]))
    (summer,) = parse_totals("04-01..09-30")
    assert sums(np.ones((1, 8760), np.float32), hours, [summer]) == 24 * 183
    (day,) = parse_totals("01-01..01-01")
    assert (day.first, day.end, day.name) == (0, 24, "1 January to 1 January")


@pytest.fixture(scope="module")
def sunny_year():
    """A year with 500 W m^-2 of direct and 100 of diffuse irradiance while the sun is up, whose
    light has other ratios of lumens to watts each hour."""
    times = pd.date_range("2025-01-01T00:30", periods=8760, freq="h", tz="UTC")
    sun = pvlib.solarposition.get_solarposition(times, 51.5, 0.0)
    height, azimuth = (
        np.radians(sun[name].to_numpy()) for name in ("apparent_elevation", "azimuth")
    )
    up = np.flatnonzero(height > np.radians(2.0))[::7]
    level = np.cos(height[up])
    towards = np.stack(
        [level * np.sin(azimuth[up]), level * np.cos(azimuth[up]), np.sin(height[up])], axis=1
    )
    random = np.random.Generator(np.random.Philox(key=5))
    sky = np.ones((len(up), GROUND_NODE + 1, 3), np.float32)
    sky *= random.uniform(1.0, 30.0, (len(up), 1, 1)).astype(np.float32)
    power = np.repeat(random.uniform(20.0, 200.0, (len(up), 1)), 3, axis=1)
    light = YearLight(up, sky, world_from_enu(towards, 0.0), power, np.zeros(3), "test")
    return light, height[up]


def test_radiation_on_open_ground_is_the_weather_file_s(sunny_year):
    """100 W m^-2 of the sky and 500 times the sine of pvlib's sun, whatever the light's lumens; on
    a plane that faces up, over black ground."""
    light, height = sunny_year
    work = work_in(floor(-5, 5, -5, 5, -1.0), places=[[0.0, 0.5, 0.0]])
    radiant = annual(work, radiant_light(light, weather()))
    truth = 100.0 + 500.0 * np.sin(height)
    np.testing.assert_allclose(radiant.total[0], truth, rtol=0.01)
    months = parse_totals("month")
    found = totals_of(annual(work, light), radiant, light.hour, months)
    month = pd.to_datetime(light.hour, unit="h", origin="2025-01-01").month.to_numpy()
    by_month = [truth[month == n].sum() / 1000.0 for n in range(1, 13)]
    np.testing.assert_allclose(found.radiation_kwh_m2[0], by_month, rtol=0.01)
    year = annual(work, light)
    np.testing.assert_allclose(found.dose_klxh.sum(), year.total.sum() / 1000.0, rtol=1e-5)
    np.testing.assert_allclose(found.sun_klxh.sum(), year.sun.sum() / 1000.0, rtol=1e-5)


def test_totals_are_written_with_a_row_for_each_sensor_and_period(tmp_path, sunny_year):
    light, _ = sunny_year
    work = work_in(floor(-5, 5, -5, 5, -1.0), places=[[0.0, 0.5, 0.0], [1.0, 0.5, 0.0]])
    year, months = annual(work, light), parse_totals("month")
    found = totals_of(year, None, light.hour, months)
    write_totals(tmp_path / "totals.csv", work.sensors, found, months)
    rows = list(csv.DictReader((tmp_path / "totals.csv").open()))
    assert len(rows) == 24
    assert rows[13]["period"] == "February"
    assert float(rows[13]["dose_klxh"]) == pytest.approx(found.dose_klxh[1, 1], rel=1e-5)
    assert "radiation_kwh_m2" not in rows[0]
    table = totals_table(work.sensors, found, months)
    assert table.columns == ["plane", "dose klx h", "of direct sun klx h"]
    assert table.rows[1][0] == "room, February"


def test_years_of_weather_with_a_leap_day_keep_their_days(sunny_year):
    """The 1st of March has the hours after the 29th of February."""
    light, _ = sunny_year
    leap = weather()
    direct = np.repeat(np.arange(366.0), 24)
    leap = type(leap)(
        **{name: getattr(leap, name) for name in leap.__struct_fields__
           if not name.endswith(("_w_m2", "_c"))},
        direct_normal_w_m2=tuple(direct), diffuse_horizontal_w_m2=(100.0,) * 8784,
        dew_point_c=(10.0,) * 8784,
    )  # fmt: skip
    found = radiant_light(light, leap)
    day = light.hour // 24
    expected = day + (day >= 59)
    lux = light.sun_irradiance_rgb[:, 0]
    ratio = found.sun_irradiance_rgb[:, 0] / lux
    of_lux = ratio * (lux * 683.0)
    np.testing.assert_allclose(of_lux, expected, rtol=0.01, atol=1e-9)

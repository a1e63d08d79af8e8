"""A year at sensors: sums of what single hours have, and metrics of known light."""

import daylight_numbers
import light_transport
import numpy as np
import pytest
from boxes import box, floor, hour, quads
from daylight_numbers.glazing.glass import no_glass
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import Sensors, free_sensors
from daylight_numbers.now import hour_at_sensors, numbers_now
from daylight_numbers.pictures import PictureQuantity, drawn_grid, heat_map, plan_picture
from daylight_numbers.report import ReportPage, Table, write_report
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.metrics import (
    OCCUPIED_H,
    by_day_and_hour,
    point_year,
    room_year,
)
from daylight_numbers.year.year import Year, solved_year, year_matrices, year_of
from daylight_numbers.year.year_light import HOURS, YearLight, lit_hours
from light_transport.giving_up import unless
from light_transport.rays.sky_nodes import GROUND_NODE
from light_transport.transport import SceneTransport
from light_years import year_like

from vrut_lite.errors import GivenUp
from vrut_lite.geometry.false_colours import scale_of
from vrut_lite.messages.place import SetPlace
from vrut_lite.pictures.image_files import write_png


@pytest.fixture(scope="module")
def work():
    """A floor with a box on it, and sensors around it."""
    surfaces, layout = quads(floor(-3, 3, -3, 3), *box((-1, 0, -1), (0, 1.5, 0)))
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(128)
    places = [[1.0, 0.5, 0.0], [-2.0, 0.5, 1.0]]
    sensors = free_sensors(places, [[0, 1.0, 0], [1.0, 0, 0]], "yard")
    glass = no_glass(len(surfaces.part))
    return DaylightWork(transport, glass, sensors, operator_of(transport, glass, sensors, 0.02))


def test_hours_of_a_year_have_the_light_of_single_hours(work):
    """Suns are solved for the very hours here, so that only the cells of the sky are coarser."""
    lights = [
        hour(0.5, key=(1.0, 1.0, 0.3), irradiance=4.0, ground=0.1),
        hour(1.0, key=(-0.4, 0.5, 0.2), irradiance=2.0, ground=0.3),
    ]
    light = year_like([12, 37], lights)
    year = year_of(year_matrices(work, light, solved_year(work.transport, light)), light)
    for n, of_hour in enumerate(lights):
        single = hour_at_sensors(work.transport, work.glass, work.operator, work.sensors, of_hour)
        np.testing.assert_allclose(year.sun[:, n], single.sun, rtol=1e-5)
        # Shadows of single hours are those of directions 1.5 degrees apart.
        np.testing.assert_allclose(year.total[:, n], single.total, rtol=0.02)


def test_a_sun_between_two_solved_days_is_their_mean(work):
    """At the same hour of days 0, 4 and 9; those of 0 and 9 are solved, 9 as the last."""
    light = hour(0.0, key=(1.0, 1.0, 0.3), irradiance=4.0)
    days = np.array([0, 4, 9])
    year_light = year_like(days * HOURS + 12, [light] * 3)
    matrices = year_matrices(work, year_light, solved_year(work.transport, year_light))
    assert matrices.suns[0].shape[2] == 2
    np.testing.assert_allclose(matrices.share[1], [5 / 9, 4 / 9])
    total = year_of(matrices, year_light).total
    np.testing.assert_allclose(total, total[:, :1].repeat(3, axis=1), rtol=1e-5)


def known_year(lux, sun):
    """Every hour from 8 to 18 has the same lux (P,), 300 of them have sun (P,)."""
    hours = np.array([day * HOURS + clock for day in range(365) for clock in range(8, 18)])
    sky = np.ones((len(hours), GROUND_NODE + 1, 3), np.float32)
    nothing = np.zeros((len(hours), 3))
    light = YearLight(hours, sky, nothing, nothing, np.zeros(3), "test")
    total = np.repeat(np.float32(lux)[:, None], len(hours), axis=1)
    direct = np.zeros_like(total)
    direct[:, :300] = np.float32(sun)[:, None]
    return Year(total, direct, (total, total)), light


def test_metrics_of_known_light():
    year, light = known_year([50.0, 350.0, 800.0, 4000.0], [0.0, 0.0, 999.0, 2000.0])
    assert len(light.hour) == OCCUPIED_H
    points = point_year(year.total, year, light)
    sensors = free_sensors(np.zeros((4, 3)), np.tile([0, 1.0, 0], (4, 1)), "room")
    room = room_year(points, sensors, 0)
    assert room.da_300_50 == 0.75
    assert room.ase_1000_250 == 0.25
    np.testing.assert_allclose(room.udi, [0.25, 0.0, 0.5, 0.25])
    assert (room.en_median_lx, room.en_low_lx) == (800.0, 50.0)
    assert room.en_level == "none"
    np.testing.assert_allclose(points.dose_klxh, np.array([50, 350, 800, 4000]) * 3.65)
    brighter = point_year(year.total + 300.0, year, light)
    assert room_year(brighter, sensors, 0).en_level == "medium"


def test_hours_with_light_are_half_of_the_year_and_some_twilight():
    prague = SetPlace(latitude_deg=50.1, longitude_deg=14.4, altitude_m=200.0)
    hours = lit_hours(prague, 1)
    assert 4380 < len(hours) < 4900
    assert {12, 172 * HOURS + 4, 172 * HOURS + 19} < set(hours.tolist())
    assert not {0, 172 * HOURS + 23} & set(hours.tolist())


def test_pictures_have_their_values_where_they_are():
    """Bright points are brighter; what lies in no grid is left out."""
    cell = np.array([[0, 0], [0, 1], [1, 0], [1, 1], [-1, -1]])
    nothing = np.zeros((5, 3))
    sensors = Sensors(nothing, nothing, np.zeros(5, int), cell, np.ones(5, bool), ("room",), (0.5,))
    values = np.array([1.0, 1.0, 100.0, 100.0, 1e9])
    pixels = plan_picture(sensors, values, PictureQuantity("illuminance", "lx")).astype(int)
    upper, lower = pixels[50:60, 20:60].mean(), pixels[140:150, 20:60].mean()
    assert lower > upper
    day = by_day_and_hour(np.array([5.0, 500.0]), np.array([12, 364 * HOURS + 12]))
    assert (day[12, 0], day[12, 364], np.count_nonzero(day)) == (5.0, 500.0, 2)
    assert heat_map(day, "room", PictureQuantity("illuminance", "lx")).ndim == 3


def test_an_even_room_has_no_lines_where_its_value_is_a_level():
    """Three hours of sun everywhere but along one wall: lines along that wall alone."""
    grid = np.full((9, 9), 3.0)
    grid[:2] = np.linspace(1.0, 20.0, 9)
    lines = (drawn_grid(grid, scale_of(grid)) == 250).all(axis=-1)
    assert lines.any()
    assert not lines[len(lines) // 2 :].any()


def test_roof_lights_must_bring_the_target_to_nearly_all_of_the_plane():
    """EN 17037, table A.2: half of the plane at 800 lx is enough for windows, not for roofs."""
    year, light = known_year([350.0, 800.0, 800.0, 800.0], [0.0] * 4)
    points = point_year(year.total, year, light)
    sensors = free_sensors(np.zeros((4, 3)), np.tile([0, 1.0, 0], (4, 1)), "room")
    assert room_year(points, sensors, 0).en_level == "medium"
    assert room_year(points, sensors, 0, is_lit_by_roof=True).en_level == "minimum"


def test_numbers_of_an_hour_end_when_nobody_waits(work):
    """They are those of their parts, and are given up between steps."""
    light = hour(0.5, key=(1.0, 1.0, 0.3), irradiance=4.0, ground=0.1)
    found = numbers_now(work, light)
    single = hour_at_sensors(work.transport, work.glass, work.operator, work.sensors, light)
    np.testing.assert_array_equal(found.light.total, single.total)
    assert ((found.daylight_factor_percent > 0.0) & (found.sky_view > 0.0)).all()
    with pytest.raises(GivenUp):
        numbers_now(work, light, go_on=unless(lambda: True))


def test_a_page_has_wide_pictures_in_rows_of_their_own(tmp_path):
    """Heat maps are twice as wide as plans; tables wider than a phone scroll."""
    for name, width in (("plan", 10), ("hours", 30)):
        write_png(tmp_path / f"{name}.png", np.zeros((10, width, 3), np.uint8))
    pictures = {tmp_path / "plan.png": "a plan", tmp_path / "hours.png": "a < b"}
    write_report(
        tmp_path / "page.html",
        ReportPage("room", "", [Table("year", ["a"], [["1"]])], pictures, []),
    )
    page = (tmp_path / "page.html").read_text()
    assert page.count("class='plan'") == page.count("class='wide'") == 1
    assert "a &lt; b" in page
    assert "<div class='table'><table>" in page


def test_scripts_of_earlier_versions_find_their_names():
    """Light transport was the home of daylight numbers: `from light_transport import annual`."""
    for name in ("annual", "daylight_factor", "numbers_now", "work_of"):
        with pytest.warns(DeprecationWarning, match=f"1.0: use daylight_numbers.{name}"):
            old = getattr(light_transport, name)
        assert old is getattr(daylight_numbers, name)

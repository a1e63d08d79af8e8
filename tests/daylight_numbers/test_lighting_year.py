"""A year of lamps: energy, hours in the dark, zones and shares of time, against sums by hand."""

import csv
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from daylight_numbers.command import daylight
from daylight_numbers.lamps.lamp_light import LampsAtSensors
from daylight_numbers.lamps.lamp_places import PlacedLuminaires
from daylight_numbers.lamps.lighting import Lighting
from daylight_numbers.lamps.lighting_year import lighting_year, lit_areas_m2
from daylight_numbers.matrix.sensors import Sensors
from luminaire_files import panel_ies, spot_ldt

from vrut_lite.errors import UserError
from vrut_lite.messages.lighting import LightingControl
from vrut_lite.project import load_project
from vrut_lite.scene.luminaire_file import read_luminaire

ROOM = Path(__file__).parents[2] / "scenes" / "work" / "indoor.glb"
BRIGHT = np.array([day * 24 + clock for day in range(365) for clock in range(10, 14)])


def lighting(*controls, lux=((500.0, 50.0), (50.0, 500.0), (0.0, 400.0))):
    """Three sensors under two groups of 100 W and 50 W."""
    panel = read_luminaire(panel_ies().encode())
    lamps = PlacedLuminaires(
        (panel,), np.zeros(2, int), np.zeros((2, 3)), np.repeat(np.eye(3)[None], 2, axis=0),
        np.ones(2), np.array([100.0, 50.0]), np.arange(2), ("one", "two"),
    )  # fmt: skip
    light = np.array(lux)
    return Lighting(lamps, LampsAtSensors(light, 0.0 * light, 0.0 * light), controls)


def year_of(subject, day_lx=(600.0, 600.0, 600.0), photosensor_lx=0.0):
    daylight_lx = np.repeat(np.float32(day_lx)[:, None], len(BRIGHT), axis=1)
    return lighting_year(
        subject, daylight_lx, BRIGHT, lambda _: np.full(len(BRIGHT), photosensor_lx)
    )


def test_zones_are_where_a_group_is_the_brightest():
    """A group that others outshine everywhere keeps its brightest sensor."""
    every = LightingControl()
    assert lighting(every, every).zones.tolist() == [[True, False, False], [False, True, True]]
    outshone = lighting(every, every, lux=((500.0, 50.0), (400.0, 60.0), (300.0, 0.0)))
    assert outshone.zones.tolist() == [[True, True, True], [False, True, False]]


def test_dark_groups_and_unknown_power_are_told():
    """A lamp in a wall lights nothing; energy needs watts."""
    every = LightingControl()
    assert lighting(every, every).warnings() == []
    subject = lighting(every, every, lux=((500.0, 1e-4), (50.0, 0.0), (20.0, 0.0)))
    subject.lamps.watts[0] = 0.0
    assert [said.split(":")[0] for said in subject.warnings()] == [
        "the lamps of 'two' light no sensor",
        "the lamps of 'one' have no power in their files",
    ]


def test_lamps_shine_in_hours_without_daylight():
    """On from 18 to 2 h all days: 8 h of 100 W, and standby of 2 W in the other 16, though none of
    these hours has daylight."""
    evening = LightingControl(occupied_h=(18.0, 2.0), standby_w=2.0, target_lx=300.0)
    year = year_of(lighting(evening, LightingControl()))
    assert year.light_kwh[0].sum() == pytest.approx(0.1 * 8 * 365)
    assert year.standby_kwh[0].sum() == pytest.approx(0.002 * 16 * 365)
    assert year.light_kwh[0, 1] == pytest.approx(0.1 * 8 * 28)
    assert year.met[0] == 1.0
    assert year.met_alone[0] == 0.0


def test_a_closed_loop_fills_what_other_groups_leave():
    """Group one is always on: it brings 40 of 50 lx to a zone of 360 by group two, 400 wanted."""
    steady = LightingControl(maintenance_factor=0.8)
    loop = LightingControl(
        "closed_loop", 200.0, maintenance_factor=0.8, min_dimming=0.1, min_power=0.1
    )
    year = year_of(lighting(steady, loop))
    dark, bright = 17, 12
    by_one, by_two = 0.8 * 25.0, 0.8 * 450.0
    assert year.output[1, dark] == pytest.approx((200.0 - by_one) / by_two)
    assert year.output[1, bright] == 0.0
    assert year.total_lx[1, dark] == pytest.approx(200.0)
    assert year.light_kwh[1].sum() == pytest.approx(0.05 * 365 * 6 * year.output[1, dark])
    # Its two sensors have 40 + 200 and 160 lx in the dark: one has the target.
    np.testing.assert_allclose(year.met_at_sensors, [0.4, 1.0, 0.4])
    assert year.met[1] == 1.0


def test_on_off_and_open_loop_by_hours():
    """From 8 to 18 h, daylight of four of these hours: off but for the delay and the minutes until
    the straight line between hours' middles reaches the target; least power by the photosensor."""
    switched = LightingControl("on_off", 300.0, delay_min=20)
    dimmed = LightingControl("open_loop", dark_at_lx=1000.0, min_dimming=0.1, min_power=0.2)
    year = year_of(lighting(switched, dimmed), photosensor_lx=500.0)
    # 600 lx from 10:30 to 13:30: 300 lx at 10:00 and 14:00; off at 10:20.
    assert year.light_kwh[0].sum() == pytest.approx(365 * 0.1 * (2 + 20 / 60 + 4))
    share = 0.2 + 0.8 / 0.9 * (0.55 - 0.1)
    assert year.light_kwh[1].sum() == pytest.approx(365 * 0.05 * (6 + 4 * share))


def test_area_of_zones_is_that_of_their_cells():
    every = LightingControl()
    sensors = Sensors(
        np.zeros((3, 3)), np.zeros((3, 3)), np.zeros(3, int), np.zeros((3, 2), int),
        np.ones(3, bool), ("room",), (0.5,),
    )  # fmt: skip
    of_groups, area = lit_areas_m2(lighting(every, every), sensors)
    np.testing.assert_allclose([*of_groups, area], [0.25, 0.5, 0.75])
    # A sensor in two zones is one cell.
    outshone = lighting(every, every, lux=((500.0, 50.0), (400.0, 60.0), (300.0, 0.0)))
    of_groups, area = lit_areas_m2(outshone, sensors)
    np.testing.assert_allclose([*of_groups, area], [0.75, 0.25, 0.75])


def project(folder, tables):
    (folder / "panel.ies").write_text(panel_ies())
    (folder / "spot.ldt").write_text(spot_ldt())
    path = folder / "room.toml"
    path.write_text(f'scene = "{ROOM.as_posix()}"\nat = "2026-03-21T12:00"\n{tables}')
    return path


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ('[lamp.a]\nfile = "panel.ies"\n', "a lamp with a file needs places in at"),
        ('[lamp.a]\nfile = "panel.ies"\nat = [1, 2]\n', r"at is not \[x, y, z\]"),
        ('[lamp.a]\nfile = "panel.ies"\nat = [1, 2, 3]\naim = [0, 0, 0]\n', "aim is"),
        ('[lighting.a]\ncontrol = "open_loop"\n', "open_loop needs dark_at_lx"),
        ("[lighting.a]\noccupied_h = [8, 8]\n", "occupied_h begins and ends at one hour"),
        ('[lighting.a]\ncontrol = "dali"\n', "invalid enum value 'dali'"),
    ],
)
def test_a_bad_table_of_a_project_is_refused(tmp_path, tables, said):
    with pytest.raises(UserError, match=said):
        load_project(project(tmp_path, tables))


def test_a_missing_luminaire_is_refused_before_a_scene_is_opened(tmp_path):
    (tmp_path / "lamps.csv").write_text("none.ies,1,2,3\n")
    asked = ["none.glb", "-o", str(tmp_path), "--lamps", str(tmp_path / "lamps.csv")]
    with pytest.raises(UserError, match=r"cannot read the luminaire .*none\.ies"):
        CliRunner().invoke(daylight, asked, catch_exceptions=False)


def test_controls_without_lamps_are_refused(tmp_path):
    asked = [str(project(tmp_path, "[lighting.row]\n")), "-o", str(tmp_path / "out")]
    with pytest.raises(UserError, match="but no lamps: add"):
        CliRunner().invoke(daylight, asked, catch_exceptions=False)


@pytest.mark.long
def test_a_year_of_lamps_has_its_files(tmp_path):
    """Through the real kernel: tables, columns and hours agree."""
    path = project(
        tmp_path,
        '[lamp.panels]\nfile = "panel.ies"\nat = [[-1, 2.4, -1], [1, 2.4, 1]]\ngroup = "ceiling"\n'
        '[lamp.spot]\nfile = "spot.ldt"\nat = [0, 2.4, 0]\n'
        '[lighting.ceiling]\ncontrol = "closed_loop"\ntarget_lx = 250\n'
        '[lighting.spot]\ncontrol = "open_loop"\ndark_at_lx = 2000\n'
        "photosensor = [0, 2.3, 0, 0, -1, 0]\n",
    )
    out = tmp_path / "out"
    asked = [str(path), "-o", str(out), "--grid", "1", "--year"]
    found = CliRunner().invoke(daylight, asked, catch_exceptions=False)
    assert found.exit_code == 0
    arrays = np.load(out / "sensors.npz")
    assert np.all(arrays["of_lamps_lx"] > 50.0)
    np.testing.assert_allclose(arrays["of_lamps_maintained_lx"], 0.8 * arrays["of_lamps_lx"])
    rows = list(csv.DictReader((out / "lighting_hours.csv").open()))
    assert len(rows) == 8760
    kwh = sum(float(row["ceiling: W"]) for row in rows) / 1000.0
    assert f"kWh of light + standby {kwh:,.1f} + 0.0" in found.output
    page = (out / "report.html").read_text()
    assert "LENI (EN 15193-1)" in page
    assert "Power of all lamps" in page

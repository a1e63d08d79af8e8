"""Solstices, the compass, and kept views."""

import math

import numpy as np
import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QImage, QPainter
from window_driver import SCENES

from vrut_lite.app.view.compass import Compass
from vrut_lite.app.view.solstices import SOLSTICES, sun_circle
from vrut_lite.geometry.frames import enu_from_world
from vrut_lite.kernel.messages import SettingChanged
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.project import CameraView, load_project

PRAGUE = SetPlace(latitude_deg=50.0755, longitude_deg=14.4378)


@pytest.mark.parametrize(("name", "month"), [("June", 6), ("December", 12)])
def test_the_solstices_are_those_of_the_almanac(name, month):
    """The ephemeris's own sun on the 21st, at any hour, lies on the arc: within half a degree."""
    from datetime import UTC, datetime

    from dynamic_skylight import sun_position

    arc = sun_circle(PRAGUE, SOLSTICES[name])
    for hour in (7, 10, 13):
        sun = sun_position(
            datetime(2026, month, 21, hour, tzinfo=UTC),
            PRAGUE.latitude_deg,
            PRAGUE.longitude_deg,
        )
        flat = math.cos(sun.elevation_rad)
        direction = np.array(
            [flat * math.sin(sun.azimuth_rad), flat * math.cos(sun.azimuth_rad),
             math.sin(sun.elevation_rad)]
        )  # fmt: skip
        nearest = np.max(enu_from_world(arc, 0.0) @ direction)
        # Points of the arc are 2.5 degrees apart.
        assert math.degrees(math.acos(min(1.0, nearest))) < 1.3


def test_the_arcs_turn_with_the_scenes_north():
    """East of the place is where the scene's offset puts it."""
    turned = SetPlace(latitude_deg=50.0, longitude_deg=14.0, north_offset_rad=0.5)
    straight = SetPlace(latitude_deg=50.0, longitude_deg=14.0)
    tilt = SOLSTICES["June"]
    assert np.allclose(
        enu_from_world(sun_circle(turned, tilt), 0.5), enu_from_world(sun_circle(straight, tilt), 0)
    )


def test_the_compass_knows_where_one_looks(qapp):
    """To -Z is north, +X east; with a north offset of 90 degrees -Z is east."""
    compass = Compass()
    north = MoveCamera(eye_m=(0.0, 1.7, 0.0), target_m=(0.0, 1.7, -1.0))
    east = MoveCamera(eye_m=(0.0, 1.7, 0.0), target_m=(1.0, 1.7, 0.0))
    assert compass.azimuth_rad(north) == pytest.approx(0.0)
    assert compass.azimuth_rad(east) == pytest.approx(math.pi / 2)
    compass.set_place(SetPlace(latitude_deg=50.0, longitude_deg=14.0, north_offset_rad=math.pi / 2))
    assert compass.azimuth_rad(north) == pytest.approx(math.pi / 2)


def test_the_compass_marks_the_horizon(qapp):
    """Ticks in the middle row of a level view, and nothing while it is off."""
    compass, image = Compass(), QImage(300, 200, QImage.Format.Format_RGB888)
    north = MoveCamera(eye_m=(0.0, 1.7, 0.0), target_m=(0.0, 1.7, -1.0))

    def painted():
        image.fill(QColor("black"))
        painter = QPainter(image)
        compass.paint(painter, QRectF(0, 0, 300, 200), north)
        painter.end()
        return [image.pixelColor(x, 100).lightness() for x in range(300)]

    assert max(painted()) == 0
    compass.show(True)
    row = painted()
    assert row[150] > 200
    # The next tick is 15 degrees on: of the field of view, tan(15) / tan(half of it).
    assert sum(level > 150 for level in row) >= 3


def test_views_are_kept_gone_to_saved_and_forgotten(shared_headless_window, tmp_path):
    """Views are kept by name in the project's file; each project has its own."""
    driver = shared_headless_window
    views, menu = driver.window.files.views, driver.window.menus.views
    assert [action.text() for action in menu.actions()] == ["none is kept"]
    view = CameraView(eye_m=(3.0, 2.0, 1.0), target_m=(0.0, 1.0, 0.0))
    views.keep(views.next_name, view)
    assert views.next_name == "View 2"
    assert menu.actions()[0].shortcut().toString() == "Ctrl+1"
    menu.actions()[0].trigger()
    driver.until_heard(MoveCamera, lambda m: np.allclose(m.eye_m, view.eye_m))
    file = tmp_path / "views.toml"
    driver.window.files.save(str(file))
    assert load_project(file).views["View 1"].eye_m == view.eye_m
    driver.window.files.open_path(str(SCENES / "sundial.toml"))
    assert views.kept == {}
    driver.window.files.open_path(str(file))
    assert list(views.kept) == ["View 1"]
    driver.until_heard(SceneOpened)
    views.forget("View 1")
    assert views.kept == {}


def test_a_key_cuts_the_scene_and_makes_it_whole_again(shared_headless_window, qtbot):
    """Through its middle at first; undo and the scene's panel know of it, a project keeps it."""
    driver = shared_headless_window
    action, panel = driver.window.actions_by_name["section"], driver.panel("module scene")
    action.trigger()
    driver.until_heard(SettingChanged, lambda m: (m.name, m.value) == ("section", "y"))
    scene = driver.session.last(SceneOpened)
    middle_m = 0.5 * (scene.lower_m[1] + scene.upper_m[1])
    section = driver.asked(lambda stage: stage.state.section)
    assert section.normal == (0.0, 1.0, 0.0)
    assert section.offset_m == pytest.approx(middle_m)
    assert driver.project.section == "y"
    assert panel.rows["section"].editor.currentText() == "y"
    driver.session.undo()
    driver.until(lambda: not action.isChecked())
    assert driver.project.section == "off"

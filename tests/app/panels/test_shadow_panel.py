"""The panel of a shadow, on a real session: clicks and photographs become times of the day."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from dynamic_skylight import sun_position
from PIL import Image
from PySide6.QtCore import QPoint, Qt
from shadow_clock.panel import ShadowPanel
from window_driver import PATIENCE_MS, HeadlessStage, choose

from vrut_lite.app.engine.session import Session
from vrut_lite.geometry.frames import world_from_enu
from vrut_lite.kernel.messages import ClockMoved, SetClock
from vrut_lite.messages.picture import PictureClicked
from vrut_lite.messages.place import SetPlace

AT = datetime(2026, 6, 21, 14, 30, tzinfo=UTC)
NORTH = np.radians(20.0)


@pytest.fixture(scope="module")
def opened(qapp):
    """A session and its panel."""
    session = Session(HeadlessStage)
    panel = ShadowPanel(session)
    panel.resize(330, 760)
    session.start()
    yield session, panel
    # A window that stays would take the pointer from those of other tests.
    panel.close()
    session.close()
    session.join(PATIENCE_MS / 1e3)


@pytest.fixture
def session(opened):
    return opened[0]


@pytest.fixture
def panel(opened, qtbot):
    """The panel, nothing measured."""
    session, panel = opened
    place = SetPlace(latitude_deg=50.0, longitude_deg=14.4, north_offset_rad=NORTH)
    session.send(place, SetClock(instant=AT))
    choose(panel.source, "scene")
    panel.height_m.setValue(0.0)
    panel.up_deg.setValue(0.0)
    panel.has_bearing.setChecked(False)
    panel.has_ratio.setChecked(False)
    panel.show()
    qtbot.waitUntil(
        lambda: (
            (session.last(ClockMoved), session.last(SetPlace)) == (ClockMoved(instant=AT), place)
        ),
        timeout=PATIENCE_MS,
    )
    return panel


def click(session, point):
    session.send(
        PictureClicked(
            position_m=tuple(map(float, point)), normal=(0.0, 1.0, 0.0), material="ground",
            radiance_rgb=(1.0, 1.0, 1.0),
        )
    )  # fmt: skip


def instants(panel):
    rows = (panel.times.item(row) for row in range(panel.times.count()))
    return [row.data(Qt.ItemDataRole.UserRole) for row in rows]


def test_clicks_in_the_scene_find_the_scenes_own_hour(panel, session, qtbot):
    """Foot, tip and top of a 3 m pole, also where the scene's north is turned: the sun that cast
    the shadow shone at 14:30, and a click on that time goes there."""
    sun = sun_position(AT, 50.0, 14.4)
    foot = np.array([2.0, 0.5, -7.0])
    away = world_from_enu(np.array(sun.direction), NORTH)
    top = foot + np.array([0.0, 3.0, 0.0])
    tip = top - away * 3.0 / away[1]
    session.send(SetClock(instant=AT - timedelta(hours=3)))
    for point in (foot, tip):
        click(session, point)
    qtbot.waitUntil(lambda: len(instants(panel)) == 1, timeout=PATIENCE_MS)
    # A tenth of a degree that the field shows is some ten seconds.
    assert abs(instants(panel)[0] - AT) < timedelta(seconds=20)
    click(session, top)
    qtbot.waitUntil(lambda: panel.has_ratio.isChecked(), timeout=PATIENCE_MS)
    assert panel.ratio.value() == pytest.approx(1.0 / np.tan(sun.apparent_elevation_rad), abs=1e-3)
    panel.times.itemClicked.emit(panel.times.item(0))
    qtbot.waitUntil(
        lambda: abs(session.last(ClockMoved).instant - AT) < timedelta(seconds=20),
        timeout=PATIENCE_MS,
    )


def test_clicks_are_demanded_only_while_the_panel_takes_them(panel, session, qtbot):
    """Nobody looks up surfaces for clicks that no one wants."""

    def wanted():
        answers = []
        session.ask(lambda stage: stage.kernel.wanted(PictureClicked) is not None, answers.append)
        qtbot.waitUntil(lambda: bool(answers), timeout=PATIENCE_MS)
        return answers[0]

    assert wanted()
    panel.hide()
    assert not wanted()
    panel.show()
    choose(panel.source, "picture")
    assert not wanted()


def test_clicks_in_an_aerial_picture_give_bearing_and_ratio(panel, qtbot, tmp_path):
    """A shadow to the upper right of a picture whose up is 10 degrees east of north; 50 m long."""
    path = tmp_path / "aerial.png"
    Image.new("RGB", (800, 400), "grey").save(path)
    choose(panel.source, "picture")
    panel.show_picture(path)
    panel.up_deg.setValue(10.0)
    place = panel.picture.picture_place
    scale = 800 / place.width()
    foot = place.center()
    for spot in (foot, foot + QPoint(40, -40)):
        qtbot.mouseClick(panel.picture, Qt.MouseButton.LeftButton, pos=spot)
    assert panel.bearing_deg.value() == pytest.approx(55.0)
    assert not panel.has_ratio.isChecked()
    panel.pixel_m.setValue(0.5)
    panel.height_m.setValue(20.0)
    expected = 40.0 * np.sqrt(2.0) * scale * 0.5 / 20.0
    assert panel.has_ratio.isChecked()
    assert panel.ratio.value() == pytest.approx(expected, abs=1e-3)


def test_a_picture_of_a_known_hour_is_turned_by_its_shadow(panel, session, qtbot, tmp_path):
    """At 14:30 the sun says where the shadow points, so that the picture's north follows."""
    path = tmp_path / "aerial.png"
    Image.new("RGB", (800, 400), "grey").save(path)
    choose(panel.source, "picture")
    panel.show_picture(path)
    foot = panel.picture.picture_place.center()
    for spot in (foot, foot + QPoint(0, -60)):
        qtbot.mouseClick(panel.picture, Qt.MouseButton.LeftButton, pos=spot)
    panel.find_up.click()
    sun = sun_position(AT, 50.0, 14.4)
    shadow_deg = (np.degrees(sun.azimuth_rad) + 180.0) % 360.0
    assert panel.up_deg.value() == pytest.approx(shadow_deg, abs=0.06)
    assert abs(instants(panel)[0] - AT) < timedelta(seconds=20)
    session.send(SetClock(instant=AT + timedelta(hours=9)))
    said = []
    session.problem.connect(said.append)
    qtbot.waitUntil(
        lambda: session.last(ClockMoved).instant > AT + timedelta(hours=8), timeout=PATIENCE_MS
    )
    panel.find_up.click()
    assert "below the horizon" in said[0]


def test_a_photograph_offers_its_place_and_time(panel, session, qtbot, tmp_path):
    """EXIF of a phone: 18:30 in Cape Town, whose clocks are two hours ahead of UTC."""
    path = tmp_path / "photo.jpg"
    exif = Image.Exif()
    exif.get_ifd(0x8769)[0x9003] = "2025:12:03 18:30:05"
    gps = exif.get_ifd(0x8825)
    gps.update({1: "S", 2: (33.0, 55.0, 12.0), 3: "E", 4: (18.0, 25.0, 12.0)})
    Image.new("RGB", (64, 48)).save(path, exif=exif)
    choose(panel.source, "picture")
    panel.show_picture(path)
    assert panel.photo_says.isVisible()
    assert panel.photo_says.text() == "Go to its time and place"
    assert panel.photo_says.toolTip() == "2025-12-03 18:30:05\n-33.9200, 18.4200"
    panel.photo_says.click()
    at = datetime(2025, 12, 3, 16, 30, 5, tzinfo=UTC)
    qtbot.waitUntil(lambda: session.last(ClockMoved).instant == at, timeout=PATIENCE_MS)
    found = session.last(SetPlace)
    assert (found.latitude_deg, found.longitude_deg) == pytest.approx((-33.92, 18.42))


def test_typed_numbers_do_without_clicks_and_say_why_there_is_none(panel):
    """At 50 N in June no shadow points south."""
    panel.bearing_deg.setValue(312.0)
    panel.has_bearing.setChecked(True)
    assert len(instants(panel)) == 1
    panel.bearing_deg.setValue(180.0)
    assert instants(panel) == []
    assert "below the horizon" in panel.reason.text()


def test_what_is_no_picture_is_told_in_a_sentence(panel, session, tmp_path):
    said = []
    session.problem.connect(said.append)
    path = tmp_path / "broken.jpg"
    path.write_bytes(b"no picture")
    panel.show_picture(path)
    assert len(said) == 1
    assert "cannot open the picture" in said[0]

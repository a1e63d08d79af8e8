"""Panels say something true from the first moment, before the host is open."""

from threading import Event

import pytest
from PySide6.QtCore import QCoreApplication, QEvent
from window_driver import PATIENCE_MS, SCENES, HeadlessStage

from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.window.main_window import MainWindow
from vrut_lite.project import Exposure, Haze, Project
from vrut_lite.quantities import COMPUTING

PROJECT = Project(
    scene=str(SCENES / "sundial.glb"),
    place="35.68,139.69,40",
    at="2026-06-21T18:40",
    haze=Haze(0.35),
    exposure=Exposure(mode="manual", ev100=11.5),
)


@pytest.fixture
def opening(qapp, tmp_path):
    """A window whose host does not open before the test's end."""
    may_open = Event()

    def open_stage():
        may_open.wait(PATIENCE_MS / 1e3)
        return HeadlessStage()

    session = Session(open_stage)
    window = MainWindow(session, PresetStore(tmp_path))
    window.show()
    session.start()
    window.files.open_project(PROJECT)
    qapp.processEvents()
    yield window
    may_open.set()
    window.close_now()
    assert session.join(PATIENCE_MS / 1e3)
    window.deleteLater()
    session.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


def test_what_the_project_states_is_shown_at_once(opening):
    """Place, hour, haze and exposure need no computation: not 0, and not midnight of 2000."""
    place, time = opening.panels["place"], opening.time
    assert (place.latitude_deg.value, place.longitude_deg.value) == (35.68, 139.69)
    assert "Asia/Tokyo" in place.zone.text()
    assert place.name.text()
    assert time.clock.text() == "18:40:00"
    assert time.date.date().toString("yyyy-MM-dd") == "2026-06-21"
    assert opening.panels["sky"].haze.value == pytest.approx(0.35)
    assert opening.picture.ev100.value == 11.5


def test_what_is_still_to_be_computed_is_said_to_be(opening):
    """Never 0 lx, 0 degrees, a dash or nothing."""
    sun = opening.panels["sun"]
    for label in (sun.phase, sun.sunlight, sun.skylight, sun.moon, sun.moon_hours):
        assert label.text() == COMPUTING
    for spin in (sun.elevation, sun.azimuth):
        assert spin.text() == COMPUTING
    assert COMPUTING in opening.picture.metered.text()
    assert COMPUTING in opening.time.sun.text()
    assert "Opening" in opening.panels["sky"].coming.text()
    assert opening.panels["sky"].coming.isVisibleTo(opening.panels["sky"])


def test_a_project_that_is_wrong_is_not_foretold(qapp, tmp_path):
    """Its sentence comes when it is opened."""
    session = Session(HeadlessStage)
    window = MainWindow(session, PresetStore(tmp_path))
    window.files.open_project(Project(scene="a.glb", place="95,10"))
    assert window.panels["place"].name.text() == ""
    session.close()
    window.deleteLater()
    session.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)

"""The Scene panel tells how the file stands and what of it is not shown, and changes it."""

import pytest
from window_driver import SCENES

from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.project import Project


@pytest.fixture
def lying(tmp_path):
    """A Z-up house in centimetres, with a line that nobody draws."""
    plot = [(-1e3, -1e3, 0), (1e3, -1e3, 0), (1e3, 1e3, 0), (-1e3, 1e3, 0)]
    wall = [(-400, 0, 0), (400, 0, 0), (400, 0, 600), (-400, 0, 600)]
    text = "".join("v {} {} {}\n".format(*corner) for corner in plot + wall)
    path = tmp_path / "house.obj"
    path.write_text(text + "f 1 2 3 4\nf 5 6 7 8\nl 1 2\n")
    return path


def choose(box, data):
    box.setCurrentIndex(box.findData(data))
    box.activated.emit(box.currentIndex())


def test_axis_and_unit_are_shown_and_changed(headless_window, lying):
    """What was guessed stands in the panel and in the status line; a choice opens the file anew."""
    driver = headless_window
    panel = driver.panel("module scene")
    driver.open(Project(scene=str(lying)))
    driver.until(lambda: panel.unit.currentData() == 0.01)
    assert panel.up.currentData() == "z"
    assert "20 \N{MULTIPLICATION SIGN} 6" in panel.extent.text()
    for shown in (panel.notices.text(), driver.window.news.text()):
        assert "stand along +Z" in shown
        assert "l statement of the OBJ: not drawn" in shown
    # A long line does not widen the window.
    assert driver.window.minimumSizeHint().width() < driver.window.news.sizeHint().width()
    choose(panel.unit, 0.001)
    driver.until(lambda: driver.session.last(SceneOpened).upper_m[1] == pytest.approx(0.6))
    choose(panel.up, "y")
    driver.until(lambda: driver.session.last(SceneOpened).upper_m[2] == pytest.approx(0.6))
    assert not panel.camera.isEnabled()


def test_the_first_scene_has_nothing_to_note(headless_window):
    """A scene that is shown as it is says nothing."""
    driver = headless_window
    panel = driver.panel("module scene")
    driver.open(Project(scene=str(SCENES / "street.obj")))
    driver.until(lambda: "25.5" in panel.extent.text())
    assert panel.notices.text() == ""

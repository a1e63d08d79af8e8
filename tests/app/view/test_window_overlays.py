"""What is drawn over the picture, and the picture with it as a file."""

import numpy as np
import pytest
from PIL import Image
from PySide6.QtGui import QColor

from vrut_lite.app import theme
from vrut_lite.app.view.view_projection import project_directions
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.sun import SunMoved


@pytest.fixture
def driver(shared_headless_window):
    """Looking at the sun, over a picture that is black."""
    driver = shared_headless_window
    if (path := driver.window.actions_by_name["sun path"]).isChecked():
        path.trigger()
    driver.view = driver.window.desk.viewport
    driver.until(lambda: driver.session.last(SunMoved) is not None)
    x, y, z = driver.session.last(SunMoved).direction
    driver.session.send(
        MoveCamera(
            eye_m=(0.0, 1.7, 0.0),
            target_m=(x, 1.7 + y, z),
            vertical_field_of_view_rad=1.0,
        )
    )
    driver.until(lambda: driver.view.camera.vertical_field_of_view_rad == 1.0)
    return driver


def coloured(driver):
    """Pixels (h, w) of the overlay's colour in what the widget paints."""
    image = driver.view.grab().toImage()
    accent = QColor(theme.ACCENT)
    wanted = np.array([accent.red(), accent.green(), accent.blue()])
    pixels = np.array(
        [
            [image.pixelColor(x, y).getRgb()[:3] for x in range(image.width())]
            for y in range(0, image.height(), 3)
        ]
    )
    return np.abs(pixels - wanted).max(axis=-1) < 40


def test_the_suns_path_is_drawn_when_asked_for(driver):
    """Through the sun's place, which is the picture's middle; gone when it is switched off."""
    action = driver.window.actions_by_name["sun path"]
    assert not coloured(driver).any()
    action.trigger()
    drawn = coloured(driver)
    rows, columns = drawn.shape
    middle = drawn[rows // 2 - 4 : rows // 2 + 5, columns // 2 - 12 : columns // 2 + 13]
    assert middle.any()
    # The arc goes on to both sides: from the forenoon to the afternoon.
    assert drawn[:, : columns // 3].any()
    assert drawn[:, 2 * columns // 3 :].any()
    action.trigger()
    assert not coloured(driver).any()


def test_the_path_of_the_day_passes_through_the_sun(driver):
    """Where the day's arc has its hour the sun's own direction lies, to a tenth of a pixel."""
    day, sun = driver.window.desk.scout.day, driver.session.last(SunMoved)
    seconds = (driver.local() - day.start).total_seconds()
    on_arc = [np.interp(seconds, day.seconds, day.direction[:, axis]) for axis in range(3)]
    size = np.array([driver.view.width(), driver.view.height()])
    places = project_directions([on_arc, sun.direction], driver.view.camera, size[0] / size[1])
    assert np.abs((places[0] - places[1]) * size).max() < 0.1


def test_a_screenshot_is_what_one_sees(driver, tmp_path):
    """The widget's own pixels, overlay included; named by what is seen, never written over."""
    driver.window.files.pictures = tmp_path / "pictures"
    driver.window.actions_by_name["sun path"].trigger()
    for _ in range(2):
        driver.window.actions_by_name["screenshot"].trigger()
    names = sorted(path.name for path in driver.window.files.pictures.iterdir())
    assert names == [
        "sundial Prague 2026-06-21 13.00.00 (2).png",
        "sundial Prague 2026-06-21 13.00.00.png",
    ]
    assert names[0] in driver.window.news.text()
    with Image.open(driver.window.files.pictures / names[0]) as image:
        assert image.size == driver.view.pixels
        assert np.asarray(image).max() > 100


def test_a_screenshot_that_cannot_be_written_is_told(driver, tmp_path):
    """A file stands where the folder would be."""
    (tmp_path / "taken").write_text("")
    driver.window.files.pictures = tmp_path / "taken"
    driver.window.actions_by_name["screenshot"].trigger()
    assert "taken" in driver.window.news.text()
    assert "cannot make" in driver.window.news.text()

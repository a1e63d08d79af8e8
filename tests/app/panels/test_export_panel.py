"""The picture that is shown, written in any size under a name that says what it is."""

import pytest
from PIL import Image
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog


@pytest.fixture
def panel(shared_headless_window, monkeypatch):
    """The panel; `asked` has what the file dialog was asked, `answer` what it answers."""
    panel = shared_headless_window.panel("export")
    panel.driver, panel.asked, panel.answer = shared_headless_window, [], ""

    def chosen(parent, title, name, kinds):
        panel.asked.append((title, name, kinds))
        return panel.answer, ""

    monkeypatch.setattr(QFileDialog, "getSaveFileName", chosen)
    panel.status.clear()
    return panel


@pytest.mark.parametrize("suffix", ["png", "jpg", "exr"])
def test_a_picture_of_any_size_is_written(panel, tmp_path, qtbot, suffix):
    """336 x 190 pixels, whatever the window has, in each of three formats."""
    panel.chosen_size.choose(336, 190)
    panel.answer = str(tmp_path / f"picture.{suffix}")
    qtbot.mouseClick(panel.picture, Qt.MouseButton.LeftButton)
    panel.driver.until(lambda: "336 x 190 pixels" in panel.status.text())
    if suffix == "exr":
        assert (tmp_path / "picture.exr").stat().st_size > 500
    else:
        with Image.open(panel.answer) as image:
            assert image.size == (336, 190)


def test_names_say_scene_place_and_time(panel):
    """The sundial in Prague, 21 June 2026, 13:00; a film's name has the day."""
    panel.ask_for_picture()
    panel.kind.setCurrentText("film, MP4")
    panel.day.click()
    (_, picture, kinds), (title, film, _) = panel.asked
    assert title == "Film of the day"
    assert picture.endswith("/sundial Prague 2026-06-21 13.00.00.png")
    assert all(suffix in kinds for suffix in ("*.png", "*.jpg", "*.exr"))
    assert film.endswith("/sundial Prague 2026-06-21.mp4")


def test_every_kind_of_file_of_a_day_is_offered(panel):
    """Pictures in three formats, and two of films."""
    kinds = [panel.kind.itemText(row) for row in range(panel.kind.count())]
    assert kinds == ["PNG files", "JPEG files", "EXR files", "film, MP4", "film, WebP"]

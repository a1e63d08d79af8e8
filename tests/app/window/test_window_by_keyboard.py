"""The main tasks one after another by keyboard, each key to the widget that has the focus."""

import pytest
from PIL import Image
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QFileDialog
from window_driver import SCENES

from vrut_lite.app.view.hand import CameraMode
from vrut_lite.kernel.messages import SettingChanged, SlotChanged
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened

CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


@pytest.fixture
def driver(headless_window):
    window = headless_window.activated()
    window.until(lambda: "module clouds" in window.window.docks)
    window.window.desk.viewport.setFocus()
    return window


def press(driver, key, modifier=Qt.KeyboardModifier.NoModifier):
    QApplication.processEvents()
    focused = QApplication.focusWidget() or driver.window
    driver.qtbot.keyClick(QApplication.activePopupWidget() or focused, key, modifier)
    QApplication.processEvents()


def write(driver, text):
    driver.qtbot.keyClicks(QApplication.focusWidget(), text)


def find(driver, text):
    """Find and press an entry of the command palette."""
    press(driver, Qt.Key.Key_K, CONTROL)
    driver.until(lambda: QApplication.activePopupWidget() is not None)
    palette = QApplication.activePopupWidget()
    driver.qtbot.keyClicks(palette.text_field, text)
    driver.qtbot.keyClick(palette.text_field, Qt.Key.Key_Return)
    driver.until(lambda: QApplication.activePopupWidget() is None)
    QApplication.processEvents()


def test_the_main_tasks_need_no_mouse(driver, tmp_path, monkeypatch):
    """Open a scene; choose place, date, hour and sky; set a setting; move the camera; export;
    undo; compare two skies; quit."""
    view = driver.window.desk.viewport
    monkeypatch.setattr(
        QFileDialog, "getOpenFileName", lambda *_: (str(SCENES / "spheres.glb"), "")
    )
    press(driver, Qt.Key.Key_O, CONTROL)
    driver.until_heard(SceneOpened, lambda m: m.path.endswith("spheres.glb"))

    press(driver, Qt.Key.Key_G)
    press(driver, Qt.Key.Key_A, CONTROL)
    write(driver, "Reykjav")
    press(driver, Qt.Key.Key_Return)
    driver.until_heard(SetPlace, lambda m: m.latitude_deg > 60.0)
    driver.until(lambda: driver.window.desk.scout.day.zone.key == "Atlantic/Reykjavik")

    press(driver, Qt.Key.Key_Escape)
    press(driver, Qt.Key.Key_H, SHIFT)
    write(driver, "25")
    press(driver, Qt.Key.Key_Return)
    driver.until(lambda: driver.local().day == 25)

    press(driver, Qt.Key.Key_Escape)
    press(driver, Qt.Key.Key_H)
    press(driver, Qt.Key.Key_A, CONTROL)
    write(driver, "8:30")
    press(driver, Qt.Key.Key_Return)
    driver.until(lambda: f"{driver.local():%d %H:%M}" == "25 08:30")

    press(driver, Qt.Key.Key_Escape)
    find(driver, "sky: atmosphere")
    driver.until_heard(SlotChanged, lambda m: (m.name, m.holder) == ("sky", "bruneton_sky"))

    find(driver, "coverage")
    press(driver, Qt.Key.Key_A, CONTROL)
    write(driver, "0.4")
    press(driver, Qt.Key.Key_Return)
    driver.until_heard(SettingChanged, lambda m: (m.name, m.value) == ("coverage", 0.4))

    press(driver, Qt.Key.Key_Escape)
    assert view.hasFocus()
    before = view.camera
    press(driver, Qt.Key.Key_Left)
    driver.until_heard(MoveCamera, lambda m: m.eye_m != before.eye_m)
    press(driver, Qt.Key.Key_2)
    assert view.mode is CameraMode.FLY
    press(driver, Qt.Key.Key_F)

    written = tmp_path / "by keyboard"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(written), ""))
    press(driver, Qt.Key.Key_E, CONTROL)
    press(driver, Qt.Key.Key_Tab)
    press(driver, Qt.Key.Key_Space)
    driver.until(lambda: "pixels" in driver.panel("export").status.text())
    # Without a suffix it is a PNG.
    with Image.open(f"{written}.png") as image:
        assert image.size == view.pixels

    press(driver, Qt.Key.Key_Escape)
    press(driver, Qt.Key.Key_Z, CONTROL)
    driver.until_heard(SettingChanged, lambda m: (m.name, m.value) == ("coverage", None))

    press(driver, Qt.Key.Key_C)
    driver.until(driver.panel("compare").isVisible)

    press(driver, Qt.Key.Key_Q, CONTROL)
    driver.until(lambda: driver.session.has_ended)
    assert not driver.window.isVisible()

"""Single keys, drop-downs and menus, by keyboard."""

import pytest
from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QMenu, QToolButton

from vrut_lite.app.theme import apply_theme
from vrut_lite.app.window.dock_title import DockTitle
from vrut_lite.kernel.messages import SlotChanged
from vrut_lite.messages.place import SetPlace


@pytest.fixture
def driver(shared_headless_window):
    return shared_headless_window.activated()


def test_enter_opens_a_drop_down_and_chooses_in_it(driver, qtbot):
    """The sky is changed without a mouse."""
    driver.window.show_dock("sky")
    chooser = driver.panel("sky").choosers["sky"]
    chooser.setFocus()
    qtbot.keyClick(chooser, Qt.Key.Key_Return)
    view = chooser.view()
    driver.until(view.isVisible)
    row = chooser.findData("bruneton_sky")
    view.setCurrentIndex(chooser.model().index(row, 0))
    qtbot.keyClick(view, Qt.Key.Key_Return)
    driver.until_heard(SlotChanged, lambda m: (m.name, m.holder) == ("sky", "bruneton_sky"))
    driver.until(lambda: not view.isVisible())


@pytest.mark.parametrize("part", ["drop-down", "number"])
def test_no_single_key_dies_in_a_drop_down_or_a_number(driver, qtbot, part):
    """P shows the sun's path wherever the focus was left."""
    driver.window.show_dock("sky")
    panel = driver.panel("sky")
    control = panel.choosers["sky"] if part == "drop-down" else panel.haze.spin
    control.setFocus()
    action = driver.window.actions_by_name["sun path"]
    before, index = action.isChecked(), panel.choosers["sky"].currentIndex()
    qtbot.keyClick(control, Qt.Key.Key_P)
    assert action.isChecked() is not before
    assert panel.choosers["sky"].currentIndex() == index
    qtbot.keyClick(control, Qt.Key.Key_P)


def test_c_closes_what_c_opened(driver, qtbot):
    """C opens and closes its panel, as B, F3, F4, F5 and T do theirs."""
    viewport = driver.window.desk.viewport
    viewport.setFocus()
    for seen in (True, False):
        qtbot.keyClick(viewport, Qt.Key.Key_C)
        driver.until(lambda seen=seen: driver.panel("compare").isVisible() is seen)


def test_every_panel_has_a_button_that_closes_it(driver, qtbot):
    """The button closes a panel in a tab too, and View, Panels opens it again."""
    for name, dock in driver.window.docks.items():
        driver.window.show_dock(name)
        title = dock.titleBarWidget()
        assert isinstance(title, DockTitle)
        qtbot.mouseClick(title.close_button, Qt.MouseButton.LeftButton)
        assert dock.isHidden(), name
    for name in ("place", "sky", "time"):
        driver.window.show_dock(name)


def test_alt_and_a_letter_opens_each_menu(driver, qtbot):
    """Letters are said by an underline, each once in a menu."""
    bar = driver.window.menuBar()
    letters = [action.text().partition("&")[2][:1].lower() for action in bar.actions()]
    assert all(letters)
    assert len(set(letters)) == len(letters)
    for action in bar.actions():
        entries = [entry.text() for entry in action.menu().actions() if entry.text()]
        marked = [text.partition("&")[2][:1].lower() for text in entries]
        assert all(marked), entries
        assert len(set(marked)) == len(marked), entries


def test_keys_lead_to_the_place_the_hour_and_back_to_the_picture(driver, qtbot):
    """G and a city, H and an hour, Escape: the main tasks without a mouse."""
    window, viewport = driver.window, driver.window.desk.viewport
    viewport.setFocus()
    qtbot.keyClick(viewport, Qt.Key.Key_G)
    search = driver.panel("place").search
    driver.until(search.hasFocus)
    search.selectAll()
    qtbot.keyClicks(search, "Reykjav")
    qtbot.keyClick(search, Qt.Key.Key_Return)
    driver.until_heard(SetPlace, lambda m: m.latitude_deg > 60.0)
    qtbot.keyClick(search, Qt.Key.Key_Escape)
    assert viewport.hasFocus()
    qtbot.keyClick(viewport, Qt.Key.Key_H)
    clock = window.time.clock
    assert clock.hasFocus()
    qtbot.keyClicks(clock, "7:4")
    # What is being typed is given up first.
    qtbot.keyClick(clock, Qt.Key.Key_Escape)
    assert clock.hasFocus()
    qtbot.keyClick(clock, Qt.Key.Key_Escape)
    assert viewport.hasFocus()


def test_signs_of_buttons_are_drawn(driver):
    """A font without them would show boxes."""
    time = driver.window.time
    for button in (time.play, time.before, time.after):
        assert isinstance(button, QToolButton)
        assert button.text() == ""
        image = button.icon().pixmap(16, 16).toImage()
        assert any(image.pixelColor(x, 8).alpha() > 100 for x in range(image.width()))


@pytest.mark.long
def test_what_is_highlighted_in_a_menu_can_be_read(driver):
    """Contrast of 4.5 and more (WCAG 2, AA) between the text and what lies behind it."""
    app = QApplication.instance()
    before = app.styleSheet()
    apply_theme(app)
    try:
        menu = QMenu()
        chosen = menu.addAction("Highlighted")
        menu.setActiveAction(chosen)
        menu.resize(menu.sizeHint())
        image = menu.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
        place = menu.actionGeometry(chosen)
    finally:
        app.setStyleSheet(before)
    light = luminances(image, place)
    assert (max(light) + 0.05) / (min(light) + 0.05) > 4.5


def luminances(image: QImage, place: QRect) -> list[float]:
    inside = place.adjusted(4, 4, -4, -4)
    return [
        sum(
            share * channel**2.2
            for share, channel in zip((0.2126, 0.7152, 0.0722), rgb, strict=True)
        )
        for x in range(inside.left(), inside.right())
        for y in range(inside.top(), inside.bottom())
        for rgb in [image.pixelColor(x, y).getRgbF()[:3]]
    ]

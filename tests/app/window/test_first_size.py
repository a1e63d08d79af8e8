"""A first window on small and large screens."""

import pytest
from PySide6.QtCore import QRect
from PySide6.QtGui import QFontMetrics
from PySide6.QtWidgets import QApplication, QTabBar

from vrut_lite.app.theme import apply_theme
from vrut_lite.app.window.first_size import first_place


@pytest.mark.parametrize(
    "free",
    [
        QRect(0, 0, 1366, 768),
        QRect(0, 28, 1280, 692),
        QRect(1920, 0, 1600, 1000),
        QRect(0, 0, 800, 480),
    ],
)
def test_a_first_window_lies_inside_the_free_area_with_its_frame(free):
    """Otherwise the time bar and the status line would be below the screen's edge."""
    place = first_place(free)
    assert free.contains(place)
    assert place.top() - free.top() >= 24


def test_a_first_window_does_not_fill_a_large_screen():
    """A picture of 4K pixels takes seconds without a graphics card."""
    place = first_place(QRect(0, 0, 3840, 2160))
    assert (place.width(), place.height()) == (1600, 1000)


def test_no_panel_is_cut_off_at_its_side_in_a_small_window(shared_headless_window):
    """The numbers at the right of the sliders are seen at 1100 x 700 too."""
    letters = QFontMetrics(QApplication.font())
    if letters.horizontalAdvance("i") == letters.horizontalAdvance("m"):
        pytest.skip("no font is installed, and boxes are wider: install fonts-dejavu-core")
    driver = shared_headless_window
    driver.until(lambda: "module clouds" in driver.window.docks)
    driver.window.resize(1084, 660)
    for name in ("place", "sun", "picture", "export", "sky", "module clouds", "module scene"):
        driver.window.show_dock(name)
        QApplication.processEvents()
        area = driver.window.docks[name].widget()
        assert area.viewport().width() >= area.widget().minimumSizeHint().width(), name


@pytest.fixture
def theme(qapp):
    """The application's own look."""
    before = qapp.styleSheet()
    apply_theme(qapp)
    yield
    qapp.setStyleSheet(before)


@pytest.mark.long
def test_the_titles_of_tabs_are_never_cut_off(shared_headless_window, theme):
    """Many panels share a side: their tabs scroll, where "S…" for Scene would tell nothing."""
    driver = shared_headless_window
    driver.until(lambda: "module clouds" in driver.window.docks)
    driver.window.resize(1084, 660)
    for name in (*driver.window.docks, "module scene"):
        driver.window.show_dock(name)
        QApplication.processEvents()
    bars = [bar for bar in driver.window.findChildren(QTabBar) if bar.count() > 1]
    assert bars
    for bar in bars:
        title = bar.tabText(bar.currentIndex())
        shown = bar.tabRect(bar.currentIndex()).intersected(bar.rect())
        assert shown.width() >= bar.fontMetrics().horizontalAdvance(title), title


@pytest.fixture
def wide_letters(qapp):
    """A font of the application that is 1.8 times as wide as here."""
    usual = qapp.font()
    wide = qapp.font()
    wide.setPointSizeF(1.8 * usual.pointSizeF())
    qapp.setFont(wide)
    yield
    qapp.setFont(usual)


def test_a_window_may_be_narrower_than_900_points(shared_headless_window, wide_letters):
    """Half of a laptop's screen in any font, with a tool beside the picture: no text that is
    longer elsewhere may push the time bar off a screen."""
    driver = shared_headless_window
    driver.until(lambda: "module clouds" in driver.window.docks)
    for name in ("sky", "messages", "module path_tracer"):
        driver.window.show_dock(name)
    # Panels that came one after another lie in their tabs at last.
    driver.until(lambda: driver.window.minimumSizeHint().width() < 900)

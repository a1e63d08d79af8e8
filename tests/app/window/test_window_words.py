"""What people read in the window is words: identifiers are for scripts, projects and journals."""

import re

import pytest
from PySide6.QtCore import QLocale, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QAbstractButton,
    QComboBox,
    QDockWidget,
    QLabel,
    QTabBar,
    QTreeWidget,
    QWidget,
)

from vrut_lite.app.panels.message_inspector import MessageInspector
from vrut_lite.app.panels.number_field import NumberField
from vrut_lite.app.theme import apply_theme
from vrut_lite.app.window.shortcut_list import ShortcutList
from vrut_lite.kernel.messages import ChooseSlot

# An underscore or a capital within a word, Python's objects, and values as Python writes them.
IDENTIFIER = re.compile(
    r"\w_\w|\b[a-z]+[A-Z][a-z]\w*|\b[A-Z][a-z]+[A-Z][a-z]\w*| object at 0x|\bTrue\b|\bFalse\b"
    r"|\{'|\('"
)
# Names that are written so: formats, tone maps, the application itself.
PROPER = re.compile(r"\b(glTF|AgX|vrut_lite|OpenGL|PgUp|PgDown)\b")
# Names of files.
FILE = re.compile(r"\S+\.(glb|gltf|toml|obj|png|mcap|epw)\b")


@pytest.fixture
def driver(shared_headless_window):
    driver = shared_headless_window
    driver.until(lambda: "module clouds" in driver.window.docks)
    return driver


def texts_of(widget):
    """All that a widget shows as labels; what is typed into fields is a value."""
    if isinstance(widget, QLabel | QAbstractButton):
        yield re.sub(r"<[^>]+>", " ", widget.text())
    if isinstance(widget, QComboBox):
        yield from (widget.itemText(i) for i in range(widget.count()))
    if isinstance(widget, QTabBar):
        yield from (widget.tabText(i) for i in range(widget.count()))
    if isinstance(widget, QDockWidget):
        yield widget.windowTitle()
    if isinstance(widget, QTreeWidget):
        header = widget.headerItem()
        yield from (header.text(i) for i in range(header.columnCount()))
        for i in range(widget.topLevelItemCount()):
            item = widget.topLevelItem(i)
            yield from (item.text(column) for column in range(item.columnCount()))


def of_developers(widget):
    """Rows of the message inspector name message types, modules and fields: its purpose."""
    while widget is not None:
        if isinstance(widget, MessageInspector):
            return True
        widget = widget.parentWidget()
    return False


def is_identifier(text):
    return bool(IDENTIFIER.search(FILE.sub("", PROPER.sub("", text))))


def test_no_label_of_the_window_is_an_identifier(driver):
    """Labels, buttons, entries, titles, menus, keys and the palette, of every panel."""
    keys = ShortcutList(driver.window.menus.specs, driver.window)
    palette = driver.window.new_palette()
    for sky in ("dynamic_skylight", "bruneton_sky"):
        driver.session.send(ChooseSlot(slot="sky", module=sky))
    for name in driver.window.docks:
        driver.window.show_dock(name)
        driver.settled()
    shown = [widget for widget in driver.window.findChildren(QWidget) if not of_developers(widget)]
    assert len(shown) > 500
    found = {text for widget in shown for text in texts_of(widget) if is_identifier(text)}
    actions = [action.text() for action in driver.window.findChildren(QAction)]
    found |= {text for text in actions if is_identifier(text)}
    entries = [f"{entry.title}; {entry.hint}" for entry in palette.found]
    assert len(entries) > 100
    found |= {text for text in entries if is_identifier(text)}
    keys.close()
    palette.close()
    assert found == set()


def test_no_tooltip_begins_with_an_identifier_but_a_modules_name(driver):
    """The names of modules are what scripts call what the label says."""
    modules = driver.session.catalogue.modules
    first = {
        widget.toolTip().partition(" ")[0].partition("\n")[0].rstrip(":,.")
        for widget in driver.window.findChildren(QWidget)
        if widget.toolTip() and not of_developers(widget)
    }
    assert len(first) > 50
    assert {word for word in first if is_identifier(word)} <= set(modules)


def test_both_clear_skies_have_a_plain_title_and_their_name_in_the_tooltip(driver):
    """In the chooser, the comparison, the heading of the settings and the list of modules."""
    titles = {
        "dynamic_skylight": "Clear sky (fast)",
        "bruneton_sky": "Clear sky (atmosphere)",
    }
    sky = driver.panel("sky")
    choosers = (sky.choosers["sky"], *driver.panel("compare").choosers)
    for name, title in titles.items():
        for chooser in choosers:
            entry = chooser.findData(name)
            assert chooser.itemText(entry) == title
            assert chooser.itemData(entry, Qt.ItemDataRole.ToolTipRole) == name
        assert sky.panels[name].title == title
        assert driver.panel("modules")._item(name).text(0) == title
        driver.session.send(ChooseSlot(slot="sky", module=name))
        driver.until(lambda n=name: sky.choosers["sky"].toolTip().startswith(n))


def test_developers_views_stand_under_advanced_and_keep_their_keys(driver):
    """The menu of all days has what people look for."""
    menus = driver.window.menus
    advanced = {action.text().replace("&", "") for action in menus.advanced.actions()}
    assert {"Profiler", "Messages and journals", "Light map"} <= advanced
    actions = driver.window.actions_by_name
    assert actions["profiler"].shortcut().toString() == "F3"
    assert actions["messages"].shortcut().toString() == "F5"
    panels = {action.text().replace("&", "") for action in menus.panels.actions()}
    assert not advanced & panels


def test_numbers_in_fields_are_written_as_in_labels(qtbot, qapp):
    """Also where the system writes 1 300,5: the application's words are English."""
    before = QLocale()
    QLocale.setDefault(QLocale(QLocale.Language.Czech))
    try:
        apply_theme(qapp)
        field = NumberField(0.0, 16_000.0, "m", decimals=1)
        qtbot.addWidget(field)
        field.show_value(1300.5)
        assert field.spin.text() == "1,300.5 m"
    finally:
        QLocale.setDefault(before)

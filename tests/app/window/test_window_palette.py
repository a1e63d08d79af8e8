"""The command palette, the list of keys, and who gets a key: all by keyboard alone."""

from collections import Counter

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QApplication
from window_driver import SCENES

from vrut_lite.app.window.command_palette import CommandPalette, PaletteEntry, matching
from vrut_lite.app.window.shortcut_list import ShortcutList
from vrut_lite.kernel.messages import ClockMoved, SettingChanged, SlotChanged
from vrut_lite.messages.scene import SceneOpened


@pytest.fixture
def driver(shared_headless_window):
    return shared_headless_window.activated()


def palette(driver):
    driver.activated().qtbot.keyClick(
        driver.window, Qt.Key.Key_K, Qt.KeyboardModifier.ControlModifier
    )
    (found,) = driver.window.findChildren(CommandPalette)
    return found


def titles(found):
    return [entry.title for entry in found.found]


def run(driver, text):
    """What is typed into the palette, and Enter."""
    found = palette(driver)
    driver.qtbot.keyClicks(found.text_field, text)
    driver.qtbot.keyClick(found.text_field, Qt.Key.Key_Return)
    driver.until(lambda: not driver.window.findChildren(CommandPalette))
    QApplication.processEvents()


def test_a_command_is_found_and_done(driver):
    """A day later, by a few letters of its name."""
    before = driver.session.last(ClockMoved).instant
    run(driver, "day later")
    driver.until(lambda: driver.session.last(ClockMoved).instant.day == before.day + 1)


def test_arrows_choose_among_what_was_found(driver):
    """The second of several, and Escape leaves without doing anything."""
    found = palette(driver)
    driver.qtbot.keyClicks(found.text_field, "sky: clear")
    assert titles(found)[:2] == ["Sky: Clear sky (atmosphere)", "Sky: Clear sky (fast)"]
    driver.qtbot.keyClick(found.text_field, Qt.Key.Key_Down)
    driver.qtbot.keyClick(found.text_field, Qt.Key.Key_Up)
    driver.qtbot.keyClick(found.text_field, Qt.Key.Key_Return)
    driver.until_heard(SlotChanged, lambda m: (m.name, m.holder) == ("sky", "bruneton_sky"))
    driver.until(lambda: not driver.window.findChildren(CommandPalette))
    found = palette(driver)
    driver.qtbot.keyClick(found, Qt.Key.Key_Escape)
    driver.until(lambda: not driver.window.findChildren(CommandPalette))


def test_panels_and_settings_are_gone_to(driver):
    """A hidden panel comes up; a setting has the focus, ready to be typed."""
    run(driver, "modules panel")
    assert driver.panel("modules").isVisible()
    run(driver, "coverage")
    editor = driver.panel("module clouds").rows["coverage"].editor
    assert driver.window.focusWidget() is editor.spin
    assert editor.isVisible()


def test_a_recent_scene_is_opened_from_the_palette_and_from_the_menu(driver):
    """Both list what was opened lately; what has gone is not offered."""
    driver.window.files.open_path(str(SCENES / "spheres.glb"))
    driver.until_heard(SceneOpened, lambda m: m.path.endswith("spheres.glb"))
    driver.heard.clear()
    run(driver, "open sundial")
    driver.until_heard(SceneOpened, lambda m: m.path.endswith("sundial.glb"))
    driver.window.menus.fill_recent()
    offered = driver.window.menus.recent.actions()
    assert "sundial.glb" in offered[0].text()
    assert "spheres.glb" in offered[1].text()
    driver.heard.clear()
    offered[1].trigger()
    driver.until_heard(SceneOpened, lambda m: m.path.endswith("spheres.glb"))


def test_a_genus_of_clouds_is_found_by_its_name(driver):
    """ "Cumulus" makes cumulus, though its setting is called genus and its value Cu."""
    found = palette(driver)
    driver.qtbot.keyClicks(found.text_field, "cumulus")
    assert titles(found)[0] == "Cumulus (Cu)"
    driver.qtbot.keyClick(found.text_field, Qt.Key.Key_Return)
    driver.until_heard(SettingChanged, lambda m: (m.name, m.value) == ("genus", "Cu"))
    driver.until(lambda: not driver.window.findChildren(CommandPalette))
    box = driver.panel("module clouds").rows["genus"].editor
    driver.until(lambda: box.currentText() == "Cumulus (Cu)")


def test_a_sky_is_found_by_the_name_that_scripts_use(driver):
    """Who knows `bruneton_sky` from a project finds its title, with the name in its tooltip."""
    found = palette(driver)
    driver.qtbot.keyClicks(found.text_field, "bruneton_sky")
    assert titles(found)[0] == "Sky: Clear sky (atmosphere)"
    assert found.list.topLevelItem(0).toolTip(0) == "bruneton_sky"
    driver.qtbot.keyClick(found, Qt.Key.Key_Escape)
    driver.until(lambda: not driver.window.findChildren(CommandPalette))


def test_the_best_match_comes_first():
    """Names that begin with the first word come first, then those with such a word, then others."""
    entries = [PaletteEntry(title, "", print) for title in ("A replay", "The play", "Play")]
    assert [entry.title for entry in matching(entries, "play")] == ["Play", "The play", "A replay"]
    assert matching(entries, "nothing like it") == []
    assert matching(entries, "") == entries


def test_all_keys_are_listed_and_can_be_searched(driver):
    """Every key of every menu, and nothing but what was searched for."""
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_F1)
    (keys,) = driver.window.findChildren(ShortcutList)
    sections = [keys.list.topLevelItem(i) for i in range(keys.list.topLevelItemCount())]
    lines = [section.child(i) for section in sections for i in range(section.childCount())]
    listed = {line.text(0) for line in lines}
    assert {spec.keys for spec in driver.window.menus.specs if spec.keys} <= listed
    driver.qtbot.keyClicks(keys.filter, "undo")
    assert [line.text(1) for line in lines if not line.isHidden()] == ["Undo"]
    keys.close()


def test_no_key_means_two_things(driver):
    """Qt would do neither."""
    shortcuts = Counter(
        key.toString()
        for action in driver.window.actions_by_name.values()
        for key in action.shortcuts()
        if not key.isEmpty()
    )
    assert shortcuts[QKeySequence("Ctrl+Z").toString()] == 1
    assert max(shortcuts.values()) == 1


def test_every_action_has_a_key_that_can_be_pressed(driver):
    """A name of a key that Qt does not know would be dropped without a word."""
    keys = [key for spec in driver.window.menus.specs for key in spec.keys.split(", ") if key]
    assert len(keys) > 20
    for key in keys:
        assert not QKeySequence(key).isEmpty()
        assert QKeySequence(key)[0].key() != Qt.Key.Key_unknown


def test_space_presses_the_control_that_has_the_focus_and_plays_from_the_picture(driver):
    """A box cannot be ticked by keyboard where the window takes the space bar for itself."""
    box = driver.panel("module scene").rows["light_shafts"].editor
    driver.window.show_dock("module scene")
    box.setFocus()
    driver.qtbot.keyClick(box, Qt.Key.Key_Space)
    assert box.isChecked()
    assert not driver.window.time.player.playing
    driver.window.desk.viewport.setFocus()
    driver.qtbot.keyClick(driver.window.desk.viewport, Qt.Key.Key_Space)
    assert driver.window.time.player.playing
    driver.window.time.player.pause()

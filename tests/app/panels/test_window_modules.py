"""The module manager, by its own widgets: states, faults, and the ways back."""

import sys
from importlib.metadata import EntryPoint

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel
from window_driver import NOON, HeadlessStage, WindowDriver

from vrut_lite.app.window import docks
from vrut_lite.kernel.messages import (
    ClockMoved,
    EnableModule,
    ReloadModule,
    SetClock,
    SettingChanged,
    SlotChanged,
)
from vrut_lite.kernel.module import Manifest, Module, handles

RELOADABLE = """
from vrut_lite.kernel.messages import ClockMoved
from vrut_lite.kernel.module import Manifest, Module, handles

class Reloadable(Module):
    manifest = Manifest(name="reloadable", title="Reloadable", version="{version}")

    @handles(ClockMoved)
    def on_clock(self, message):
        {act}
"""


GROWING = """
import msgspec
from vrut_lite.kernel.module import Manifest, Module

class GrowingSettings(msgspec.Struct, frozen=True):
    {settings}

class Growing(Module):
    manifest = Manifest(name="growing", title="Growing", version="1")
    settings_type = GrowingSettings
"""


class Failing(Module):
    manifest = Manifest(name="failing", title="Failing", version="1")
    ill = True

    @handles(ClockMoved)
    def on_clock(self, message):
        if Failing.ill:
            raise ZeroDivisionError("on purpose")


@pytest.fixture
def driver(headless_window):
    Failing.ill = True
    headless_window.window.docks["modules"].show()
    return headless_window


@pytest.fixture
def manager(driver):
    return manager_of(driver)


def manager_of(driver):
    driver.window.docks["modules"].show()
    panel = driver.panel("modules")
    driver.until(lambda: panel.list.topLevelItemCount() > 0)
    return panel


def state(manager, name):
    item = row(manager, name)
    return "" if item is None else item.text(1)


def row(manager, name):
    items = [manager.list.topLevelItem(i) for i in range(manager.list.topLevelItemCount())]
    return next((item for item in items if item.data(0, Qt.ItemDataRole.UserRole) == name), None)


def tick(driver, *minutes):
    for minute in minutes:
        driver.session.send(SetClock(instant=NOON.replace(minute=minute)))
        driver.settled()


def test_a_key_shows_the_tools_and_hides_them(driver):
    """They have no title to close them by: the key that brought one takes it away."""
    driver.activated()
    modules, messages = (driver.window.docks[name] for name in ("modules", "messages"))
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_F5)
    driver.until(lambda: not driver.panel("messages").visibleRegion().isEmpty())
    assert driver.panel("modules").visibleRegion().isEmpty()
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_F4)
    driver.until(lambda: not driver.panel("modules").visibleRegion().isEmpty())
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_F4)
    assert modules.isHidden()
    assert not messages.isHidden()


def test_every_module_has_a_row_with_its_state_and_its_slots(shared_headless_window):
    """Each row shows the kernel's state of the module and the slots that it holds."""
    driver, manager = shared_headless_window, manager_of(shared_headless_window)
    seats = driver.asked(
        lambda stage: {name: seat.state for name, seat in stage.kernel.seats.items()}
    )
    assert {name: state(manager, name) for name in seats} == seats
    assert row(manager, "dynamic_skylight").text(2) == "sky, sun"


def test_the_fault_of_a_failing_module_is_shown_with_its_trace(driver, manager):
    """Three faults suspend it; the trace names the line that raised; Restart mends it."""
    driver.asked(lambda stage: stage.kernel.add_module(Failing))
    tick(driver, 1, 2, 3)
    driver.until(lambda: state(manager, "failing") == "suspended")
    manager.choose("failing")
    assert "ZeroDivisionError: on purpose" in manager.status.text()
    assert "suspended" in manager.status.text()
    assert 'raise ZeroDivisionError("on purpose")' in manager.trace.toPlainText()
    assert manager.trace.isVisible()
    Failing.ill = False
    driver.click(manager.restart)
    driver.until(lambda: state(manager, "failing") == "running")


def test_a_module_is_switched_off_and_on_by_its_box(driver, manager):
    """Space on a row works as a click on its box; another sky takes over the slot."""
    manager.choose("dynamic_skylight")
    manager.list.setFocus()
    driver.qtbot.keyClick(manager.list, Qt.Key.Key_Space)
    driver.until(lambda: state(manager, "dynamic_skylight") == "disabled")
    driver.until_heard(SlotChanged, lambda m: (m.name, m.holder) == ("sky", "bruneton_sky"))
    driver.qtbot.keyClick(manager.list, Qt.Key.Key_Space)
    driver.until(lambda: state(manager, "dynamic_skylight") == "running")


def test_the_hosts_own_modules_have_no_box(shared_headless_window):
    """Without its scene manager the window would show nothing, with no way back."""
    driver, manager = shared_headless_window, manager_of(shared_headless_window)
    manager.choose("scene")
    driver.qtbot.keyClick(manager.list, Qt.Key.Key_Space)
    driver.settled()
    assert state(manager, "scene") == "running"
    assert not manager.reload.isEnabled()
    assert manager.restart.isEnabled()


def test_reload_takes_a_module_as_its_file_is_now(driver, manager, tmp_path, monkeypatch):
    """A version that fails is mended in its file; Reload brings it in while all runs on."""
    file = tmp_path / "reloadable_module.py"
    file.write_text(RELOADABLE.format(version="1", act="raise ValueError('old')"))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    import reloadable_module

    driver.asked(lambda stage: stage.kernel.add_module(reloadable_module.Reloadable))
    tick(driver, 1, 2, 3)
    driver.until(lambda: state(manager, "reloadable") == "suspended")
    file.write_text(RELOADABLE.format(version="2.0", act="pass"))
    manager.choose("reloadable")
    driver.click(manager.reload)
    driver.until(lambda: state(manager, "reloadable") == "running")
    assert row(manager, "reloadable").text(3) == "2.0"
    monkeypatch.delitem(sys.modules, "reloadable_module")


def test_a_panel_follows_the_settings_of_a_reloaded_module(driver, tmp_path, monkeypatch):
    """A setting that a new version brings has its row, with the value that holds."""
    file = tmp_path / "growing_module.py"
    file.write_text(GROWING.format(settings="first: float = 1.0"))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    import growing_module

    driver.asked(lambda stage: stage.kernel.add_module(growing_module.Growing))
    driver.session.renew_roster()
    driver.until(lambda: "growing" in driver.session.catalogue.modules)
    found = docks.module_docks(driver.session.catalogue).docks
    (spec,) = (spec for spec in found if spec.name == "module growing")
    driver.window.board.add(spec)
    driver.window.show_dock(spec.name)
    panel = driver.panel(spec.name)
    assert list(panel.rows) == ["first"]
    file.write_text(GROWING.format(settings="first: float = 1.0; second: bool = True"))
    driver.session.send(ReloadModule(module="growing"))
    driver.until(lambda: list(panel.rows) == ["first", "second"])
    assert panel.rows["second"].editor.isChecked()
    # Of the window's keys a new row's control gets its own.
    driver.activated()
    panel.rows["second"].editor.setFocus()
    driver.qtbot.keyClick(panel.rows["second"].editor, Qt.Key.Key_Space)
    assert not driver.window.time.player.playing
    driver.until_heard(SettingChanged, lambda m: (m.name, m.value) == ("second", False))
    monkeypatch.delitem(sys.modules, "growing_module")


def test_safe_mode_leaves_the_host_and_daylight_and_goes_back(driver, manager):
    """Leaving safe mode starts exactly the modules that ran before it."""
    driver.session.send(EnableModule(module="zenoh_bridge", enabled=False))
    driver.settled()
    driver.until(lambda: state(manager, "zenoh_bridge") == "disabled")
    driver.click(manager.safe_mode)
    driver.until(lambda: state(manager, "bruneton_sky") == "disabled")
    driver.until(lambda: manager.safe_mode.isChecked())
    assert state(manager, "dynamic_skylight") == state(manager, "scene") == "running"
    assert state(manager, "clouds") == "disabled"
    driver.click(manager.safe_mode)
    driver.until(lambda: state(manager, "bruneton_sky") == state(manager, "clouds") == "running")
    driver.until(lambda: not manager.safe_mode.isChecked())
    assert state(manager, "zenoh_bridge") == "disabled"


class OwnPanel(QLabel):
    title = "Own"
    keys = "Ctrl+Alt+O"

    def __init__(self, session):
        super().__init__(f"of {len(session.catalogue.modules)} modules")


class RaisingPanel(QLabel):
    title = "Raising"

    def __init__(self, session):
        raise ZeroDivisionError("on purpose")


def test_a_module_brings_a_panel_and_a_bad_one_is_told(qtbot, tmp_path, monkeypatch):
    """A panel comes by entry point with its own key; if it fails, the settings are shown."""
    panels = {
        "clouds": "test_window_modules:OwnPanel",
        "path_tracer": "test_window_modules:RaisingPanel",
        "bruneton_sky": "no_such_package:Panel",
        "zenoh_bridge": "pathlib:Path",
        "not_installed": "no_such_package:Panel",
    }
    points = [EntryPoint(name, value, docks.PANEL_GROUP) for name, value in panels.items()]
    monkeypatch.setattr(docks, "usable_points", lambda group: points)
    driver = WindowDriver(qtbot, HeadlessStage, tmp_path)
    assert driver.panel("panel clouds").text() == (
        f"of {len(driver.session.catalogue.modules)} modules"
    )
    assert driver.window.docks["panel clouds"].isHidden()
    driver.window.actions_by_name["panel clouds"].trigger()
    driver.until(lambda: driver.panel("panel clouds").isVisible())
    assert [name for name in driver.window.docks if name.startswith("panel ")] == ["panel clouds"]
    for name in ("clouds", "path_tracer"):
        assert driver.panel(f"module {name}").rows
    for words in ("path_tracer failed: ZeroDivisionError", "no_such_package", "needs a `title`"):
        assert any(words in line for line in driver.problems), words
    assert not any("not_installed" in line for line in driver.problems)
    driver.close()

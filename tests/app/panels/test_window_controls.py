"""Every control of every panel does something, and can be reached by keyboard."""

import pytest
from control_walk import ControlWalk, controls_of, name_of
from long_parameters import mostly_long
from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QPushButton,
    QSlider,
    QStackedWidget,
    QWidget,
)
from window_driver import NOON, choose

from vrut_lite.app.file_field import FileField
from vrut_lite.app.panels.module_panel import ModulePanel
from vrut_lite.app.panels.number_field import NumberField
from vrut_lite.kernel.messages import EnableModule, SetClock, SettingChanged

# What is not worked here: how fast it will play (test_window_time); how many pictures of a day
# will be made, until it is cancelled (test_day_sequence); what opens a port (tests/zenoh_bridge);
# a list that is only read; a picture that is metered anew, black as before (test_window_picture).
ELSEWHERE = {
    "speed", "minutes from picture to picture", "Cancel", "Enabled", "content of the message",
    "Meter now",
}  # fmt: skip
# What leaves others with nothing to do.
LAST = {"Clear", "Close"}
PANELS = (
    "place", "sun", "picture", "export", "sky", "time", "modules", "messages", "compare",
    "module clouds", "module scene", "module path_tracer",
)  # fmt: skip
# Of the skies' rows test_window_sky holds a sample.
SHORT = ("picture", "modules")


@pytest.fixture
def driver(headless_window):
    return headless_window


@pytest.fixture
def walk(driver, monkeypatch):
    restless = [driver.panel("messages").journal.recorded, driver.window.statusBar()]
    return ControlWalk(driver, monkeypatch, restless)


def shown(driver, name):
    driver.window.show_dock(name)
    driver.settled()
    return driver.panel(name)


def usable(panel):
    return [c for c in controls_of(panel) if c.isVisible() and c.isEnabled()]


def walked(walk, panel):
    """Names of controls that did nothing, and how many were worked.

    What one control enables (a reset, a field of manual exposure) is worked after it.
    """
    done, dead = {c for c in controls_of(panel) if name_of(c) in ELSEWHERE}, []
    while todo := [c for c in usable(panel) if c not in done]:
        control = min(todo, key=lambda c: name_of(c) in LAST)
        done.add(control)
        title = f"{type(control).__name__} {name_of(control)!r}"
        if not walk.has_effect(control):
            dead.append(title)
        walk.let_go(control)
    return dead, len(done)


@pytest.mark.parametrize("name", mostly_long(PANELS, SHORT.__contains__))
def test_every_control_of_a_panel_has_an_effect(driver, walk, name):
    """An input, a line, a dialog, or something else in the window that is seen to change."""
    # What it would make of each change is no matter here.
    driver.session.send(EnableModule(module="clouds", enabled=False))
    panel = shown(driver, name)
    if name == "messages":
        driver.session.send(SetClock(instant=NOON.replace(minute=1)))
        driver.until(lambda: panel.table.messages.rowCount() > 5)
        panel.table.go_to(panel.table.messages.shown[2].number)
    if name == "compare":
        # A machine that has never solved an atmosphere compiles that for a while.
        driver.until(lambda: panel.plots is not None)
    dead, count = walked(walk, panel)
    assert dead == []
    assert count > 1


@pytest.mark.long
def test_every_control_of_the_skies_has_an_effect(driver, walk):
    """Each control of each model's panel changes the picture when that model holds the slot."""
    sky = shown(driver, "sky")
    (stack,) = sky.findChildren(QStackedWidget)
    for panel in sky.panels.values():
        stack.setCurrentWidget(panel)
        dead, count = walked(walk, panel)
        assert dead == []
        assert count > 2


def test_every_control_of_an_open_journal_has_an_effect(driver, walk, tmp_path):
    """Back, step, in the window, close: they are there while a journal is."""
    panel = shown(driver, "messages")
    path = str(tmp_path / "j.mcap")
    driver.session.save_journal(path, lambda _: panel.journal.open_from(path))
    driver.until(lambda: panel.journal.is_open)
    journal = panel.journal
    for control in (journal.next, journal.next, journal.back, journal.close_journal):
        assert walk.has_effect(control), name_of(control)


@pytest.mark.long
def test_a_control_without_effect_is_found(driver, walk):
    """The walk itself: a button and a slider that nobody listens to."""
    walk.patience_ms = 1000
    panel = shown(driver, "picture")
    button, slider = QPushButton("Dead"), QSlider(Qt.Orientation.Horizontal)
    slider.setAccessibleName("dead slider")
    for control in (button, slider):
        panel.layout().addRow(control)
        assert control in controls_of(panel)
        assert not walk.has_effect(control)


def test_every_control_is_reached_by_tab_and_has_a_name(shared_headless_window):
    """Who cannot use a mouse, or cannot see, works all that others do."""
    driver = shared_headless_window
    controls = [control for name in PANELS for control in usable(shown(driver, name))]
    assert len(controls) > 80
    for control in controls:
        focused = control
        while focused.focusProxy() is not None:
            focused = focused.focusProxy()
        assert focused.focusPolicy() & Qt.FocusPolicy.TabFocus, name_of(control)
        assert name_of(control), control


def test_every_setting_can_be_changed_by_its_row_and_taken_back(shared_headless_window):
    """Each control is worked as by a hand and its module accepts it; a reset brings the default."""
    driver = shared_headless_window
    driver.session.send(EnableModule(module="clouds", enabled=False))
    panels = driver.window.findChildren(ModulePanel)
    specs = driver.session.catalogue.modules
    assert {panel.title for panel in panels} == {m.title for m in specs.values() if m.specs}
    for panel in panels:
        for row in panel.rows.values():
            spec = row.spec
            if spec.name == "enabled" or not can_be_worked(row):
                continue
            driver.heard.clear()
            work(driver, row)
            changed = driver.until_heard(SettingChanged, lambda m, s=spec: m.name == s.name)
            assert changed.value != spec.default
            driver.until(row.reset.isEnabled)
            row.reset.click()
            driver.until_heard(
                SettingChanged, lambda m, s=spec: (m.name, m.value) == (s.name, s.default)
            )
            assert not row.reset.isEnabled()
    assert not driver.problems


def can_be_worked(row):
    """Whether there is a choice: the GPU is not offered on a machine without one."""
    return not isinstance(row.editor, QComboBox) or row.editor.count() > 1


def work(driver, row):
    """Change a control as a hand would."""
    if isinstance(row.name, QCheckBox):
        row.name.click()
    elif isinstance(row.editor, QComboBox):
        choose(row.editor, row.editor.itemData((row.editor.currentIndex() + 1) % 2))
    elif isinstance(row.editor, QCheckBox):
        row.editor.click()
    elif isinstance(row.editor, NumberField):
        spin = row.editor.spin
        spin.stepBy(1 if spin.value() < spin.maximum() else -1)
    else:
        line = row.editor.line if isinstance(row.editor, FileField) else row.editor
        driver.type_in(line, "a")


def test_tooltips_tell_the_source_of_a_formula(shared_headless_window):
    """The panel takes its tooltips from the settings' descriptions."""
    driver = shared_headless_window
    rows = {
        (module, name): row
        for module, panel in driver.panel("sky").panels.items()
        for name, row in panel.rows.items()
    }
    told = rows["dynamic_skylight", "turbidity"].editor.toolTip()
    assert told.endswith("Source: Preetham, Shirley and Smits 1999, appendix A.1")
    assert "Between 1 and 10" in told
    assert "Source: Koschmieder 1924" in rows["bruneton_sky", "fog_visibility_m"].name.toolTip()
    assert "Source" not in rows["bruneton_sky", "cube_device"].editor.toolTip()
    assert all(isinstance(row.editor, QWidget) and row.editor.toolTip() for row in rows.values())

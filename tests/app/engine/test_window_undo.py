"""Undo and redo, by the controls of the panels and by the keys of the window."""

import math

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication
from window_driver import NOON, SCENES, choose

from vrut_lite.app.engine import history
from vrut_lite.app.engine.history import History, inverse_of
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.kernel.messages import ChooseSlot, ClockMoved, EnableModule, SetClock, SetSetting
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.ground import ground_of
from vrut_lite.messages.haze import haze_of
from vrut_lite.messages.picture import SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE, SetTolerance

PRAGUE = SetPlace(latitude_deg=50.0755, longitude_deg=14.4378, altitude_m=200.0)


@pytest.fixture
def driver(shared_headless_window):
    return shared_headless_window.activated()


def press(driver, key, modifiers=Qt.KeyboardModifier.ControlModifier, on=None):
    driver.qtbot.keyClick(on or driver.window, key, modifiers)
    driver.settled()
    driver.settled()


def undo(driver, on=None):
    press(driver, Qt.Key.Key_Z, on=on)


def redo(driver):
    both = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
    press(driver, Qt.Key.Key_Z, both)


def type_in(driver, spin, text):
    driver.type_in(spin, text)
    driver.settled()


def everything(driver):
    """All that undo is to bring back, as the kernel has it."""

    def question(stage):
        kernel = stage.kernel
        return (
            {name: seat.settings for name, seat in kernel.seats.items()},
            {name: seat.state for name, seat in kernel.seats.items()},
            kernel.slots.holder("sky"),
            kernel.last(SetPlace),
            haze_of(kernel),
            kernel.last(SetExposure) or SetExposure(),
            kernel.last(ClockMoved),
        )

    return driver.asked(question)


def left_open(driver):
    """Albedo that an unset one stands for: that of the ground around the scene."""
    return pytest.approx(ground_of(driver.session).albedo, abs=5e-3)


def ten_changes(driver):
    """Ten of them, each by another control."""
    sky, clouds, scene = (driver.panel(name) for name in ("sky", "module clouds", "module scene"))
    hosek, picture = sky.panels["dynamic_skylight"], driver.panel("picture")
    yield lambda: type_in(driver, sky.haze.spin, "0.45")
    yield lambda: hosek.rows["albedo"].editor.slider.setValue(700)
    yield lambda: choose(hosek.rows["sun_method"].editor, "preetham")
    yield lambda: type_in(driver, clouds.rows["base_m"].editor.spin, "900")
    yield lambda: scene.rows["light_shafts"].editor.click()
    yield lambda: type_in(driver, driver.panel("place").latitude_deg.spin, "-33.9")
    yield lambda: type_in(driver, picture.compensation_ev.spin, "1.5")
    yield lambda: driver.window.time.step_days(1)
    yield lambda: choose(sky.choosers["sky"], "bruneton_sky")
    yield lambda: hosek.reset.click()


@pytest.mark.long
def test_ten_steps_are_taken_back_and_done_again(driver):
    """Settings, a slot, a place, the exposure, the time, a reset: each as it was, both ways."""
    states = [everything(driver)]
    for change in ten_changes(driver):
        change()
        driver.settled()
        states.append(everything(driver))
        assert states[-1] != states[-2]
    for before in reversed(states[:-1]):
        undo(driver)
        assert everything(driver) == before
    assert not driver.window.actions_by_name["undo"].isEnabled()
    for after in states[1:]:
        redo(driver)
        assert everything(driver) == after
    assert not driver.window.actions_by_name["redo"].isEnabled()


def test_controls_show_what_was_taken_back(driver):
    """The slider, the number and the menu follow, and a new change ends what could be redone."""
    editor = driver.panel("sky").panels["dynamic_skylight"].rows["albedo"].editor
    action = driver.window.actions_by_name["undo"]
    editor.slider.setValue(900)
    driver.settled()
    assert action.text() == f"&Undo Albedo {editor.value:.3g}"
    undo(driver)
    assert editor.value == left_open(driver)
    assert driver.window.news.text().startswith("Undone: Albedo ")
    assert driver.window.actions_by_name["redo"].isEnabled()
    type_in(driver, editor.spin, "0.25")
    assert not driver.window.actions_by_name["redo"].isEnabled()


def test_a_drag_is_one_step(driver, monkeypatch):
    """As many values as a slider passes on its way, however slow the hand."""
    monkeypatch.setattr(history, "GESTURE_S", 1000.0)
    editor = driver.panel("sky").panels["dynamic_skylight"].rows["albedo"].editor
    for notch in range(300, 900, 60):
        editor.slider.setValue(notch)
        QApplication.processEvents()
    driver.settled()
    undo(driver)
    assert editor.value == left_open(driver)
    assert not driver.window.actions_by_name["undo"].isEnabled()


def test_a_project_is_where_undo_ends(driver):
    """Nobody wants to go back to half of another project."""
    editor = driver.panel("sky").panels["dynamic_skylight"].rows["albedo"].editor
    type_in(driver, editor.spin, "0.45")
    driver.window.files.open_path(str(SCENES / "street.toml"))
    driver.until(lambda: not driver.window.actions_by_name["undo"].isEnabled())
    driver.settled()
    assert editor.value == left_open(driver)


def test_undo_works_from_a_field_in_which_nothing_is_left_to_take_back(driver):
    """A field that has handed over what was typed must not keep Ctrl+Z for itself."""
    spin = driver.panel("sky").panels["dynamic_skylight"].rows["albedo"].editor.spin
    type_in(driver, spin, "0.45")
    undo(driver, on=spin)
    assert spin.value() == left_open(driver)


def test_what_is_being_typed_is_taken_back_where_it_is_typed(driver):
    """Ctrl+Z in the midst of a word is the field's own, and the window's steps stay."""
    editor = driver.panel("sky").panels["dynamic_skylight"].rows["albedo"].editor
    type_in(driver, editor.spin, "0.45")
    search = driver.panel("place").search
    search.setFocus()
    driver.qtbot.keyClicks(search, "Reyk")
    undo(driver, on=search)
    assert search.text() == ""
    assert editor.value == 0.45
    undo(driver, on=search)
    assert editor.value == left_open(driver)


# --- the parts, without a window -----------------------------------------------------------


@pytest.fixture
def kernel():
    kernel, failures = daylight_kernel()
    assert not failures
    kernel.inject(PRAGUE)
    kernel.inject(SetClock(instant=NOON))
    kernel.pump_until_idle()
    yield kernel
    kernel.close()


@pytest.mark.parametrize(
    ("message", "back"),
    [
        (
            SetSetting(module="clouds", name="coverage", value="0.5"),
            SetSetting(module="clouds", name="coverage", value=None),
        ),
        (
            ChooseSlot(slot="sky", module="bruneton_sky"),
            ChooseSlot(slot="sky", module="dynamic_skylight"),
        ),
        (EnableModule(module="clouds", enabled=False), EnableModule(module="clouds")),
        (SetPlace(latitude_deg=0.0, longitude_deg=0.0), PRAGUE),
        (SetExposure(ev100=3.0), SetExposure()),
        (SetClock(instant=NOON.replace(minute=1)), SetClock(instant=NOON)),
        (SetTolerance(tolerance=0.01), SetTolerance(tolerance=DEFAULT_TOLERANCE)),
        # Refused, without effect, or not taken back.
        (SetSetting(module="clouds", name="coverage", value=7.0), None),
        (SetSetting(module="clouds", name="coverage", value="none"), None),
        (SetSetting(module="nobody", name="coverage", value=0.1), None),
        (SetSetting(module="clouds", name="nothing", value=0.1), None),
        (ChooseSlot(slot="sky", module="clouds"), None),
        (EnableModule(module="clouds"), None),
        (SetPlace(latitude_deg=math.nan, longitude_deg=0.0), None),
        (PRAGUE, None),
        (SetTolerance(tolerance=7.0), None),
        (SetExposure(), None),
        (SetClock(instant=NOON), None),
        (LoadScene(path="a.glb"), None),
        (MoveCamera(eye_m=(0.0, 0.0, 1.0), target_m=(0.0, 0.0, 0.0)), None),
    ],
)
def test_the_inverse_of_an_input(kernel, message, back):
    """Who sends it gets back what was; None where there is nothing to bring back."""
    assert inverse_of(message, kernel) == back


def test_what_closely_follows_is_one_step_and_what_does_not_is_another(kernel):
    """One control in quick succession, or all that was sent together; never another control."""
    now, told = [0.0], []
    steps = History(told.append, lambda: now[0])
    steps.attach(kernel)

    def send(*inputs, after_s=0.1):
        now[0] += after_s
        steps.expect(inputs)
        for message in inputs:
            kernel.inject(message)
        kernel.pump_until_idle()

    def setting(name, value):
        return SetSetting(module="clouds", name=name, value=value)

    send(setting("coverage", 0.1))
    send(setting("coverage", 0.2))
    send(setting("coverage", 0.3), after_s=5.0)
    send(setting("base_m", 900.0), setting("thickness_m", 500.0))
    assert told[-1].undo == "2 changes"
    kernel.inject(setting("seed", 5))
    kernel.pump_until_idle()
    titles = []
    while title := steps.undo():
        titles.append(title)
        kernel.pump_until_idle()
    assert titles == ["2 changes", "Coverage 0.3", "Coverage 0.2"]
    settings = kernel.seats["clouds"].settings
    assert (settings.coverage, settings.base_m, settings.thickness_m) == (None, None, None)
    assert settings.seed == 5
    assert steps.redo() == "Coverage 0.2"


def test_what_is_sent_in_quick_succession_is_one_step_also_on_a_busy_machine(kernel):
    """The hand's time counts: the kernel may admit a drag's values seconds apart."""
    now, told = [0.0], []
    steps = History(told.append, lambda: now[0])
    steps.attach(kernel)
    drag = [SetSetting(module="clouds", name="coverage", value=value) for value in (0.1, 0.2, 0.3)]
    for message in drag:
        steps.expect((message,))
        now[0] += 0.1
    for message in drag:
        now[0] += 5.0
        kernel.inject(message)
        kernel.pump_until_idle()
    assert steps.undo() == "Coverage 0.3"
    assert steps.undo() == ""

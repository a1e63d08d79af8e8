"""Slots, settings and presets of the panels, by their own widgets."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QCheckBox, QLabel
from window_driver import choose

from vrut_lite.app.panels.module_panel import ModulePanel
from vrut_lite.app.panels.number_field import FieldScale
from vrut_lite.kernel.messages import SettingChanged, SlotChanged
from vrut_lite.messages.ground import SetGround, ground_of
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import SunMoved
from vrut_lite.messages.tolerance import SetTolerance


@pytest.fixture
def driver(shared_headless_window):
    shared_headless_window.sky = shared_headless_window.panel("sky")
    return shared_headless_window


def test_the_sky_is_switched_and_its_panel_with_it(driver):
    """Another holder, another source of the background, another panel."""
    choose(driver.sky.choosers["sky"], "bruneton_sky")
    driver.until_heard(SlotChanged, lambda m: (m.name, m.holder) == ("sky", "bruneton_sky"))
    driver.until_heard(BackgroundChanged, lambda m: m.source == "bruneton_sky")
    assert driver.sky.panels["bruneton_sky"].isVisibleTo(driver.sky)
    assert not driver.sky.panels["dynamic_skylight"].isVisibleTo(driver.sky)


def test_the_sky_is_switched_while_an_atmosphere_is_being_solved(driver):
    """A precomputation under way neither blocks the switch nor shows its sky after it."""
    choose(driver.sky.choosers["sky"], "bruneton_sky")
    driver.sky.panels["bruneton_sky"].choose({"turbidity": 5.0, "orders": 40})
    choose(driver.sky.choosers["sky"], "dynamic_skylight")
    driver.settled()
    driver.settled()
    assert driver.asked(lambda stage: stage.kernel.slots.holder("sky")) == "dynamic_skylight"
    assert driver.session.last(BackgroundChanged).source == "dynamic_skylight"
    assert driver.sky.choosers["sky"].currentData() == "dynamic_skylight"


def test_a_slider_moves_the_sky(driver, qtbot):
    """Albedo by its slider: the setting, the typed value and a new background follow."""
    row = driver.sky.panels["dynamic_skylight"].rows["albedo"]
    row.editor.slider.setValue(800)
    changed = driver.until_heard(SettingChanged, lambda m: m.name == "albedo")
    assert changed.value == pytest.approx(row.editor.value)
    assert row.editor.value == pytest.approx(0.8, abs=0.01)
    driver.until_heard(BackgroundChanged)
    qtbot.mouseClick(row.reset, Qt.MouseButton.LeftButton)
    driver.until_heard(SettingChanged, lambda m: m.name == "albedo" and m.value is None)
    left_open = pytest.approx(ground_of(driver.session).albedo, abs=5e-3)
    driver.until(lambda: row.editor.value == left_open and not row.reset.isEnabled())


def test_a_value_is_typed(driver, qtbot):
    """Digits and Enter; what is out of range the field does not take."""
    spin = driver.sky.panels["dynamic_skylight"].rows["albedo"].editor.spin
    spin.setFocus()
    spin.selectAll()
    qtbot.keyClicks(spin, "0.25")
    qtbot.keyClick(spin, Qt.Key.Key_Return)
    assert driver.until_heard(SettingChanged).value == 0.25
    assert (spin.minimum(), spin.maximum()) == (0.0, 1.0)


def test_the_haze_is_one_control_for_every_sky(driver):
    """The control sets the optical depth of every sky, and shows that of an opened project."""
    field = driver.sky.haze
    assert field.value == pytest.approx(0.201)
    field.spin.setValue(0.4)
    assert driver.until_heard(SetHaze).optical_depth_550 == pytest.approx(0.4)
    driver.until_heard(BackgroundChanged)
    assert "T 4.99: turbidity" in field.toolTip()
    driver.session.send(SetHaze(optical_depth_550=0.05))
    driver.until(lambda: field.value == 0.05)


def test_the_ground_is_one_control_for_every_sky(driver, qtbot):
    """Chosen by name; it shows that of an opened project, and what an unset albedo stands for."""
    chooser, row = driver.sky.ground, driver.sky.panels["dynamic_skylight"].rows["albedo"]
    chooser.setCurrentIndex(chooser.findData("snow"))
    chooser.activated.emit(chooser.currentIndex())
    assert driver.until_heard(SetGround).ground == "snow"
    driver.until_heard(BackgroundChanged)
    driver.until(lambda: row.editor.value == pytest.approx(0.98, abs=0.01))
    driver.session.send(SetGround(ground="none"))
    driver.until(lambda: chooser.currentText() == "None" and row.editor.value == 0.1)


def test_the_tolerance_is_typed_and_followed(driver):
    """The field is in percent, the message a share; the field shows an opened project's value."""
    driver.sky.tolerance.spin.setValue(1.0)
    assert driver.until_heard(SetTolerance).tolerance == pytest.approx(0.01)
    driver.session.send(SetTolerance(tolerance=0.03))
    driver.until(lambda: driver.sky.tolerance.value == 3.0)


def test_a_setting_that_may_be_left_open_has_a_box_to_tick(driver):
    """Unticked it is none and shows what the preset has; ticked it starts from there."""
    choose(driver.sky.choosers["sky"], "bruneton_sky")
    row = driver.sky.panels["bruneton_sky"].rows["ozone_du"]
    assert isinstance(row.name, QCheckBox)
    assert not row.name.isChecked()
    assert row.editor.value == pytest.approx(300.0, abs=0.1)
    row.name.setChecked(True)
    changed = driver.until_heard(SettingChanged, lambda m: m.name == "ozone_du")
    assert changed.value == pytest.approx(300.0)
    driver.until(lambda: row.name.isChecked())
    row.name.setChecked(False)
    driver.until_heard(SettingChanged, lambda m: m.name == "ozone_du" and m.value is None)


def test_presets_of_the_panel_are_kept_used_and_forgotten(driver):
    """A preset restores its kept settings and resets the others to their defaults."""
    panel: ModulePanel = driver.sky.panels["dynamic_skylight"]
    panel.choose({"turbidity": 6.0, "albedo": 0.5})
    driver.until_heard(SettingChanged, lambda m: m.name == "albedo")
    driver.settled()
    panel.keep("hazy")
    panel.choose({"turbidity": 2.0, "sun_colour": "white"})
    driver.until_heard(SettingChanged, lambda m: m.name == "sun_colour")
    driver.settled()
    menu_entry(panel, "hazy").trigger()
    driver.settled()
    values = driver.asked(lambda stage: stage.kernel.seats["dynamic_skylight"].settings)
    assert (values.turbidity, values.albedo, values.sun_colour) == (6.0, 0.5, "air")
    menu_entry(panel, "Forget", "hazy").trigger()
    panel.fill_presets()
    assert "hazy" not in [action.text() for action in panel.preset_menu.actions()]


def menu_entry(panel, *path):
    panel.fill_presets()
    menu = panel.preset_menu
    for title in path[:-1]:
        menu = next(action.menu() for action in menu.actions() if action.text() == title)
    return next(action for action in menu.actions() if action.text() == path[-1])


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (1.0, 10.0), (50.0, 20_000.0), (-5.0, 5.0)])
def test_a_slider_and_its_value_are_one(low, high):
    """Shares and values lead to each other; ranges over a factor of 100 go by factors."""
    scale = FieldScale(low, high)
    assert scale.logarithmic == (low == 50.0)
    for share in (0.0, 0.25, 0.5, 1.0):
        assert scale.share_of(scale.value_at(share)) == pytest.approx(share)
    assert (scale.value_at(0.0), scale.value_at(1.0)) == pytest.approx((low, high))


def test_the_suns_angles_are_typed(driver):
    """30 degrees after noon is in the afternoon; azimuth 90 is where the sun is due east."""
    panel = driver.panel("sun")
    driver.until(lambda: panel.elevation.value() > 50.0)
    panel.elevation.setValue(30.0)
    driver.until_heard(SunMoved, lambda m: abs(m.elevation_rad - 0.5236) < 1e-3)
    panel.azimuth.setValue(90.0)
    driver.until_heard(SunMoved, lambda m: abs(m.azimuth_rad - 1.5708) < 2e-3)


def test_an_angle_that_the_sun_does_not_reach_is_told_with_its_range(driver):
    """In Prague the sun never reaches 80 degrees; the field returns to the present elevation."""
    panel = driver.panel("sun")
    driver.until(lambda: panel.elevation.value() > 50.0)
    before = panel.elevation.value()
    panel.elevation.setValue(80.0)
    assert "never stands at 80.00\N{DEGREE SIGN}" in driver.window.news.text()
    assert panel.elevation.value() == before


def test_the_haze_goes_from_clear_to_hazy_and_is_typed_on_two_scales(driver):
    """Words at the slider's ends; a turbidity that is typed is sent as an optical depth."""
    field = driver.sky.haze
    words = [label.text() for label in field.findChildren(QLabel)]
    assert words == ["clear", "hazy"]
    driver.type_in(field.turbidity, "6")
    sent = driver.until_heard(SetHaze)
    assert sent.turbidity == pytest.approx(6.0, abs=0.01)
    driver.settled()
    assert field.spin.text() == f"AOD {sent.optical_depth_550:.3f}"
    assert field.turbidity.value() == pytest.approx(6.0, abs=0.01)
    driver.type_in(field.spin, "0.1")
    driver.until_heard(SetHaze, lambda m: m.optical_depth_550 == pytest.approx(0.1))
    assert field.turbidity.value() == pytest.approx(
        SetHaze(optical_depth_550=0.1).turbidity, abs=0.01
    )
    assert "without unit" in field.toolTip()

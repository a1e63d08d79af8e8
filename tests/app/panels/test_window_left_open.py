"""What is left open is shown as it stands; presets and quantities in people's words."""

import msgspec
import numpy as np
import pytest
from window_driver import SCENES

from vrut_lite.app.compare.sky_plots import LogAxis
from vrut_lite.app.panels.module_manager import status_line
from vrut_lite.app.panels.number_field import NumberField
from vrut_lite.app.panels.sky_panel import lack_line
from vrut_lite.app.panels.sun_panel import phase_of
from vrut_lite.app.setting_words import label_of
from vrut_lite.app.view.light_probe import illuminance_text
from vrut_lite.atmosphere.ground_reflectance import GREY
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.kernel.messages import EnableModule, Fault, SetClock, SetSetting, SlotChanged
from vrut_lite.kernel.settings import describe, parse
from vrut_lite.messages.ground import ground_of
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.sun import SunMoved
from vrut_lite.quantities import lux_text
from vrut_lite.render.light_meter import Illuminance
from vrut_lite.sky.effective_defaults import left_open, presets_of

HAZE = SetHaze(optical_depth_550=0.4, aerosol="one-lobe")


@pytest.fixture
def driver(shared_headless_window):
    return shared_headless_window


def rows(driver, module):
    return driver.panel("sky").panels[module].rows


def test_a_sky_without_its_own_haze_shows_that_of_the_place(driver):
    """It follows each change; the preset of another planet shows its own."""
    driver.session.send(HAZE)
    for module in ("dynamic_skylight", "bruneton_sky"):
        field = rows(driver, module)["turbidity"].editor
        driver.until(lambda field=field: field.value == pytest.approx(HAZE.turbidity, abs=0.01))
    driver.session.send(SetSetting(module="bruneton_sky", name="preset", value="mars-like"))
    radius = rows(driver, "bruneton_sky")["ground_radius_m"].editor
    driver.until(lambda: radius.value == pytest.approx(3_389_500.0))
    phase = rows(driver, "bruneton_sky")["mie_phase"].editor
    assert phase.currentText() == "automatic (Henyey and Greenstein)"


def test_the_comparison_follows_undo(driver):
    """Also to a setting that was left open: the albedo of the ground around the scene again."""
    comparison = driver.panel("compare").comparison
    driver.session.send(SetSetting(module="bruneton_sky", name="albedo", value=0.5))
    driver.until(lambda: comparison.shared["albedo"] == 0.5)
    driver.session.undo()
    ground = ground_of(driver.session)
    driver.until(lambda: comparison.shared["albedo"] == pytest.approx(ground.albedo))


def test_the_axis_of_luminance_has_few_labels_and_all_legible(qtbot):
    """Powers of ten with room between them, or 1, 2 and 5 where the range is small."""
    axis = LogAxis("left")
    for low, high in ((-6.0, 5.0), (2.7, 3.9), (-3.2, -2.9)):
        ((_, labelled), _) = axis.tickValues(low, high, 110.0)
        assert 0 < len(labelled) <= 6
        if len(labelled) > 1:
            assert min(np.diff(labelled)) * 110.0 / (high - low) > 9.0
    assert axis.logTickStrings([-3.0, 0.0, 4.0], 1.0, 1.0) == ["0.001", "1", "10,000"]


def test_what_nothing_is_known_of_shows_no_number(driver):
    """Fog that is none is none: neither its least range of sight nor its middle."""
    assert rows(driver, "bruneton_sky")["fog_visibility_m"].editor.spin.text() == "no fog"


def test_ticking_a_box_leaves_the_air_as_it_is():
    """The air of the settings with all that was none set to what it stood for."""
    from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of

    settings = BrunetonSkySettings()
    ticked = msgspec.structs.replace(settings, **left_open(settings, HAZE, GREY))
    assert ticked.turbidity is not None
    for name, value in vars_of(atmosphere_of(settings, haze=HAZE)).items():
        if value is not None and not isinstance(value, str):
            other = vars_of(atmosphere_of(ticked, haze=HAZE))[name]
            assert np.allclose(other, value, rtol=1e-6), name


def vars_of(air):
    return {name: getattr(air, name) for name in air.__dataclass_fields__}


def test_every_preset_of_every_module_is_accepted():
    """Each value is one that its setting takes, and a line says what for; usual names are there."""
    kernel, _ = daylight_kernel()
    try:
        types = {name: type(seat.settings) for name, seat in kernel.seats.items()}
    finally:
        kernel.close()
    for module, settings in types.items():
        specs = describe(settings)
        for preset in presets_of(settings).values():
            assert preset.values
            assert 5 < len(preset.line) < 80
            for name, value in preset.values.items():
                assert parse(specs[name], module, value) == value
    assert {"Clear", "Hazy", "Desert", "Alpine", "Mars"} <= set(presets_of(types["bruneton_sky"]))
    assert "Overcast" in presets_of(types["clouds"])


def test_a_preset_by_name_sets_what_it_says(driver):
    """The rest of the settings at their defaults."""
    panel = driver.panel("module clouds")
    driver.session.send(EnableModule(module="clouds", enabled=False))
    panel.fill_presets()
    (overcast,) = [a for a in panel.preset_menu.actions() if a.text() == "Overcast"]
    overcast.trigger()
    driver.until(lambda: panel.rows["coverage"].editor.value == 1.0)
    driver.session.send(EnableModule(module="clouds"))


def test_labels_are_words_that_people_know(driver):
    """Labels contain no identifiers."""
    specs = driver.session.catalogue.modules["bruneton_sky"].specs
    assert label_of(specs["cube_device"]) == "Computed on"
    editor = rows(driver, "bruneton_sky")["cube_device"].editor
    assert [editor.itemText(i) for i in range(editor.count())] == ["auto", "CPU", "GPU"]


@pytest.mark.parametrize("unit", ["deg", "\N{DEGREE SIGN}"])
def test_degrees_are_written_in_one_way(qtbot, unit):
    """Their sign, close to the number, whatever a module calls the unit."""
    field = NumberField(0.0, 360.0, unit, decimals=1)
    qtbot.addWidget(field)
    field.show_value(250.0)
    assert field.spin.text() == "250.0\N{DEGREE SIGN}"


def test_a_sky_that_nobody_gives_is_told(driver):
    """All modules with a sky are off: the chooser names none, and a line says what to do."""
    panel = driver.panel("sky")
    assert panel.lack.isHidden()
    modules = ("dynamic_skylight", "bruneton_sky", "weather_sky")
    driver.session.send(*(EnableModule(module=name, enabled=False) for name in modules))
    driver.until_heard(SlotChanged, lambda m: (m.name, m.holder) == ("sky", ""))
    driver.until(lambda: panel.choosers["sky"].currentIndex() == -1)
    assert "no sky" in panel.lack.text()
    assert not panel.lack.isHidden()
    driver.session.send(*(EnableModule(module=name) for name in modules))
    driver.until(panel.lack.isHidden)
    assert lack_line([]) == ""


def test_an_old_fault_of_a_module_that_was_restarted_is_told_as_such():
    """It is no alarm any more."""
    fault = Fault(module="a", where="on_clock", error="it broke")
    assert status_line(None, False, "A") == "No fault so far."
    assert status_line(fault, True, "A") == "No fault since it was restarted. Before: it broke"
    assert status_line(fault, False, "A").startswith("A failed in ")


def test_light_at_night_is_told_in_figures_or_words():
    """Never "0 lx" where there is some, and where there is none why."""
    assert lux_text(0.0021) == "0.0021 lx"
    assert lux_text(43_210.4) == "43,210 lx"
    assert "left out" in lux_text(0.0)
    assert illuminance_text(Illuminance(0.0, 0.0021)) == "0.0021 lx"
    assert illuminance_text(Illuminance(100.0, 20.0)) == "120 lx (sun 100 lx + sky 20 lx)"


def test_the_sun_panel_says_that_the_sun_is_down(driver):
    """Instead of 0 lx; where the moon gives the light, it is the moon's."""
    now = driver.window.desk.scout.day.start
    driver.session.send(SetClock(instant=now))
    sun = driver.until_heard(SunMoved, lambda m: m.elevation_rad < -0.2)
    assert phase_of(sun) != "day"
    sunlight = driver.panel("sun").sunlight
    driver.until(lambda: sunlight.text().startswith("moon, "))
    driver.session.send(EnableModule(module="night_sky", enabled=False))
    driver.until(lambda: "below the horizon" in sunlight.text())
    driver.session.send(EnableModule(module="night_sky"))


def test_a_saved_project_gives_its_name_to_the_window(driver, tmp_path):
    """As an opened one does, until another scene is opened."""
    driver.window.files.save(str(tmp_path / "evening.toml"))
    assert driver.window.windowTitle().startswith("evening.toml[*] \N{EN DASH} sundial.glb")
    driver.window.files.open_path(str(SCENES / "spheres.glb"))
    driver.until(lambda: driver.window.windowTitle().startswith("spheres.glb"))
    driver.window.files.open_path(str(tmp_path / "evening.toml"))
    driver.until(lambda: driver.window.windowTitle().startswith("evening.toml"))

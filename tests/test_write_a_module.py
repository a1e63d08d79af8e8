"""The modules of docs/write_a_module.md run exactly as printed."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest

from vrut_lite import cli
from vrut_lite.daylight.daylight_kernel import FaultCollector, daylight_kernel, demand_light
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.kernel.messages import ChooseSlot, SetSetting
from vrut_lite.project import Project, daylight_inputs

PAGE = Path(__file__).parents[1] / "docs" / "write_a_module.md"
LAMPS, OVERCAST = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)


@pytest.fixture
def kernel(tmp_path, monkeypatch):
    """A kernel that found the page's modules in a folder."""
    (tmp_path / "street_lamps.py").write_text(LAMPS)
    (tmp_path / "overcast_sky.py").write_text(OVERCAST)
    monkeypatch.setenv("VRUT_LITE_MODULES", str(tmp_path))
    monkeypatch.setattr(sys, "path", list(sys.path))
    kernel, failures = daylight_kernel()
    assert failures == []
    faults = FaultCollector(kernel)
    yield kernel
    kernel.close()
    assert faults.faults == []
    for name in ("street_lamps", "overcast_sky"):
        sys.modules.pop(name, None)


def play(kernel, *inputs):
    for message in inputs:
        kernel.inject(message)
    kernel.pump()


def test_the_first_module_is_short():
    """What the page promises: under sixty lines, imports and all."""
    assert len([line for line in LAMPS.splitlines() if line.strip()]) < 60


def test_the_lamps_go_on_at_dusk_and_off_in_the_morning(kernel):
    """A day in Prague, hour by hour: dark lamps by day, lit ones by night, one switch each."""
    switched = []
    kernel.tap(
        lambda message, sender: switched.append(message) if sender == "street_lamps" else None
    )
    for hour in range(24):
        play(kernel, *daylight_inputs(Project(at=f"2026-06-21T{hour:02}:00")))
    changes = [message for message in switched if type(message).__name__ == "LampsSwitched"]
    assert [change.on for change in changes] == [True, False, True]
    assert all((change.illuminance_lux < 30.0) == change.on for change in changes)


def test_a_setting_of_the_lamps_is_held_to_its_bounds(kernel):
    """Bounds and unit come from the settings struct alone."""
    with pytest.raises(Exception, match="between 0 and 1000 lx"):
        kernel.check_setting("street_lamps", "threshold_lux", 2000)
    play(kernel, *daylight_inputs(Project(at="2026-06-21T12:00")))
    assert not kernel.seats["street_lamps"].module.on
    play(kernel, *daylight_inputs(Project(at="2026-06-21T21:25")))
    play(kernel, SetSetting(module="street_lamps", name="threshold_lux", value=1000))
    assert kernel.seats["street_lamps"].module.on


def test_the_third_sky_holds_the_slot(kernel):
    """Chosen, it shows an overcast sky: no sun, E of 300 + 21000 sin(elevation) lux within 1 %."""
    demand_light(kernel, "test", 64)
    project = Project(at="2026-06-21T13:00")
    play(kernel, ChooseSlot(slot="sky", module="overcast_sky"), *daylight_inputs(project))
    background = kernel.last(BackgroundChanged)
    assert background.source == "overcast_sky"
    assert kernel.last(KeyLightChanged).irradiance_rgb == (0.0, 0.0, 0.0)
    cube = decode_float16(background.cube.values, background.radiance_scale)
    expected_lux = 300.0 + 21_000.0 * np.sin(np.radians(63.2))
    np.testing.assert_allclose(horizontal_irradiance(cube) * 683.0, expected_lux, rtol=0.01)
    assert cube[2].max() / cube[0, 31].min() == pytest.approx(3.0, rel=0.05)


def test_the_command_line_finds_it_too(kernel, monkeypatch, capsys, tmp_path):
    """--sky and the settings of a module in a folder, through the very command."""
    output = tmp_path / "overcast.npz"
    arguments = ["sky", "-o", str(output), "--sky", "overcast_sky", "--at", "2026-06-21T12:00Z"]
    monkeypatch.setattr(sys, "argv", ["vrut-lite", *arguments, "--size", "32"])
    cli.main()
    assert str(np.load(output)["skyModel"]) == "overcast_sky"

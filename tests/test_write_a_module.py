"""The modules of docs/write_a_module.md run exactly as printed."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from vrut_lite import cli
from vrut_lite.daylight_kernel import FaultCollector, daylight_kernel, demand_light
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.messages import ChooseSlot, SetSetting
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.project import Project, daylight_inputs

PAGE = Path(__file__).parents[1] / "docs" / "write_a_module.md"
LAMPS, PREETHAM, CONTRACT = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)


@pytest.fixture
def kernel(tmp_path, monkeypatch):
    """A kernel that found the page's modules in a folder."""
    (tmp_path / "street_lamps.py").write_text(LAMPS)
    (tmp_path / "preetham_sky.py").write_text(PREETHAM)
    monkeypatch.setenv("VRUT_LITE_MODULES", str(tmp_path))
    monkeypatch.setattr(sys, "path", list(sys.path))
    kernel, failures = daylight_kernel()
    assert failures == []
    faults = FaultCollector(kernel)
    yield kernel
    kernel.close()
    assert faults.faults == []
    for name in ("street_lamps", "preetham_sky"):
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


def test_the_third_sky_is_one_short_file():
    """Picture, light, air and tolerance in at most 120 lines."""
    assert PREETHAM.count("\n") <= 120


def test_the_third_sky_is_preethams(kernel):
    """At the zenith the paper's luminance, and a sun that is dimmer and redder than outside the
    air."""
    demand_light(kernel, "test", 64)
    project = Project(at="2026-06-21T09:00")
    play(kernel, ChooseSlot(slot="sky", module="preetham_sky"), *daylight_inputs(project))
    background, light = kernel.last(BackgroundChanged), kernel.last(KeyLightChanged)
    assert background.source == light.source == "preetham_sky"
    cube = decode_float16(background.cube.values, background.radiance_scale)
    angle = np.pi / 2.0 - kernel.last(SunMoved).apparent_elevation_rad
    chi = (4.0 / 9.0 - 3.0 / 120.0) * (np.pi - 2.0 * angle)
    paper_cd_m2 = 1000.0 * ((4.0453 * 3.0 - 4.9710) * np.tan(chi) - 0.2155 * 3.0 + 2.4192)
    assert luminance(cube[2, 31, 31]) * 683.0 == pytest.approx(paper_cd_m2, rel=0.02)
    red, _, blue = light.irradiance_rgb
    assert 50.0 < blue < red < 250.0


def test_the_third_sky_passes_the_contract(tmp_path):
    """The tests that the page prints, run as an author runs them."""
    (tmp_path / "preetham_sky.py").write_text(PREETHAM)
    (tmp_path / "test_preetham_sky.py").write_text(CONTRACT)
    paths = [str(tmp_path), *sys.path]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(tmp_path)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert re.search(r"^2\d passed, 4 skipped", done.stdout, re.MULTILINE), done.stdout


def test_the_command_line_finds_it_too(kernel, monkeypatch, capsys, tmp_path):
    """--sky and the settings of a module in a folder, through the very command."""
    output = tmp_path / "preetham.npz"
    arguments = ["sky", "-o", str(output), "--sky", "preetham_sky", "--at", "2026-06-21T12:00Z"]
    monkeypatch.setattr(sys, "argv", ["vrut-lite", *arguments, "--size", "32"])
    cli.main()
    assert str(np.load(output)["skyModel"]) == "preetham_sky"

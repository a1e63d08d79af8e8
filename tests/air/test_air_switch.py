"""Air and light shafts from the project file and the command line to the frame."""

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from vrut_lite.cli import root
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.messages.air import AirChanged
from vrut_lite.project import Project, daylight_inputs, load_project, view_inputs

SQUARE = """
v -50 0 50
v 50 0 50
v 50 0 -50
v -50 0 -50
f 1 2 3 4
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "square.obj"
    path.write_text(SQUARE)
    return path


def test_a_project_says_what_is_drawn(scene, tmp_path):
    """Air is on and shafts are off unless the file says otherwise."""
    for text, wanted in (("", (True, False)), ("air = false\nlight_shafts = true", (False, True))):
        file = tmp_path / "square.toml"
        file.write_text(f'scene = "{scene.name}"\n{text}')
        project = load_project(file)
        assert (project.air, project.light_shafts) == wanted
        settings = [m for m in view_inputs(project) if isinstance(m, SetSetting)]
        assert [(m.name, m.value) for m in settings][:2] == [
            ("air", wanted[0]),
            ("light_shafts", wanted[1]),
        ]


@pytest.mark.gl
def test_switched_off_no_air_is_made_nor_drawn(scene):
    """Without air there is no demand, no table and no drawing; with air there is each."""
    from vrut_lite.host import Host

    project = Project(scene=str(scene), size=(32, 20), air=False)
    with Host(cube_size=16) as host:
        host.inject(*daylight_inputs(project), *view_inputs(project))
        host.draw()
        assert host.kernel.last(AirChanged) is None
        assert host.frame_counters.done["air"] == 0
        assert host.frame_counters.skipped["air: none to be seen"] == 1
        host.inject(SetSetting(module="scene", name="air", value=True))
        host.draw()
        assert host.kernel.last(AirChanged).volume is not None
        assert host.frame_counters.done["air"] == 1


@pytest.mark.gl
def test_the_command_line_switches_the_air(scene, tmp_path):
    """--no-air gives another picture than --air, which is the default."""
    pictures = {}
    for name, options in (("default", []), ("air", ["--air"]), ("none", ["--no-air"])):
        output = tmp_path / f"{name}.png"
        size = ["--size", "32x20", "--at", "2026-06-21T12:00"]
        # From high up, so that the ground is seen through kilometres of air.
        view = ["--eye", "0,5000,0", "--target", "0,4000,-5000"]
        arguments = ["render", str(scene), "-o", str(output), *size, *view, *options]
        result = CliRunner().invoke(root, arguments)
        assert result.exit_code == 0, result.output
        pictures[name] = np.asarray(Image.open(output)).astype(int)
    assert np.array_equal(pictures["default"], pictures["air"])
    assert np.abs(pictures["none"] - pictures["air"]).max() > 10

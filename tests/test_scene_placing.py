"""How a scene stands is said in the project and on the command line, and kept by the window."""

import sys
from pathlib import Path

import numpy as np
import pytest

from vrut_lite import cli
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.messages.placement import PlacedFile, Placement
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.project import Project, load_project, save_project, view_inputs
from vrut_lite.scene.manager import SceneManager

SHEET = "v 0 0 0\nv 400 0 0\nv 400 400 0\nv 0 400 0\nf 1 2 3 4\n"


@pytest.fixture
def sheet(tmp_path):
    """A level sheet of 4 m, Z-up and in centimetres."""
    path = tmp_path / "sheet.obj"
    path.write_text(SHEET)
    return path


def test_a_project_places_its_scenes(tmp_path, sheet):
    """A project file names axes, units and places of several scenes, and is written as read."""
    text = f"""scene = "{sheet.name}"
scene_camera = "gate"
placement = {{up = "z", metres_per_unit = 0.01}}
[[beside]]
scene = "{sheet.name}"
placement = {{up = "z", metres_per_unit = 0.01, position_m = [10, 0, 0], heading_deg = 90}}
"""
    (tmp_path / "two.toml").write_text(text)
    project = load_project(tmp_path / "two.toml")
    assert project.beside[0].placement.position_m == (10.0, 0.0, 0.0)
    (load,) = [message for message in view_inputs(project) if isinstance(message, LoadScene)]
    assert load == LoadScene(
        path=str(sheet),
        placement=Placement(up="z", metres_per_unit=0.01),
        beside=(
            PlacedFile(
                scene=str(sheet),
                placement=Placement(
                    up="z", metres_per_unit=0.01, position_m=(10.0, 0.0, 0.0), heading_deg=90.0
                ),
            ),
        ),
        camera="gate",
    )
    (tmp_path / "deeper").mkdir()
    save_project(tmp_path / "deeper" / "again.toml", project)
    again = load_project(tmp_path / "deeper" / "again.toml")
    for one, other in zip((project, *project.beside), (again, *again.beside), strict=True):
        assert Path(one.scene).resolve() == Path(other.scene).resolve()
        assert one.placement == other.placement


def test_a_projects_settings_name_files_beside_it(tmp_path, monkeypatch):
    """A photograph as the sky is found from any working folder, and saved elsewhere it is still
    the same file; other texts stay as they are."""
    (tmp_path / "here").mkdir()
    (tmp_path / "there").mkdir()
    (tmp_path / "here" / "sky.exr").write_bytes(b"")
    (tmp_path / "here" / "a.toml").write_text(
        'scene = "a.obj"\n[settings.photo_sky]\nphoto = "sky.exr"\nother = "kept.exr"\n'
    )
    monkeypatch.chdir(tmp_path / "there")
    project = load_project(tmp_path / "here" / "a.toml")
    assert Path(project.settings["photo_sky"]["photo"]) == tmp_path / "here" / "sky.exr"
    assert project.settings["photo_sky"]["other"] == "kept.exr"
    save_project("b.toml", project)
    assert '"../here/sky.exr"' in Path("b.toml").read_text()


@pytest.mark.parametrize(
    "wrong",
    [
        {"up": "x"},
        {"metres_per_unit": 0.0},
        {"position_m": (0.0, 1e30, 0.0)},
        {"heading_deg": float("nan")},
    ],
)
def test_an_impossible_placement_is_refused(wrong):
    """No scene is turned, scaled or moved by what is no axis, length or place."""
    with pytest.raises(UserError):
        LoadScene(path="a.obj", placement=Placement(**wrong)).check()


def test_the_opened_scene_tells_how_it_stands(sheet):
    """What was asked for comes back with what was guessed, for a panel and a saved project."""
    kernel = Kernel()
    kernel.add_module(SceneManager)
    asked = LoadScene(
        path=str(sheet),
        placement=Placement(up="z", metres_per_unit=0.01),
        beside=(PlacedFile(scene=str(sheet), placement=Placement(position_m=(5.0, 0.0, 0.0))),),
    )
    kernel.inject(asked)
    kernel.pump_until_idle()
    opened = kernel.last(SceneOpened)
    np.testing.assert_allclose(opened.upper_m, [9.0, 4.0, 0.0])
    np.testing.assert_allclose(opened.lower_m, [0.0, 0.0, -4.0])
    assert opened.opened.placement == asked.placement
    assert opened.opened.beside[0].placement.metres_per_unit == 0.01


def test_the_command_line_says_axis_and_unit(sheet, tmp_path, monkeypatch, capsys):
    """--up and --metres-per-unit reach the scene; notices go to the error stream."""
    sheet.write_text(SHEET + "l 1 2\n")
    journal = tmp_path / "day.mcap"
    monkeypatch.setattr(
        sys,
        "argv",
        ["vrut-lite", "record", str(sheet), "-o", str(journal), "--up", "z",
         "--metres-per-unit", "0.01"],
    )  # fmt: skip
    cli.main()
    assert "vrut-lite: points or lines: one pixel wide" in capsys.readouterr().err
    monkeypatch.setattr(sys, "argv", ["vrut-lite", "dump", str(journal)])
    cli.main()
    said = capsys.readouterr().out
    assert '"up": "z"' in said or '"up":"z"' in said


def test_no_scene_no_axis(monkeypatch, capsys, tmp_path):
    """Axes of nothing are refused."""
    journal = str(tmp_path / "a.mcap")
    monkeypatch.setattr(sys, "argv", ["vrut-lite", "record", "-o", journal, "--up", "z"])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert end.value.code == 2
    assert "need a scene" in capsys.readouterr().err


def test_a_project_without_placement_stays_short(tmp_path):
    """Defaults are not written."""
    save_project(tmp_path / "a.toml", Project(scene="a.obj"))
    text = (tmp_path / "a.toml").read_text()
    assert not any(word in text for word in ("placement", "beside", "null", "up ="))

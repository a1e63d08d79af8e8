"""The command `vrut-lite daylight`: files that it writes, and one line for bad input."""

import csv
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from daylight_numbers.command import daylight
from daylight_numbers.glass import glass_of

from vrut_lite.errors import UserError
from vrut_lite.messages.glazing import Glazing
from vrut_lite.project import Project, load_project, save_project
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed


def run(*arguments):
    found = CliRunner().invoke(daylight, [str(a) for a in arguments], catch_exceptions=False)
    assert found.exit_code == 0
    return found.output


def test_bad_sensors_are_refused_before_the_scene_is_opened(tmp_path):
    path = tmp_path / "desks.csv"
    path.write_text("1,2,nan\n")
    with pytest.raises(UserError, match="no finite point"):
        run("none.glb", "-o", tmp_path / "out", "--sensors", path)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["none.glb", "--sun-day", "05-01"], "05-01 is not from 02-01 to 03-21"),
        (["a/room.glb", "b/room.glb"], "two scenes have one name"),
        (["none.glb", "--eyes", "none.csv"], "cannot read the sensors none.csv"),
    ],
)
def test_what_cannot_be_measured_is_refused_before_a_scene_is_opened(tmp_path, arguments, sentence):
    with pytest.raises(UserError, match=sentence):
        run(*arguments, "-o", tmp_path / "out")


def test_glazing_of_no_material_of_the_scene_is_refused():
    """In one line, with the names that there are."""
    materials = SimpleNamespace(all=lambda: [SimpleNamespace(name="pane")])
    scene = SimpleNamespace(materials=materials)
    surfaces = SimpleNamespace(part=np.zeros(2, np.int32))
    with pytest.raises(UserError, match="no material 'glas'; it has pane"):
        glass_of(scene, surfaces, {"glas": Glazing(0.7)})


def test_glazing_of_a_project_is_glass_in_pictures():
    """Its material has KHR_materials_transmission's terms: 0.72 of light at right angles passes."""
    path = Path(__file__).parents[2] / "scenes" / "work" / "indoor.glb"
    scene = packed(load_scene(path, glazing={"brass": Glazing(0.72)}))
    brass = next(one for one in scene.materials.all() if one.name == "brass")
    assert brass.terms.transmits
    assert brass.terms.is_pane
    face = 0.04
    clear = (1 - face) / (1 + face)
    np.testing.assert_allclose(brass.base_colour_rgba[:3], 0.72 / clear)


def test_glazing_is_kept_in_project_files(tmp_path):
    project = Project(scene="room.glb", glazing={"pane": Glazing(0.7, panes=3)})
    save_project(tmp_path / "room.toml", project)
    assert load_project(tmp_path / "room.toml").glazing == project.glazing


@pytest.mark.long
def test_a_room_has_its_tables_plans_and_page(tmp_path):
    """By the installed sky, through the real kernel."""
    eyes = tmp_path / "eyes.csv"
    eyes.write_text("0,1.2,0,-1,0,0\n")
    where = "--at", "2026-03-21T12:00", "--eyes", eyes
    said = run("scenes/work/indoor.glb", "-o", tmp_path, "--grid", 1, *where)
    assert "room 1" in said
    assert "eye 1: DGP" in said
    rows = list(csv.DictReader((tmp_path / "sensors.csv").open()))
    arrays = np.load(tmp_path / "sensors.npz")
    lux = np.array([float(row["illuminance_lx"]) for row in rows])
    np.testing.assert_allclose(lux, arrays["illuminance_lx"], rtol=1e-5)
    parts = sum(arrays[f"of_{part}_lx"] for part in ("sun", "sky", "surfaces"))
    np.testing.assert_allclose(parts, arrays["illuminance_lx"])
    assert (arrays["illuminance_error_lx"] < 0.05 * lux).all()
    page = (tmp_path / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 4
    assert "CIE sky type 16" in page

"""The command `vrut-lite daylight`: files that it writes, and one line for bad input."""

import csv
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from boxes import box
from click.testing import CliRunner
from daylight_numbers.command import daylight, with_bsdf
from daylight_numbers.glazing.glass import glass_of
from daylight_numbers.glazing.pane_materials import pane_materials
from light_transport.surfaces.surfaces import surfaces_of
from window_xml_files import diffuser, window_xml

from vrut_lite.errors import UserError
from vrut_lite.messages.glazing import Glazing, GlazingFile
from vrut_lite.project import Project, load_project, save_project
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed

ROOM = Path(__file__).parents[2] / "scenes" / "work" / "indoor.glb"


def run(*arguments):
    found = CliRunner().invoke(daylight, [str(a) for a in arguments], catch_exceptions=False)
    assert found.exit_code == 0
    return found.output


def test_bad_sensors_are_refused_before_the_scene_is_opened(tmp_path):
    path = tmp_path / "desks.csv"
    path.write_text("1,2,nan\n")
    with pytest.raises(UserError, match="no finite point"):
        run("none.glb", "-o", tmp_path / "out", "--sensors", path)
    # A refusal leaves no folder.
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["none.glb", "--sun-day", "05-01"], "05-01 is not from 02-01 to 03-21"),
        (["none.glb", "--before", "old.glb"], "--before needs --standards"),
        (["none.glb", "--sun-range", "2026-02-08"], "2026-02-08 is no range of days"),
        (["none.glb", "--sun-range", "2026-02-30..2026-03-01"], "is no range of days"),
        (["none.glb", "--sun-range", "2026-03-02..2026-03-01"], "from an earlier to a later day"),
        (["none.glb", "--sun-range", "1900-03-01..1900-03-02"], "outside the years 1950 to 2050"),
        (["none.glb", "--totals", "month"], "--totals are those of a year: add --year"),
        (["none.glb", "--year", "--totals", "week"], "--totals week is neither month nor a range"),
        (["none.glb", "--year", "--totals", "02-30..03-01"], "is neither month nor a range"),
        (["none.glb", "--year", "--totals", "10-01..03-01"], "from an earlier to a later day"),
        (["a/room.glb", "b/room.glb"], "two scenes have one name"),
        (["none.glb", "--eyes", "none.csv"], "cannot read the sensors none.csv"),
        (["none.glb", "--bsdf", "glass"], "--bsdf glass is not MATERIAL=FILE"),
        (["none.glb", "--bsdf-up", "0,1,0"], "--bsdf-up needs files of measured glazing"),
        (["none.glb", "--bsdf", "a=b", "--bsdf-up", "0,0,0"], "--bsdf-up 0,0,0 is not X,Y,Z"),
        (["none.glb", "--bsdf", "a=b", "--bsdf-up", "0,nan,0"], "--bsdf-up 0,nan,0 is not X,Y,Z"),
        (["none.glb", "--bsdf", "a=b", "--bsdf-up", "0,1"], "--bsdf-up 0,1 is not X,Y,Z"),
        (["none.glb", "--bsdf-rule", "a=sun:5"], "--bsdf-rule moves blinds in a year: add --year"),
        (["none.glb", "--year", "--bsdf-rule", "a=sun:5"], "name the files of a by --bsdf"),
        (
            ["none.glb", "--year", "--bsdf", "a=b", "--bsdf-rule", "a=sun:x"],
            "--bsdf-rule a=sun:x is not MATERIAL=RULE",
        ),
        (["none.glb", "--year", "--bsdf", "a=b", "--bsdf-rule", "a=glow"], "is not MATERIAL=RULE"),
        (["none.glb", "--bsdf", "a=b", "--bsdf", "a=c"], "--bsdf of a: a blind that moves has"),
        (["none.glb", "--bsdf", "glass=none.xml"], "cannot read the Window XML none.xml"),
    ],
)
def test_what_cannot_be_measured_is_refused_before_a_scene_is_opened(tmp_path, arguments, sentence):
    with pytest.raises(UserError, match=sentence):
        run(*arguments, "-o", tmp_path / "out")


def test_a_blind_by_glare_needs_eyes(tmp_path):
    blind = tmp_path / "blind.xml"
    blind.write_text(window_xml({"Transmission Front": diffuser(0.5)}))
    states = "--bsdf", f"a={blind}", "--bsdf", f"a={blind}", "--bsdf-rule", "a=glare"
    with pytest.raises(UserError, match="a blind that moves by glare needs eyes"):
        run("none.glb", "-o", tmp_path / "out", "--year", *states)


def test_options_come_before_a_projects_measured_glazing():
    """A file for the same material takes the project's place and keeps its up unless told."""
    project = Project(bsdf={"pane": GlazingFile("old.xml", up=(0.0, 0.0, 1.0))})
    found = with_bsdf(project, ("pane=new.xml", "roof=flat.xml")).bsdf
    assert found["pane"] == GlazingFile("new.xml", up=(0.0, 0.0, 1.0))
    assert found["roof"] == GlazingFile("flat.xml")
    rule = with_bsdf(project, ("pane=a.xml", "pane=b.xml"), None, ("pane=sun:5000@60",))
    assert rule.bsdf["pane"] == GlazingFile(
        "a.xml", (0.0, 0.0, 1.0), ("b.xml",), "sun", sun_lx=(5000.0,), within_deg=60.0
    )
    turned = with_bsdf(project, ("pane=new.xml",), "1,0,0").bsdf
    assert turned["pane"] == GlazingFile("new.xml", up=(1.0, 0.0, 0.0))


@pytest.mark.parametrize("up", ["[0.0, 0.0, 0.0]", "[nan, 0.0, 1.0]", "[1.0, 0.0]"])
def test_a_project_with_an_impossible_up_is_refused(tmp_path, up):
    path = tmp_path / "room.toml"
    path.write_text(f'scene = "room.glb"\n[bsdf.glass]\nfile = "blind.xml"\nup = {up}\n')
    with pytest.raises(UserError, match="bsdf"):
        load_project(path)


def test_measured_glazing_of_no_material_of_the_scene_is_refused():
    """In one line, with the names that there are."""
    scene = packed(load_scene(ROOM))
    with pytest.raises(UserError, match="bsdf: the scene has no material 'glas'; it has "):
        pane_materials(scene, surfaces_of(scene), {"glas": GlazingFile("none.xml")})


def test_glazing_of_no_material_of_the_scene_is_refused():
    """In one line, with the names that there are."""
    materials = SimpleNamespace(all=lambda: [SimpleNamespace(name="pane")])
    scene = SimpleNamespace(materials=materials)
    surfaces = SimpleNamespace(part=np.zeros(2, np.int32))
    with pytest.raises(UserError, match="no material 'glas'; it has pane"):
        glass_of(scene, surfaces, {"glas": Glazing(0.7)})


def test_glazing_of_a_project_is_glass_in_pictures():
    """Its material has KHR_materials_transmission's terms: 0.72 of light at right angles passes."""
    scene = packed(load_scene(ROOM, glazing={"brass": Glazing(0.72)}))
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


def glazed_house(folder):
    """A room of 4 x 3 x 4 m in an OBJ file, whose side +x is all pane."""
    sides = box((-2.0, 0.0, -2.0), (2.0, 3.0, 2.0), inwards=True)
    lines, count = ["mtllib house.mtl"], 0
    for number, quad in enumerate(sides):
        lines += [f"v {x} {y} {z}" for x, y, z in quad]
        lines.append("usemtl glass" if number == 0 else "usemtl wall")
        lines.append("f " + " ".join(str(count + k + 1) for k in range(4)))
        count += 4
    (folder / "house.mtl").write_text("newmtl glass\nKd 1 1 1\nnewmtl wall\nKd 0.5 0.5 0.5\n")
    path = folder / "house.obj"
    path.write_text("\n".join(lines))
    return path


@pytest.mark.long
def test_variants_have_the_numbers_of_runs_of_their_own(tmp_path):
    """Two orientations of one room, which share rays, and a darker pane, beside three commands."""
    glazed_house(tmp_path)
    sides = tmp_path / "sides.toml"
    sides.write_text(
        "[south]\nnorth_offset_deg = 90\n[east]\nnorth_offset_deg = 0\n"
        '[dark.glazing."glass"]\ntransmittance = 0.2\n'
    )
    clear, dark = (tmp_path / f"{name}.toml" for name in ("clear", "dark_house"))
    for project, share in ((clear, 0.7), (dark, 0.2)):
        project.write_text(
            f'scene = "house.obj"\nplace = "50,14"\n[glazing."glass"]\ntransmittance = {share}\n'
        )
    common = (
        "--grid", 1.5, "--tolerance", "50%", "--at", "2026-03-21T10:00", "--sky",
        "dynamic_skylight",
    )  # fmt: skip
    run(clear, *common, "-o", tmp_path / "all", "--variants", sides)
    run(clear, *common, "-o", tmp_path / "south", "--north-offset", 90)
    run(clear, *common, "-o", tmp_path / "east")
    run(dark, *common, "-o", tmp_path / "dark")
    lux = {}
    for name in ("south", "east", "dark"):
        one, other = (np.load(tmp_path / part / name / "sensors.npz")
                      for part in ("all", "."))  # fmt: skip
        for column in ("illuminance_lx", "daylight_factor_percent", "sun_h"):
            np.testing.assert_allclose(one[column], other[column], rtol=1e-6, err_msg=name)
        lux[name] = one["illuminance_lx"].mean()
    assert abs(lux["south"] / lux["east"] - 1.0) > 0.1
    assert lux["dark"] < 0.5 * lux["east"]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "has 0 variants"),
        ("[a", "are no TOML"),
        ("['../a']", "has no name that a folder may have"),
        ("[a]\nnorth = 3", "the variant a: Object contains unknown field `north`"),
        ("[a]\nnorth_offset_deg = 400", "the variant a: Expected `float` <= 360"),
        ("[a.glazing.glass]\ntransmittance = 2", "the variant a: Expected `float` <= 1"),
    ],
)
def test_variants_that_say_nothing_possible_are_refused(tmp_path, text, sentence):
    path = tmp_path / "sides.toml"
    path.write_text(text)
    with pytest.raises(UserError, match=sentence):
        run("none.glb", "-o", tmp_path / "out", "--variants", path)


def test_variants_are_of_one_scene(tmp_path):
    with pytest.raises(UserError, match="--variants are of one scene in one process"):
        run("a.glb", "b.glb", "-o", tmp_path / "out", "--variants", "sides.toml")


@pytest.mark.long
def test_a_room_behind_a_measured_pane_has_half_the_light_of_a_clearer_one(tmp_path):
    """An hour and a year by the installed sky: diffusers of 0.6 and 0.3, sDA without other
    blinds."""
    house, lux = glazed_house(tmp_path), {}
    for share in (0.6, 0.3):
        path = tmp_path / f"{share}.xml"
        path.write_text(window_xml({"Transmission Front": diffuser(share)}))
        out = tmp_path / f"out{share}"
        said = run(house, "-o", out, "--grid", 1, "--year", "--bsdf", f"glass={path}")
        assert "blinds closed by measured panes" in said
        arrays = np.load(out / "sensors.npz")
        assert not arrays["of_sun_lx"].any()
        lux[share] = arrays["illuminance_lx"], arrays["dose_klxh"]
    for whole, half in zip(lux[0.6], lux[0.3], strict=True):
        assert whole.min() > 0.0
        np.testing.assert_allclose(half, 0.5 * whole, rtol=0.01)
    # A blind that is always shut has the darker year, and its months sum to it.
    shut, eyes, out = (tmp_path / name for name in ("shut.csv", "eyes.csv", "moving"))
    shut.write_text((",".join("1" * 24) + "\n") * 12)
    eyes.write_text("0,1.2,0,1,0,0\n")
    states = [part for share in (0.6, 0.3) for part in ("--bsdf", f"glass={tmp_path}/{share}.xml")]
    said = run(
        house, "-o", out, "--grid", 1, "--year", *states, "--bsdf-rule", f"glass=schedule:{shut}",
        "--eyes", eyes, "--totals", "month",
    )  # fmt: skip
    dose = np.load(out / "sensors.npz")["dose_klxh"]
    np.testing.assert_allclose(dose, lux[0.3][1], rtol=1e-5)
    rows = list(csv.DictReader((out / "totals.csv").open()))
    months = np.array([float(row["dose_klxh"]) for row in rows]).reshape(-1, 12)
    np.testing.assert_allclose(months.sum(axis=1), dose, rtol=1e-3)
    for heading in ("Totals: ", "Blinds that move, 8:00 to 18:00: glass", "Glare, share of "):
        assert heading in said
    page = (tmp_path / "out0.3" / "report.html").read_text()
    assert "glass is sample (LBNL/Klems Full): it passes 30.0 % of visible light" in page

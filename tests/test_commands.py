"""The commands and their output files."""

import shutil
import sys
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image

from vrut_lite import cli
from vrut_lite.commands.demo import scene_projects
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.project import Project, load_project

SCENES = Path(__file__).parents[1] / "scenes"
EVENING = ["--at", "2026-06-21T19:30", "--place", "50.0755,14.4378"]


@pytest.fixture
def vrut_lite(monkeypatch, capsys):
    """Run the command line, which must succeed; returns its output."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["vrut-lite", *map(str, arguments)])
        cli.main()
        return capsys.readouterr().out

    return run


def read_exr(path):
    part = OpenEXR.File(str(path)).parts[0]
    return part.channels["RGB"].pixels, part.header


def test_help_shows_every_command_with_an_example(vrut_lite):
    """--help lists the commands, with an example for each."""
    listing = vrut_lite("--help")
    for command in ("render", "sky", "modules", "demo"):
        assert command in listing
        assert "Example: vrut-lite" in vrut_lite(command, "--help")


@pytest.mark.parametrize("command", ["bench", "study"])
def test_without_the_laboratory_its_commands_say_what_to_install(
    vrut_lite, monkeypatch, capsys, command
):
    """The product's wheel lists none of them; a call prints one line that says what to install."""
    product = [
        point
        for point in cli.usable_points(cli.GROUP)
        if not point.module.startswith("vrut_lite_lab")
    ]
    monkeypatch.setattr(cli, "usable_points", lambda group: product)
    assert command not in vrut_lite("--help").split()
    with pytest.raises(SystemExit) as exit_:
        vrut_lite(command, "--quick", "-o", "page.html")
    assert exit_.value.code == 2
    assert capsys.readouterr().err == (
        f"vrut-lite: {command} needs the package vrut-lite-lab: in a checkout, run pip install "
        "./lab\n"
    )


def test_settings_of_modules_are_options(vrut_lite):
    """The modules' settings are options, with bounds and units."""
    text = " ".join(vrut_lite("render", "--help").split())
    assert "--albedo" in text
    assert "between 0 and 1" in text


def test_modules_lists_slots_and_settings(vrut_lite):
    """Both skies, the holder of each slot, and all settings are listed."""
    listing = vrut_lite("modules")
    assert "sky (holds it)" in listing
    assert "bruneton_sky" in listing
    assert "albedo = none" in listing


@pytest.mark.parametrize("sky", ["dynamic_skylight", "bruneton_sky"])
def test_a_panorama_has_the_sun_where_its_metadata_says(vrut_lite, tmp_path, sky):
    """The brightest sky is at the sun's azimuth; elevation and irradiance are in the header."""
    path = tmp_path / "sky.exr"
    vrut_lite("sky", "-o", path, "--size", 128, "--sky", sky, *EVENING)
    picture, header = read_exr(path)
    assert picture.shape == (128, 256, 3)
    azimuth_deg = header["sunAzimuthDeg"][0]
    row, column = np.unravel_index(picture.sum(axis=-1).argmax(), picture.shape[:2])
    seen_deg = ((column + 0.5) / 256 * 360.0 - 180.0) % 360.0
    assert abs((seen_deg - azimuth_deg + 180.0) % 360.0 - 180.0) < 3.0
    assert row < 64
    assert header["skyModel"] == sky
    direction = np.array(header["sunDirection"].split(), float)
    angles = np.radians([azimuth_deg, header["sunElevationDeg"][0]])
    np.testing.assert_allclose(direction, world_from_enu(direction_from_angles(*angles)), atol=2e-3)


def test_all_sky_formats_hold_one_picture(vrut_lite, tmp_path):
    """EXR and npz are equal; HDR is RGBE, 1/256 of a pixel's largest channel; PNG is for eyes."""
    for suffix in ("exr", "npz", "hdr", "png"):
        vrut_lite("sky", "-o", tmp_path / f"sky.{suffix}", "--size", 64, *EVENING)
    exr, _ = read_exr(tmp_path / "sky.exr")
    npz = np.load(tmp_path / "sky.npz")
    np.testing.assert_array_equal(npz["radiance"], exr)
    assert npz["skyModel"] == "dynamic_skylight"
    assert (tmp_path / "sky.hdr").read_bytes().startswith(b"#?RADIANCE")
    assert Image.open(tmp_path / "sky.png").size == (128, 64)


def test_a_cube_stays_a_cube_in_npz_and_unfolds_in_pictures(vrut_lite, tmp_path):
    """npz holds (6, n, n, 3) in world axes, pictures an unfolded cross."""
    vrut_lite("sky", "-o", tmp_path / "cube.npz", "--projection", "cube", "--size", 32, *EVENING)
    vrut_lite("sky", "-o", tmp_path / "cube.png", "--projection", "cube", "--size", 32, *EVENING)
    assert np.load(tmp_path / "cube.npz")["cube"].shape == (6, 32, 32, 3)
    assert Image.open(tmp_path / "cube.png").size == (128, 96)


def test_a_fisheye_is_black_outside_its_circle(vrut_lite, tmp_path):
    """Pixels outside the circle are black."""
    path = tmp_path / "fish.exr"
    vrut_lite("sky", "-o", path, "--projection", "fisheye", "--size", 64, *EVENING)
    picture, _ = read_exr(path)
    assert (picture[0, 0] == 0).all()
    assert (picture[32, 32] > 0).all()


def test_haze_is_followed_and_a_skys_own_is_set_by_name(vrut_lite, tmp_path):
    """--turbidity is the haze of every sky, --set that of one: the same sky to the digit."""
    skies = {}
    for turbidity in ("2", "6"):
        path = tmp_path / f"{turbidity}.npz"
        vrut_lite("sky", "-o", path, "--size", 32, "--turbidity", turbidity, *EVENING)
        skies[turbidity] = np.load(path)["radiance"]
    assigned = ["--set", "dynamic_skylight.turbidity=6"]
    vrut_lite("sky", "-o", tmp_path / "set.npz", "--size", 32, *assigned, *EVENING)
    assert not np.allclose(skies["2"], skies["6"], rtol=0.05)
    np.testing.assert_array_equal(np.load(tmp_path / "set.npz")["radiance"], skies["6"])


@pytest.mark.gl
def test_none_is_given_only_to_settings_that_allow_it(vrut_lite, tmp_path):
    """Bruneton's sky accepts an albedo "none" (the preset's), the other module does not."""
    said = ["--at", "2026-06-21T12:00Z", "--place", "50,14", "--size", "16"]
    open_ = tmp_path / "open.npz"
    plain = tmp_path / "plain.npz"
    said += ["--sky", "bruneton_sky"]
    vrut_lite("sky", *said, "--albedo", "none", "-o", open_)
    vrut_lite("sky", *said, "-o", plain)
    with np.load(open_) as one, np.load(plain) as other:
        np.testing.assert_array_equal(one["radiance"], other["radiance"])


def test_a_project_file_renders_like_its_options(vrut_lite, tmp_path):
    """The same input as a project and as options gives equal pixels."""
    scene = SCENES / "spheres.glb"
    project = tmp_path / "project.toml"
    project.write_text(
        f'scene = "{scene}"\nplace = "50.0755,14.4378"\nat = "2026-06-21T19:30"\n'
        "size = [96, 64]\n[settings.dynamic_skylight]\nturbidity = 5\n"
        '[exposure]\nmode = "manual"\nev100 = 13\n'
    )
    vrut_lite("render", project, "-o", tmp_path / "project.exr")
    options = ["--turbidity", "5", "--size", "96x64", "--exposure", "13", *EVENING]
    vrut_lite("render", scene, "-o", tmp_path / "options.exr", *options)
    by_project, header = read_exr(tmp_path / "project.exr")
    by_options, _ = read_exr(tmp_path / "options.exr")
    np.testing.assert_array_equal(by_project, by_options)
    assert header["setting_turbidity"] == "5.0"
    assert header["latitudeDeg"][0] == 50.0755


@pytest.mark.long
@pytest.mark.gl
def test_the_demo_renders_every_scene_at_four_hours(vrut_lite, tmp_path):
    """Four pictures for each bundled scene, and a contact sheet; noon is brighter than dusk."""
    scenes = tmp_path / "scenes"
    scenes.mkdir()
    for path in (path for path in SCENES.iterdir() if path.is_file()):
        shutil.copy(path, scenes)
    # The size does not matter here.
    for name in ("pavilion.gltf", "spheres.glb", "street.obj", "sundial.glb"):
        project = scenes / f"{Path(name).stem}.toml"
        text = project.read_text() if project.exists() else f'scene = "{name}"\n'
        project.write_text(f"size = [96, 54]\n{text}")
    said = vrut_lite("demo", "--out", tmp_path / "out", "--scenes", scenes)
    names = {"pavilion", "spheres", "street", "sundial"}
    hours = ("sunrise", "noon", "late_afternoon", "dusk")
    made = {path.name for path in (tmp_path / "out").iterdir()}
    assert made == {f"{n}_{h}.png" for n in names for h in hours} | {"contact_sheet.png"}
    assert "16 pictures" in said
    texts = [Image.open(tmp_path / "out" / f"sundial_{hour}.png").text for hour in hours]
    elevations = [float(text["sunElevationDeg"]) for text in texts]
    np.testing.assert_allclose(elevations[0], 2.0, atol=0.3)
    np.testing.assert_allclose(elevations[2:], [14.0, -4.0], atol=0.3)
    assert elevations[1] > 55.0


def test_a_bare_toml_date_is_a_local_time(tmp_path):
    """at = 2026-06-21T19:30:00 without quotes is a TOML date and is accepted."""
    path = tmp_path / "project.toml"
    path.write_text('scene = "a.glb"\nat = 2026-06-21T19:30:00\n')
    project = load_project(path)
    assert project.instant() == Project(at="2026-06-21T19:30").instant()


@pytest.mark.gl
def test_fov_changes_a_projects_camera(vrut_lite, tmp_path):
    """--fov alone changes the project's field of view."""
    for name, options in (("wide", []), ("narrow", ["--fov", "20"])):
        arguments = ["-o", tmp_path / f"{name}.exr", "--size", "96x64", *options, *EVENING]
        vrut_lite("render", SCENES / "sundial.toml", *arguments)
    wide, narrow = (read_exr(tmp_path / f"{name}.exr")[0] for name in ("wide", "narrow"))
    assert not np.allclose(wide, narrow, rtol=0.1)


def test_a_project_and_its_scene_are_one(tmp_path):
    """A scene beside its project is drawn by it, whichever ending the project has."""
    for name in ("a", "b", "c"):
        shutil.copy(SCENES / "sundial.glb", tmp_path / f"{name}.glb")
    for name in ("a.toml", "b.vrut.toml"):
        (tmp_path / name).write_text(f'scene = "{name[0]}.glb"\nsize = [32, 32]\n')
    found = scene_projects(tmp_path)
    assert {name: project.size for name, project in found.items()} == {
        "a": (32, 32),
        "b": (32, 32),
        "c": Project().size,
    }


@pytest.mark.long
@pytest.mark.gl
def test_the_demo_uses_what_a_project_says(vrut_lite, tmp_path):
    """Slots and settings of a project apply to its own pictures only."""
    folder = tmp_path / "scenes"
    folder.mkdir()
    shutil.copy(SCENES / "sundial.glb", folder / "a.glb")
    shutil.copy(SCENES / "sundial.glb", folder / "b.glb")
    (folder / "b.toml").write_text('scene = "b.glb"\nsize = [32, 32]\n')
    (folder / "a.toml").write_text(
        'scene = "a.glb"\nsize = [32, 32]\n[slots]\nsky = "bruneton_sky"\n'
        "[settings.bruneton_sky]\nturbidity = 5\n"
    )
    vrut_lite("demo", "--out", tmp_path / "out", "--scenes", folder)
    texts = [Image.open(tmp_path / "out" / f"{name}_noon.png").text for name in "ab"]
    assert [text["skyModel"] for text in texts] == ["bruneton_sky", "dynamic_skylight"]
    assert texts[0]["setting_turbidity"] == "5.0"

"""Bad input gets one clear sentence and exit code 2, and leaves no half-written file."""

import os
import sys

import pytest
import trimesh

from vrut_lite import cli
from vrut_lite.errors import UserError
from vrut_lite.pictures.image_files import check_writable

CAMERA_AT = 'scene = "good.glb"\n[camera]\n'
GOOD_TIME = ["--at", "2026-06-21T12:00Z"]


@pytest.fixture
def good_scene(tmp_path):
    path = tmp_path / "good.glb"
    trimesh.creation.box((1, 1, 1)).export(path)
    return path


def run(monkeypatch, capsys, *arguments):
    """Exit code and standard error of the command line."""
    monkeypatch.setattr(sys, "argv", ["vrut-lite", *map(str, arguments)])
    with pytest.raises(SystemExit) as end:
        cli.main()
    return end.value.code, capsys.readouterr().err


@pytest.fixture
def refused(monkeypatch, capsys, tmp_path):
    """Run a command that must fail: one line, exit code 2, the old picture unchanged."""

    def check(*arguments, says):
        output = tmp_path / "picture.png"
        output.write_bytes(b"what was there before")
        before = sorted(path.name for path in tmp_path.iterdir())
        code, said = run(monkeypatch, capsys, *arguments, "-o", output)
        assert code == 2, said
        assert said.count("\n") == 1, said
        assert "Traceback" not in said
        assert says in said
        assert output.read_bytes() == b"what was there before"
        assert sorted(path.name for path in tmp_path.iterdir()) == before

    return check


@pytest.mark.gl
def test_a_corrupt_scene(refused, tmp_path):
    """As after a download that broke off; tests/scene/test_bad_scenes.py has all other damage."""
    whole = tmp_path / "whole.glb"
    trimesh.creation.box((1, 1, 1)).export(whole)
    broken = tmp_path / "broken.glb"
    broken.write_bytes(whole.read_bytes()[:200])
    refused("render", broken, *GOOD_TIME, says="cannot open the scene")


@pytest.mark.parametrize(
    ("at", "says"),
    [
        *(
            (at, "2026-06-21T18:30")
            for at in ("2026-02-30T12:00", "2026-06-21T25:00", "tomorrow", "")
        ),
        ("2026-03-29T02:30", "2026-03-29T03:30+02:00"),
        ("2026-10-25T02:30", "2026-10-25T02:30+01:00"),
    ],
)
def test_an_impossible_time(refused, good_scene, at, says):
    """Dates that do not exist, and hours that clocks skip or show twice; the sentence has one that
    can be pasted."""
    refused("render", good_scene, "--at", at, "--place", "50.0755,14.4378", says=says)


@pytest.mark.parametrize("place", ["91,0", "-90.1,0", "nan,0", "Prague", "1,2,3,4"])
def test_an_impossible_place(refused, good_scene, place):
    """A latitude beyond 90 degrees is refused."""
    refused("render", good_scene, *GOOD_TIME, "--place", place, says="latitude")


@pytest.mark.parametrize("turbidity", ["0", "11", "nan", "hazy"])
def test_an_impossible_turbidity(refused, good_scene, turbidity):
    """Turbidity outside 1 to 10 is refused."""
    arguments = ["render", good_scene, *GOOD_TIME, "--turbidity", turbidity]
    refused(*arguments, says="'--turbidity'")


@pytest.mark.parametrize("depth", ["-0.1", "0.91", "nan", "hazy"])
def test_an_impossible_haze(refused, good_scene, depth):
    """An optical depth is from 0 to that of turbidity 10, the haziest that both skies know."""
    refused("render", good_scene, *GOOD_TIME, "--haze", depth, says="'--haze'")


def test_haze_in_two_words(refused, good_scene):
    """Turbidity is an alias of the optical depth: nobody can say which of two was meant."""
    arguments = ["render", good_scene, *GOOD_TIME, "--haze", "0.2", "--turbidity", "3"]
    refused(*arguments, says="--haze and --turbidity name the same thing")


def test_an_unknown_sky_module(refused, good_scene):
    """The sentence lists the existing modules."""
    arguments = ["render", good_scene, *GOOD_TIME, "--sky", "bruneton"]
    refused(*arguments, says="installed are air, aurora, bruneton_sky, clouds")


def test_an_unknown_setting(refused, good_scene):
    """The sentence lists the module's settings."""
    arguments = ["render", good_scene, *GOOD_TIME, "--set", "dynamic_skylight.haze=3"]
    refused(*arguments, says="no setting 'haze'")


@pytest.mark.parametrize(
    ("name", "says"), [("no_such_folder/picture.png", "no folder"), ("picture.jpeg", ".png")]
)
def test_an_unusable_output(monkeypatch, capsys, good_scene, tmp_path, name, says):
    """A folder that is not there, or an unknown suffix, is refused before the work."""
    picture = tmp_path / name
    code, said = run(monkeypatch, capsys, "render", good_scene, *GOOD_TIME, "-o", picture)
    assert (code, said.count("\n")) == (2, 1)
    assert says in said


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("scene = ", "project"),
        ('place = "50,14"', "names no scene"),
        ('scene = "good.glb"\nhour = 12', "hour"),
        ('scene = "good.glb"\nplace = "95,14"', "latitude"),
        ('scene = "good.glb"\n[settings.dynamic_skylight]\nturbidity = 12', "between 1 and 10"),
        ('scene = "good.glb"\n[haze]\noptical_depth_550 = 2', "haze.optical_depth_550"),
        ('scene = "good.glb"\n[haze]\naerosol = "one-lobe"', "optical_depth_550"),
        ('scene = "good.glb"\n[haze]\noptical_depth_550 = 0.1\naerosol = "x"', "haze.aerosol"),
        ('scene = "good.glb"\n[slots]\nsky = "moon"', "no module 'moon'"),
        ('scene = "good.glb"\nsize = [4, 4]', "size"),
        (f"{CAMERA_AT}eye_m = [1e300, 0, 0]\ntarget_m = [0, 0, 0]", "camera.eye_m"),
        (f"{CAMERA_AT}eye_m = [1, 1, 1]\ntarget_m = [1, 1, 1]", "apart"),
        ('scene = "good.glb"\n[settings.nobody]', "no module 'nobody'"),
        ('scene = "good.glb"\n[exposure]\nev100 = "bright"', "exposure.ev100: expected float"),
    ],
)
def test_a_project_file_that_says_something_wrong(refused, good_scene, tmp_path, text, says):
    """A project file obeys the same rules as the options; the sentence names table and key."""
    project = tmp_path / "project.toml"
    project.write_text(text)
    refused("render", project, says=says)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--size", "0x0"],
        ["--size", "big"],
        ["--eye", "1,2"],
        ["--eye", "1,2,3"],
        ["--eye", "1,2,3", "--target", "1,2,x"],
        ["--exposure", "bright"],
        ["--fov", "wide"],
        ["--north-offset", "1000"],
        ["--nonsense"],
    ],
)
def test_invalid_option_values(refused, good_scene, arguments):
    """The sentence for each option says what it expects."""
    name = arguments[0].strip("-").split("-")[0]
    refused("render", good_scene, *GOOD_TIME, *arguments, says=name)


@pytest.mark.parametrize(
    "arguments",
    [["--size", "1"], ["--projection", "mercator"], ["--turbidity", "0"], ["--sky", "x"]],
)
def test_the_sky_command_is_as_strict(refused, arguments):
    """`vrut-lite sky` shares its options with `render`, and their rules."""
    refused("sky", *GOOD_TIME, *arguments, says=arguments[0].strip("-"))


@pytest.mark.gl
def test_a_black_ground_does_not_blow_out_what_is_lit(monkeypatch, capsys, good_scene, tmp_path):
    """Albedo 0 is valid: the picture is within a stop of that at albedo 0.05."""
    exposures = []
    for albedo in ("0", "0.05"):
        picture = tmp_path / f"{albedo}.png"
        arguments = ["render", good_scene, "-o", picture, "--albedo", albedo, "--size", "96x64"]
        monkeypatch.setattr(sys, "argv", ["vrut-lite", *map(str, arguments), *GOOD_TIME])
        cli.main()
        exposures.append(float(capsys.readouterr().out.rsplit("EV100", 1)[1]))
    assert abs(exposures[0] - exposures[1]) < 1.0


@pytest.mark.parametrize("command", [["sky"], ["render", "good.glb"]])
@pytest.mark.gl
def test_without_a_sun_the_reason_is_told(monkeypatch, capsys, good_scene, tmp_path, command):
    """A module that failed to load is named, and what is missing for it; no traceback."""
    from vrut_lite import discovery

    def broken():
        yield discovery.Candidate("'dynamic_skylight' (broken)", lambda: 1 / 0)

    monkeypatch.setattr(discovery, "_by_entry_point", broken)
    monkeypatch.chdir(tmp_path)
    code, said = run(monkeypatch, capsys, *command, "-o", "sky.exr", *GOOD_TIME)
    assert code == 1
    assert "failed to load: ZeroDivisionError: division by zero" in said
    assert said.splitlines()[-1].startswith("vrut-lite: no module tells where the sun stands")


def test_no_arguments_show_the_help(monkeypatch, capsys):
    """`vrut-lite` alone prints the help."""
    monkeypatch.setattr(sys, "argv", ["vrut-lite"])
    cli.main()
    shown = capsys.readouterr().out
    assert "Usage:" in shown
    assert "render" in shown
    assert shown.count("\n") > 5


@pytest.mark.parametrize("option", ["--height", "--rotate"])
@pytest.mark.parametrize("number", ["nan", "inf", "high"])
def test_nan_and_infinity_are_refused(refused, option, number):
    """NaN passes comparisons with bounds, and kernels would index outside their arrays."""
    refused("sky", *GOOD_TIME, "--place", "50,14", option, number, says=number)


SPAN = [*GOOD_TIME, "--place", "50,14", "--from", "12:00", "--to", "12:20"]


@pytest.mark.parametrize(
    "name",
    [
        "%999999999d.png", "%100d.png", "%0999999999999999999999d.png", "%" + "9" * 5000 + "d.png",
        "a%5000d.png", "%d%d.png", "%%d.png", "%s.png", "%n.png", "%-4d.png", "%.999999999d.png",
        "%*d.png", "%٣d.png", "%", "day.png", "100%_%d.png",
    ],
)  # fmt: skip
def test_invalid_sequence_names_are_refused(monkeypatch, capsys, tmp_path, name):
    """Refused before a name of a gigabyte is formatted, and before the first picture."""
    monkeypatch.chdir(tmp_path)
    suffix = "" if name.endswith(".png") else ".png"
    code, said = run(monkeypatch, capsys, "sky", *SPAN, "-o", name + suffix)
    assert (code, said.count("\n")) == (2, 1)
    assert "%04d" in said
    assert len(said) < 300
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["x" * 252 + ".exr", "x" * 9000 + ".exr", "x" * 250 + "%d.exr"])
@pytest.mark.parametrize("more", [[], ["--sidecar"]])
def test_a_name_that_is_too_long_is_told_before_the_work(monkeypatch, capsys, tmp_path, name, more):
    """For the last picture of many too, and for its sidecar file."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("vrut_lite.commands.sky.make_pictures", None)
    times = [*SPAN, "--step", "1m"] if "%" in name else GOOD_TIME
    code, said = run(monkeypatch, capsys, "sky", *times, "-o", name, *more)
    assert (code, said.count("\n")) == (2, 1)
    assert "too long" in said
    assert not list(tmp_path.iterdir())


def test_a_picture_of_many_that_is_a_folder_is_told_before_the_work(monkeypatch, capsys, tmp_path):
    """If the third of three cannot be written, the first two are not made."""
    monkeypatch.setattr("vrut_lite.commands.sky.make_pictures", None)
    (tmp_path / "sky_3.exr").mkdir()
    code, said = run(monkeypatch, capsys, "sky", *SPAN, "-o", tmp_path / "sky_%d.exr")
    assert (code, said.count("\n")) == (2, 1)
    assert "sky_3.exr: it is a folder" in said


@pytest.mark.parametrize("command", [["sky", "-o"], ["replay"], ["render"], ["demo", "--out"]])
def test_a_null_character_among_the_arguments(monkeypatch, capsys, command):
    """A null character cannot come from a shell, but from a script."""
    code, said = run(monkeypatch, capsys, *command, "a\0.exr")
    assert (code, said.count("\n")) == (2, 1)
    assert "null character" in said


@pytest.mark.parametrize("name", ["a\0.png", "\ud800.png"])
def test_names_that_no_system_accepts(name, tmp_path):
    """Such a name cannot come from a shell, but from a script."""
    with pytest.raises(UserError, match="no name of a file"):
        check_writable(tmp_path / name)


@pytest.mark.parametrize("number", ["1_0", "１０", "٣٠", "−5", "5°"])
@pytest.mark.parametrize(
    ("command", "option"),
    [
        ("sky", "--size"), ("sky", "--height"), ("sky", "--rotate"), ("sky", "--jobs"),
        ("sky", "--north-offset"), ("sky", "--turbidity"), ("sky", "--haze"),
        ("sky", "--tolerance"),
        ("sky", "--place"), ("record", "--size"), ("record", "--step"), ("render", "--fov"),
        ("render", "--compensation"), ("render", "--exposure"), ("render", "--size"),
        ("render", "--eye"), ("render", "--white"),
    ],
)  # fmt: skip
def test_digits_that_only_python_takes_for_a_number(
    monkeypatch, capsys, good_scene, tmp_path, command, option, number
):
    """`1_0`, other scripts' digits, signs and units are refused; the option is named."""
    shapes = {
        "--place": f"{number},14,1", "--size": f"{number}x32" if command == "render" else number,
        "--eye": f"{number},0,0", "--white": f"{number},0",
    }  # fmt: skip
    scene = [good_scene] if command == "render" else []
    output = tmp_path / ("a.mcap" if command == "record" else "a.exr")
    arguments = [
        command,
        *scene,
        *GOOD_TIME,
        "-o",
        output,
        f"{option}={shapes.get(option, number)}",
    ]
    code, said = run(monkeypatch, capsys, *arguments)
    assert (code, said.count("\n")) == (2, 1), said
    assert option.strip("-").split("-")[0] in said
    assert not output.exists()


@pytest.mark.parametrize(
    "text",
    [
        "tolerance = true", "tolerance = nan", "north_offset_deg = inf", 'size = ["64", "64"]',
        "size = [true, true]", "at = 12", "place = [50, 14]", "place = '1_0,14'", "air = 1",
        "settings = 3", "[settings.dynamic_skylight]\nturbidity = true",
        "[settings.dynamic_skylight]\nturbidity = [3]", "[settings.clouds.coverage]\nvalue = 1",
        "[settings.dynamic_skylight]\nturbidity = nan", "north_offset_deg = " + "9" * 5000,
        "slots = []", "[exposure]\nev100 = '3'", "at = 12:00:00", "at = 2026-06-21",
        "scene_ = " + "{a=" * 3000,
    ],
)  # fmt: skip
def test_values_of_another_type_in_a_project(refused, good_scene, tmp_path, text):
    """Booleans and texts in place of numbers are refused in every table."""
    project = tmp_path / "project.toml"
    project.write_text(f'scene = "good.glb"\n{text}\n')
    refused("render", project, says="")


def test_a_project_of_gigabytes_is_not_read(refused, tmp_path):
    """The size is checked first."""
    project = tmp_path / "project.toml"
    project.touch()
    os.truncate(project, 1 << 34)
    refused("render", project, says="is too large")

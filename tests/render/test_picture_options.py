"""Tone map and white balance by project file and by option, and what is refused."""

import pytest
from click.testing import CliRunner

from vrut_lite.commands.render import render
from vrut_lite.errors import UserError
from vrut_lite.messages.picture import SetExposure
from vrut_lite.project import load_project, view_inputs


def project_file(folder, exposure):
    path = folder / "room.toml"
    path.write_text(f'scene = "room.glb"\n[exposure]\n{exposure}\n')
    return path


def test_a_project_says_how_its_picture_is_made(tmp_path):
    """Every field of SetExposure has a place in the file."""
    lines = 'mode = "manual"\nev100 = 12\ntone_map = "none"\nwhite_temperature_k = 5200'
    lines += '\nnight_look = "exposure"'
    project = load_project(project_file(tmp_path, lines))
    (exposure,) = [m for m in view_inputs(project) if isinstance(m, SetExposure)]
    assert exposure == SetExposure(
        mode="manual",
        ev100=12.0,
        tone_map="none",
        white_temperature_k=5200.0,
        night_look="exposure",
    )


def test_a_project_from_when_the_eyes_night_was_a_tone_map_is_read(tmp_path):
    """It is the look of nights today, under AgX."""
    project = load_project(project_file(tmp_path, 'tone_map = "eye"'))
    assert (project.exposure.tone_map, project.exposure.night_look) == ("agx", "eye")


@pytest.mark.parametrize(
    ("line", "field"),
    [("white_temperature_k = 900", "white_temperature_k"), ('tone_map = "film"', "tone_map"),
     ("white_duv = 0.2", "white_duv")],
)  # fmt: skip
def test_a_project_with_a_bad_value_is_refused_by_name(tmp_path, line, field):
    """Which field, in one sentence."""
    with pytest.raises(UserError, match=field):
        load_project(project_file(tmp_path, line))


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--white", "warm", "KELVIN,DUV"),
        ("--white", "900", "white_temperature_k"),
        ("--white", "5000,0.3", "white_duv"),
        ("--tone-map", "film", "tone_map"),
        ("--night-look", "owl", "night_look"),
    ],
)
def test_a_bad_option_is_refused_before_anything_is_drawn(tmp_path, option, value, words):
    """No GPU, no sky: one sentence that names it."""
    arguments = ["scene.glb", "-o", str(tmp_path / "out.png"), option, value]
    outcome = CliRunner().invoke(render, arguments)
    assert isinstance(outcome.exception, UserError)
    assert words in str(outcome.exception)

"""--tolerance of render, sky and record: accepted, written to the header, refused."""

import json
import sys

import numpy as np
import pytest
from command_output import output_of, shared_options

from vrut_lite import cli
from vrut_lite.commands.dump import dump
from vrut_lite.commands.record import record
from vrut_lite.commands.replay import replay
from vrut_lite.commands.sky import sky
from vrut_lite.errors import UserError
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE
from vrut_lite.project import Project, load_project
from vrut_lite.studio.sky_pictures import SkyPlan

AT = ["--at", "2026-06-21T12:00Z", "--place", "50.0755,14.4378"]


@pytest.mark.parametrize(
    ("text", "share"),
    [("1%", 0.01), ("0.01", 0.01), ("1 %", 0.01), ("0.3%", 0.003), ("100%", 1.0), ("1e-3", 1e-3)],
)
def test_percent_and_shares_are_read(text, share):
    """1% and 0.01 are the same."""
    assert shared_options("--tolerance", text)[0].tolerance == pytest.approx(share, rel=1e-12)


@pytest.mark.parametrize(
    "text", ["0", "0%", "-1%", "101%", "1.5", "nan", "nan%", "one", "1%%", "%"]
)
def test_invalid_tolerances_are_refused(monkeypatch, capsys, tmp_path, text):
    """One sentence with an example, exit code 2, no picture."""
    picture = tmp_path / "sky.exr"
    monkeypatch.setattr(
        sys, "argv", ["vrut-lite", "sky", "-o", str(picture), f"--tolerance={text}"]
    )
    with pytest.raises(SystemExit) as end:
        cli.main()
    said = capsys.readouterr().err
    assert end.value.code == 2
    assert said.count("\n") == 1
    assert f"--tolerance {text} is no share above 0 and up to 1: say 1% or 0.01" in said
    assert not picture.exists()


@pytest.mark.parametrize("value", ["0.0", "nan", "1.5", '"1%"'])
def test_a_project_file_is_held_to_the_same(tmp_path, value):
    """Values outside (0, 1] are refused, and the sentence names the key."""
    file = tmp_path / "scene.toml"
    file.write_text(f'scene = "scene.obj"\ntolerance = {value}\n')
    with pytest.raises(UserError, match=r"tolerance: expected"):
        load_project(file)


def test_the_header_says_it_and_the_sky_keeps_it(tmp_path):
    """The header has 0.01 at 1 %, else the default; and the sky keeps to it."""
    pictures = []
    for name, named in (("said", ["--tolerance", "1%"]), ("not_said", [])):
        file = tmp_path / f"{name}.npz"
        output_of(sky, "-o", file, "--size", "64", "--sidecar", *AT, *named)
        header = json.loads((tmp_path / f"{name}.npz.json").read_text())
        assert header["tolerance"] == (0.01 if named else DEFAULT_TOLERANCE)
        pictures.append(np.load(file)["radiance"])
    said, not_said = pictures
    up = slice(0, 32)
    error = np.abs(said - not_said)[up] / np.maximum(not_said[up], 1e-3 * not_said.max())
    # Without a tolerance the 64 rows of this map come from a cube of 64 texels, which errs by 2 %.
    assert np.quantile(error, 0.99) < 0.03
    assert error.max() > 0.0


def test_a_typed_size_wins():
    """--size sets a cube's size; the tolerance sets the internal cube of other projections."""
    loose = Project(tolerance=0.5)
    assert SkyPlan(loose, "cube", size=48).cube_size == 48
    assert SkyPlan(loose, "lat-long", size=48).cube_size is None
    assert SkyPlan(Project(), "lat-long", size=48).cube_size == 64


def test_a_journal_holds_it_and_replays(tmp_path):
    """The tolerance is an input before place and time, so that nothing is computed twice."""
    journal = tmp_path / "day.mcap"
    output_of(record, "-o", journal, "--size", "8", "--tolerance", "0.02", *AT)
    inputs = [json.loads(line) for line in output_of(dump, journal).splitlines()]
    names = [line["input"] for line in inputs if "input" in line]
    assert names.index("SetTolerance") < names.index("SetPlace")
    (message,) = [line["message"] for line in inputs if line.get("input") == "SetTolerance"]
    assert message == {"tolerance": 0.02}
    assert "compared by digest" in output_of(replay, journal, "--check")

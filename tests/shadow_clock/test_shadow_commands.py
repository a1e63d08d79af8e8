"""`vrut-lite when` and `where`: what they print and write, and what they refuse."""

import csv
import json
import sys
from datetime import datetime
from itertools import pairwise

import pytest
from command_output import output_of
from PIL import Image
from shadow_clock.when import when
from shadow_clock.where import where

from vrut_lite import cli

PRAGUE = ("--place", "50.0755,14.4378")


def test_when_prints_local_times_and_writes_the_same(tmp_path):
    """A line for people, a row for programs, of one instant."""
    path = tmp_path / "times.csv"
    said = output_of(when, "--shadow-bearing", 312, *PRAGUE, "--date", "2026-06-21", "-o", path)
    assert said.startswith("2026-06-21 11:16:")
    assert "CEST" in said
    (row,) = csv.DictReader(path.open())
    assert datetime.fromisoformat(row["instant_utc"]).strftime("%H:%M") == "09:16"
    assert float(row["bearing_deg"]) == pytest.approx(312.0)


def test_when_lists_a_range_by_day(tmp_path):
    path = tmp_path / "times.json"
    dates = "2026-03-01..2026-03-03"
    said = output_of(when, "--length-ratio", 2.5, *PRAGUE, "--date", dates, "-o", path)
    rows = json.loads(path.read_text())
    assert [row["date"] for row in rows] == [f"2026-03-0{day}" for day in (1, 1, 2, 2, 3, 3)]
    assert "3 of 3 days, 6 times" in said


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("--shadow-bearing", 180), "the sun is below the horizon, at -16.5 degrees"),
        (("--length-ratio", 0.3), "no shadow is shorter than 0.501"),
        (("--shadow-bearing", 312, "--length-ratio", 1.2), "the bearing fits at 11:16"),
    ],
)
def test_when_says_why_there_is_none(arguments, reason):
    """One sentence, which names the closest that the day has."""
    said = output_of(when, *arguments, *PRAGUE, "--date", "2026-06-21")
    assert said.startswith("none on 2026-06-21: ")
    assert reason in said
    assert said.count("\n") == 1


def test_a_range_without_any_names_the_day_that_comes_closest():
    """The longest day has the shortest shadow."""
    dates = "2026-06-10..2026-07-02"
    said = output_of(when, "--length-ratio", 0.3, *PRAGUE, "--date", dates)
    assert said.startswith(f"none on {dates}: no shadow is shorter than 0.501")
    assert " on 2026-06-2" in said
    both = ("--length-ratio", 1.2, "--shadow-bearing", -48)
    said = output_of(when, *both, *PRAGUE, "--date", dates)
    assert "on no day at the same time" in said


def test_where_writes_a_line_and_a_map(tmp_path):
    """The line as other programs read it, and a picture whose dot lies at the place."""
    line, picture = tmp_path / "line.geojson", tmp_path / "map.png"
    said = output_of(
        where, "--at", "2026-06-21T15:00Z", "--length-ratio", 1.2, "--shadow-bearing", 41,
        "-o", line, "--map", picture,
    )  # fmt: skip
    assert "69.608,-11.209: within 274 km" in said
    features = json.loads(line.read_text())["features"]
    kinds = [one["properties"]["what"] for one in features]
    assert kinds == ["line", "edge of the band", "edge of the band", "place"]
    for part in (part for one in features[:3] for part in one["geometry"]["coordinates"]):
        steps = [abs(a[0] - b[0]) for a, b in pairwise(part)]
        assert max(steps) < 10.0
    longitude, latitude = features[3]["geometry"]["coordinates"]
    with Image.open(picture) as drawn:
        at = int((longitude + 180.0) * 4.0), int((90.0 - latitude) * 4.0)
        red, green, blue = drawn.getpixel(at)
    assert red > 2 * max(green, blue)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("when", *PRAGUE, "--date", "2026-06-21"), "name one"),
        (("when", *PRAGUE, "--date", "2026-06-31", "--length-ratio", "1"), "is no day"),
        (("when", *PRAGUE, "--date", "2026-06-02..2026-06-01", "--length-ratio", "1"), "later day"),
        (("when", *PRAGUE, "--date", "1600-06-02", "--length-ratio", "1"), "1601 to 2599"),
        (("when", *PRAGUE, "--date", "2026-06-21", "--length-ratio", "nan"), "is not a number"),
        (("when", "--place", "95,0", "--date", "2026-06-21", "--length-ratio", "1"), "latitude"),
        (
            ("when", *PRAGUE, "--date", "2026-06-21", "--length-ratio", "1", "-o", "x.txt"),
            ".csv or .json",
        ),
        (("where", "--at", "2026-06-21T15:00", "--length-ratio", "1"), "has no offset"),
        (("where", "--at", "2026-06-21T15:00Z", "--shadow-bearing", "1"), "--length-ratio"),
        (
            ("where", "--at", "2026-06-21T15:00Z", "--length-ratio", "1", "--map", "map.jpg"),
            "ends with .png",
        ),
    ],
)
def test_bad_input_gets_one_sentence(monkeypatch, capsys, arguments, says):
    """Exit code 2 and one line, which says what to write instead."""
    monkeypatch.setattr(sys, "argv", ["vrut-lite", *arguments])
    with pytest.raises(SystemExit) as end:
        cli.main()
    said = capsys.readouterr().err
    assert end.value.code == 2
    assert said.count("\n") == 1
    assert says in said

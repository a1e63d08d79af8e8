"""record, replay and dump: a session in a file, and one line on whether it still holds."""

import json
from datetime import timedelta
from pathlib import Path

import msgspec
import pytest
from command_output import output_of

from vrut_lite.commands.dump import dump
from vrut_lite.commands.record import record
from vrut_lite.commands.replay import replay
from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.kernel.clock import Clock

SCENES = Path(__file__).parents[2] / "scenes"
DAY = ["--from", "2026-06-21T10:00", "--to", "2026-06-21T12:00", "--step", "60", "--size", "8"]


@pytest.fixture(scope="module")
def day(tmp_path_factory):
    """A journal of three hours of a summer day in Prague."""
    path = tmp_path_factory.mktemp("journals") / "day.mcap"
    said = output_of(record, "-o", path, *DAY, "--turbidity", "4")
    assert f"{path}: " in said
    return path


def lines_of(path):
    return [json.loads(line) for line in output_of(dump, path).splitlines()]


def test_a_day_is_recorded_with_its_place_settings_and_hours(day):
    """The shared options come first, then the clock in equal steps, both ends included."""
    head, *lines = lines_of(day)
    assert {"signature", "setup", "full"} == set(head)
    assert [line["number"] for line in lines] == list(range(len(lines)))
    inputs = [line["input"] for line in lines if "input" in line]
    assert inputs.count("SetClock") == 4
    assert {"Demand", "SetHaze", "SetPlace"} <= set(inputs)
    hours = [line["message"]["instant"] for line in lines if line.get("input") == "SetClock"]
    assert hours[1:] == [f"2026-06-21T{hour:02}:00:00+00:00" for hour in (8, 9, 10)]
    shapes = [
        line["message"]["cube"]["shape"]
        for line in lines
        if line.get("derived") == "BackgroundChanged"
    ]
    assert shapes
    assert all(shape == [6, 8, 8, 3] for shape in shapes)


def test_an_unchanged_session_is_one_line(day):
    """Exit 0 and the counts, and which comparison was made."""
    said = output_of(replay, day, "--check")
    assert said.count("\n") == 1
    assert said.endswith("are equal, compared by digest\n")


def test_a_replay_can_be_looked_at_as_a_trace(day, tmp_path):
    """Chrome trace JSON, that Perfetto opens, with every kind of message in it."""
    trace = tmp_path / "trace.json"
    output_of(replay, day, "--trace", trace)
    events = json.loads(trace.read_text())["traceEvents"]
    assert {"SetClock", "SunMoved", "BackgroundChanged"} <= {event["name"] for event in events}


def test_the_first_difference_is_told_with_exit_code_one(day, monkeypatch):
    """Another answer to the same inputs: which message, which field, and the numbers."""

    truth = Clock.set

    def a_minute_late(clock, message):
        late = message.instant + timedelta(minutes=1)
        return truth(clock, msgspec.structs.replace(message, instant=late))

    monkeypatch.setattr(Clock, "set", a_minute_late)
    with pytest.raises(ModuleFailed, match=r"ClockMoved from host: instant is .*14:01.* here and"):
        output_of(replay, day, "--check")
    assert "the first that differs" in output_of(replay, day)


def test_the_dump_of_a_journal_can_be_recorded_again(day, tmp_path):
    """Lines with inputs are inputs; the others are passed over."""
    script = tmp_path / "script.jsonl"
    script.write_text(output_of(dump, day))
    again = tmp_path / "again.mcap"
    output_of(record, "-o", again, "--inputs", script, "--full", "--size", "8")
    first = [line["input"] for line in lines_of(day) if "input" in line]
    second = [line["input"] for line in lines_of(again) if "input" in line]
    assert second[-len(first) :] == first
    assert "equal" in output_of(replay, again, "--check")


def test_a_project_gives_scene_place_and_settings(tmp_path):
    """The same file that `render` opens; its scene is opened, and what it needs is recorded."""
    project = tmp_path / "plan.toml"
    project.write_text(
        f'scene = "{SCENES / "sundial.glb"}"\nplace = "10,20"\n'
        "[settings.dynamic_skylight]\nturbidity = 5\n"
    )
    path = tmp_path / "plan.mcap"
    output_of(record, project, "-o", path, "--size", "8")
    said = [(line["input"], line["message"]) for line in lines_of(path) if "input" in line]
    assert dict(said)["SetPlace"]["latitude_deg"] == 10.0
    haze = {"module": "dynamic_skylight", "name": "turbidity", "value": 5.0}
    assert ("SetSetting", haze) in said
    assert {"SceneOpened", "SceneNeeds"} <= {line.get("derived") for line in lines_of(path)}
    assert "equal" in output_of(replay, path, "--check")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--from", "2026-06-21T10:00"], "--from and --to go together"),
        (["--from", "2026-06-21T10:00", "--to", "2026-06-20T10:00"], "no way forward"),
        (["--from", "2026-06-21", "--to", "2026-06-22"], "no date and time"),
        (["--from", "1700-01-01T00:00Z", "--to", "2500-01-01T00:00Z"], "100000 steps at most"),
        (["--albedo", "99"], "between 0 and 1"),
        (["--haze", "0.2", "--turbidity", "3"], "name the same thing"),
        (["--inputs", "none.jsonl"], "cannot open the inputs"),
        (["none.toml"], "cannot open the project"),
    ],
)
def test_invalid_options_are_refused_and_leave_no_file(tmp_path, arguments, says):
    """One sentence, and nothing half written."""
    path = tmp_path / "journal.mcap"
    with pytest.raises(UserError, match=says):
        output_of(record, "-o", path, *arguments)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("SetClock", "line 2: JSON is malformed"),
        ('{"input": "SetTime"}', "line 2: the message type 'SetTime' is unknown"),
        ('{"input": "SunMoved"}', "line 2: SunMoved is no input"),
        ('{"input": "SetPlace", "message": {"latitude_deg": 1}}', "line 2: .*`longitude_deg`"),
        ('{"input": "Demand", "message": {"consumer": 1}}', "line 2: Demand: "),
        ("[1]", "line 2: a line is an object"),
    ],
)
def test_a_line_that_is_no_input_is_named(tmp_path, line, says):
    """File, line, and what it should be."""
    script = tmp_path / "script.jsonl"
    script.write_text("\n" + line + "\n")
    with pytest.raises(UserError, match=says):
        output_of(record, "-o", tmp_path / "journal.mcap", "--inputs", script)

"""Sequences of pictures: instants, file names, and the same bytes from every worker."""

import sys
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
import trimesh
from processes_here import processes_or_skip

from vrut_lite import cli
from vrut_lite.errors import UserError
from vrut_lite.project import Project
from vrut_lite.studio.pictures import make_pictures
from vrut_lite.studio.scene_pictures import ScenePlan
from vrut_lite.studio.sky_pictures import SkyPlan
from vrut_lite.studio.time_span import Wanted, wanted_pictures

PRAGUE = Project(at="2026-06-21T12:00", place="50.0755,14.4378")
NOON = datetime(2026, 6, 21, 10, 0, tzinfo=UTC)


def wanted(start, end, step=None, project=PRAGUE, output="day_%04d.png"):
    return wanted_pictures(output, project, {"start": start, "end": end, "step": step})


@pytest.fixture
def run(monkeypatch, capsys):
    """Run the command line; returns its output."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["vrut-lite", *map(str, arguments)])
        cli.main()
        return capsys.readouterr().out

    return run


def test_clock_times_are_local_and_of_the_projects_day():
    """05:00 to 06:00 by 10 minutes in Prague, summer time: seven pictures, the first 03:00 UTC."""
    pictures = wanted("05:00", "06:00", "10m")
    assert [picture.path.name for picture in pictures] == [f"day_{i:04d}.png" for i in range(1, 8)]
    assert pictures[0].instant == datetime(2026, 6, 21, 3, 0, tzinfo=UTC)
    assert pictures[-1].instant - pictures[0].instant == timedelta(hours=1)
    by_date = wanted("2026-06-21T05:00", "2026-06-21T04:00Z", "10m")
    assert by_date == pictures


def test_a_folder_may_have_any_name():
    """The pattern is the file's: a % in a folder is a letter."""
    for folder in ("50% done", "%04d", "a%20b"):
        pictures = wanted("05:00", "05:10", "10m", output=f"{folder}/day_%02d.png")
        assert [str(one.path) for one in pictures] == [f"{folder}/day_0{n}.png" for n in (1, 2)]


@pytest.mark.parametrize(
    ("step", "count"), [("30s", 121), ("20 min", 4), ("1h", 2), ("45m", 2), (None, 7), ("30", 3)]
)
def test_steps_have_units(step, count):
    """Seconds, minutes, hours; minutes by default; 10 minutes without a step."""
    assert len(wanted("05:00", "06:00", step)) == count


def test_a_span_across_a_change_of_clocks_has_every_hour():
    """Prague, 25 October 2026: 00:00 to 06:00 are seven hours; in March five."""
    for day, hours in (("2026-10-25", 7), ("2026-03-29", 5)):
        project = Project(at=f"{day}T12:00", place=PRAGUE.place)
        pictures = wanted("00:00", "06:00", "1h", project)
        assert len(pictures) == hours + 1
    with pytest.raises(UserError, match="never"):
        wanted("02:30", "06:00", "1h", Project(at="2026-03-29T12:00", place=PRAGUE.place))


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("05:00", None), "go together"),
        ((None, "05:00"), "go together"),
        ((None, None, "10m"), "needs --from and --to"),
        (("21:00", "05:00"), "comes before"),
        (("05:00", "21:00", "soon"), "no length of time"),
        (("05:00", "21:00", "0s"), "1 s or more"),
        (("05:00", "21:00", "-1m"), "no length of time"),
        (("2026-01-01T00:00", "2027-01-01T00:00", "10s"), "longer --step"),
        (("25:00", "26:00"), "hour"),
        (("05:00", "later"), "no date and time"),
    ],
)
def test_invalid_spans_are_refused_in_one_sentence(arguments, says):
    """Refused before anything is opened."""
    with pytest.raises(UserError, match=says) as refused:
        wanted(*arguments)
    assert "\n" not in str(refused.value)


def test_without_a_span_any_name_is_allowed():
    """A single picture's name may contain per cent signs."""
    assert wanted(None, None, output="%d.png")[0].path.name == "%d.png"


@pytest.mark.parametrize("model", ["dynamic_skylight", "bruneton_sky"])
def test_a_sky_does_not_remember_the_one_before(model):
    """Although modules skip invisible moves of the sun, each picture is that of its own hour."""
    plan = SkyPlan(replace_sky(PRAGUE, model), size=32)
    later = NOON + timedelta(seconds=1)
    studio, fresh = plan.open(), plan.open()
    first = studio.shoot(NOON).radiance
    second, alone = studio.shoot(later), fresh.shoot(later)
    np.testing.assert_array_equal(second.radiance, alone.radiance)
    assert second.metadata == alone.metadata
    assert not np.array_equal(first, second.radiance)
    studio.close()
    fresh.close()


def replace_sky(project, model):
    return Project(at=project.at, place=project.place, slots={"sky": model})


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "ball.glb"
    ball = trimesh.creation.icosphere(subdivisions=2)
    material = trimesh.visual.material.PBRMaterial(metallicFactor=1.0, roughnessFactor=0.3)
    ball.visual = trimesh.visual.TextureVisuals(material=material)
    ball.export(path)
    return path


@pytest.mark.gl
def test_a_frame_does_not_remember_the_one_before(scene, tmp_path):
    """A frame a second later has the same bytes as if it were drawn alone."""
    project = Project(scene=str(scene), at="2026-06-21T12:00", size=(48, 32))
    later = NOON + timedelta(seconds=1)
    files = {}
    for name, instants in (("after", (NOON, later)), ("alone", (later,))):
        studio = ScenePlan(project).open()
        for instant in instants:
            files[name] = tmp_path / f"{name}.png"
            studio.shoot(instant).write(files[name])
        studio.close()
    assert files["after"].read_bytes() == files["alone"].read_bytes()


def contents(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


SKY = ["--from", "05:00", "--to", "06:00", "--step", "30m", "--size", 32, "--sidecar"]


@pytest.mark.long
def test_processes_make_the_same_files(run, tmp_path):
    """Three skies and their sidecars from one process and from two are equal to the byte."""
    processes_or_skip()
    made = {}
    for jobs in (1, 2):
        folder = tmp_path / str(jobs)
        folder.mkdir()
        said = run("sky", "-o", folder / "sky_%02d.exr", *SKY, "--jobs", jobs)
        assert "3 pictures, from 2026-06-21 05:00 CEST" in said
        made[jobs] = contents(folder)
    assert list(made[1])[:2] == ["sky_01.exr", "sky_01.exr.json"]
    assert len(made[1]) == 6
    assert made[1] == made[2]


def test_without_shared_memory_processes_are_refused(run, tmp_path, monkeypatch, capsys):
    """Without a writable /dev/shm the sentence names the alternative."""

    def refused(*_arguments, **_named):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("multiprocessing.synchronize._multiprocessing.SemLock", refused)
    with pytest.raises(SystemExit) as end:
        run("sky", "-o", tmp_path / "a_%d.exr", *SKY, "--jobs", 2)
    assert end.value.code == 2
    assert "/dev/shm" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.long
@pytest.mark.gl
def test_dask_makes_the_same_files(run, scene, tmp_path):
    """Two frames from a local cluster of two workers are equal to the byte."""
    pytest.importorskip("distributed", reason="distributed is not installed: extra `dask`")
    span = ["--from", "05:00", "--to", "06:00", "--step", "1h", "--size", "48x32"]
    made = {}
    for name, workers in (("here", []), ("dask", ["--dask", "local", "--jobs", 2])):
        folder = tmp_path / name
        folder.mkdir()
        run("render", scene, "-o", folder / "day_%d.png", *span, *workers)
        made[name] = contents(folder)
    assert list(made["here"]) == ["day_1.png", "day_2.png"]
    assert made["here"] == made["dask"]


def test_a_missing_scheduler_is_reported(run, tmp_path):
    """An unknown kind of address: one sentence with an example."""
    pytest.importorskip("distributed", reason="distributed is not installed: extra `dask`")
    with pytest.raises(SystemExit) as end:
        run("sky", "-o", tmp_path / "a_%d.exr", *SKY, "--dask", "pigeon://loft:1")
    assert end.value.code == 2


def test_missing_dask_is_reported(run, tmp_path, monkeypatch, capsys):
    """The sentence says how to install it."""
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(SystemExit) as end:
        run("sky", "-o", tmp_path / "a_%d.exr", *SKY, "--dask", "local")
    assert end.value.code == 2
    said = capsys.readouterr().err
    assert "pip install 'vrut-lite[dask]'" in said
    assert said.count("\n") == 1


class Studio:
    """Writes two pictures, then calls `happens`."""

    def __init__(self, happens):
        self.happens, self.shots, self.closed = happens, 0, False

    def open(self):
        return self

    def shoot(self, instant):
        self.shots += 1
        if self.shots > 2:
            raise self.happens
        return self

    caption = "a picture"
    notices = ()

    def write(self, path):
        path.write_text(f"new {self.shots}")

    def close(self):
        self.closed = True


@pytest.mark.parametrize("happens", [KeyboardInterrupt(), UserError("no such thing")])
def test_finished_pictures_stay(tmp_path, happens):
    """After Ctrl-C or an error in the third of four there are two new pictures."""
    paths = [tmp_path / f"{i}.png" for i in range(4)]
    for path in paths:
        path.write_text("old")
    studio = Studio(happens)
    with pytest.raises(type(happens)):
        make_pictures(studio, [Wanted(NOON, path) for path in paths], None)
    assert [path.read_text() for path in paths] == ["new 1", "new 2", "old", "old"]
    assert studio.closed
    assert len(list(tmp_path.iterdir())) == 4


def test_different_plans_compare_unequal():
    """A worker reuses its studio for equal plans only."""
    plan = SkyPlan(PRAGUE, size=32)
    assert plan == SkyPlan(Project(at=PRAGUE.at, place=PRAGUE.place), size=32)
    assert plan != replace(plan, turned_deg=90.0)
    assert plan != replace(plan, project=Project(place="0,0"))

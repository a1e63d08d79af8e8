"""Scenes that need little: skipped work leaves the picture the same, and counters count it."""

from dataclasses import replace
from datetime import timedelta

import msgspec
import pytest
from long_parameters import mostly_long

from vrut_lite.project import Project, load_project
from vrut_lite.scene.scene_state import FrameSkips
from vrut_lite_lab.bench.paths.frame import NOTHING
from vrut_lite_lab.work_skipped import DAY_SCENES, SCENES, difference, play_frames, rows

pytestmark = pytest.mark.gl
SIZE = (96, 60)
# A closed room, a camera to the ground, a small indoor scene, a planet, and a street.
PLAYED = {
    "closed room": SCENES / "work" / "room.glb",
    "camera to the ground": SCENES / "work" / "ground.glb",
    "small indoor scene": SCENES / "work" / "indoor.glb",
    "planet-sized": SCENES / "work" / "planet.glb",
    "street": SCENES / "street.obj",
}
# The first frame; the same again; a second later; twenty minutes later.
LATERS = (timedelta(0), timedelta(0), timedelta(seconds=1), timedelta(minutes=20))
# What each scene spares in full, of the work that frames do.
SPARED = {
    "closed room": {"sky sample"},
    "camera to the ground": {"sky sample"},
    "small indoor scene": {"sky sample"},
    "planet-sized": set(),
    "street": set(),
}


@pytest.fixture(scope="module")
def plays():
    """Each scene played with and without skipping, once for all tests."""
    made = {}

    def get(name, skips):
        if (name, skips) not in made:
            project = Project(scene=str(PLAYED[name]), at="2026-06-21T16:00", size=SIZE)
            made[name, skips] = play_frames(project, skips, LATERS)
        return made[name, skips]

    return get


@pytest.mark.parametrize("name", mostly_long(PLAYED, "small indoor scene".__eq__))
def test_pictures_stay_while_work_goes(plays, name):
    """All four frames within one step of 8 bits of those where all was done, and less work.

    No row of the table has more done than asked; a scene that has no use for some work has
    none of it done; a scene that lies in full view still spares reflections and shadows.
    """
    one, everything = plays(name, FrameSkips()), plays(name, NOTHING)
    assert difference(one, everything) <= 1
    table = {work: (asked, done) for work, asked, done, _ in rows(one, everything)}
    assert all(done <= asked for asked, done in table.values())
    assert {work for work, (_, done) in table.items() if done == 0} >= SPARED[name]
    for work in ("reflection slice", "shadow map", "light: sky, sun, ambient"):
        asked, done = table[work]
        assert done <= asked / 2


def test_what_a_scene_does_not_have_costs_nothing(plays):
    """Without lamps, clouds, shafts and flat mirrors no pass of theirs runs, not even once."""
    done = plays("small indoor scene", FrameSkips()).frame.done
    assert {work for work, count in done.items() if count}.isdisjoint(
        {"lamp", "lamp shadow face", "clouds", "cloud shadow map", "light shafts", "mirror"}
    )


@pytest.mark.parametrize(
    ("skip", "name", "work"),
    [
        pytest.param("sky", "small indoor scene", "sky sample", marks=pytest.mark.long),
        ("reflection", "small indoor scene", "reflection slice"),
    ],
)
def test_a_skip_that_is_switched_off_shows_in_the_ledger(plays, skip, name, work):
    """Its work is done then, in full unless another skip spares some of it; the picture stays."""
    without = plays(name, replace(FrameSkips(), **{skip: False}))
    one, everything = plays(name, FrameSkips()), plays(name, NOTHING)
    assert one.frame.done[work] < without.frame.done[work] <= everything.frame.done[work]
    assert difference(without, one) <= 1


@pytest.mark.long
def test_a_day_of_a_street_is_the_same_with_less_work():
    """Noon, noon again, night and night again: pictures equal, no shadow map without a sun.

    What was asked for is what is done with nothing left out; a skip that is switched off alone
    brings its own work back.
    """
    laters = [timedelta(hours=hour) for hour in (9, 9, 19, 19)]
    project = replace_size(load_project(DAY_SCENES["street"]))
    one, everything, shadowed = (
        play_frames(project, skips, laters)
        for skips in (FrameSkips(), NOTHING, replace(FrameSkips(), shadow=False))
    )
    assert difference(one, everything) <= 1
    assert difference(one, shadowed) <= 1
    assert all(spent > 0.0 for spent in one.spent_s)
    assert one.frame.done["shadow map"] == 1
    assert shadowed.frame.done["shadow map"] == everything.frame.done["shadow map"] == len(laters)
    reasons = {reason for reason, count in one.frame.skipped.items() if count}
    assert {"shadow map: no sun to cast one", "shadow map: same scene, same sun"} <= reasons


def replace_size(project):
    """The project at the tests' size, from the start of the scripted day."""
    return msgspec.structs.replace(project, at="2026-06-21T04:00", size=SIZE)

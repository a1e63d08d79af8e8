"""What the modules said when these journals were recorded, they must say today."""

import os
import subprocess
import sys
from typing import Literal, get_args, get_origin, get_type_hints

import journal_scripts
import msgspec
import numpy as np
import pytest
from dynamic_skylight.settings import DynamicSkyLightSettings

from vrut_lite.array import Array
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.message_codec import to_plain
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recipes import recipe_of_plain
from vrut_lite.recording.replay import Replay

LARGEST_BYTES = 48_000
# Made by numpy's matrix products, which round otherwise without CPU features.
BY_VALUE = ("bruneton_sky",)


@pytest.mark.parametrize("name", journal_scripts.SCRIPTS)
def test_the_modules_say_what_they_said(replay_journal, name):
    """No message differs: by digest on the machine of the recording, by value elsewhere."""
    path = journal_scripts.journal_path(name)
    outcome = replay_journal(path, journal_scripts.modules(name))
    assert outcome.inputs >= len(journal_scripts.SCRIPTS[name])
    assert outcome.messages > 0


@pytest.mark.parametrize(
    ("name", "changed"),
    [("sky_on_gpu", "compute_shader"), ("slots_switched", "value.polarised")],
)
def test_journals_of_earlier_versions_replay(name, changed):
    """Recorded on another processor, without a setup's steps and without results' senders.

    A later change of a module's computation is named: the Bruneton sky's solution has Q and U,
    the shader of Hosek and Wilkie's sky divides last.
    """
    journal = Journal(journal_scripts.HERE / "earlier" / f"{name}.mcap")
    assert not journal.setup.steps
    outcome = Replay(journal, journal_scripts.modules(name)).run()
    assert outcome.by_value
    assert changed in (outcome.difference or "")


@pytest.mark.parametrize("name", journal_scripts.SCRIPTS)
def test_the_journal_is_of_its_script(name):
    """A script that changed without its journal would test nothing new; and git stays small."""
    path = journal_scripts.journal_path(name)
    entries = [entry for entry in Journal(path).entries() if entry.kind == "input"]
    # What background jobs brought was not in the script; those of the GPU are, as it was told.
    inputs = [e.message for e in entries if not _of_background_job(e)]
    script = [through_json(message) for message in journal_scripts.SCRIPTS[name]]
    assert inputs == script, "run python tests/replays/journal_scripts.py"
    assert path.stat().st_size < LARGEST_BYTES


def _of_background_job(entry):
    return entry.type_name == "JobResult" and entry.message["job"] in ("solve", "layers", "sum")


@pytest.mark.parametrize("name", journal_scripts.SCRIPTS)
def test_no_sky_failed_while_it_was_recorded(name):
    """A journal that was updated while a module was broken would keep it so."""
    entries = Journal(journal_scripts.journal_path(name)).entries()
    faults = [e.message for e in entries if e.type_name == "Fault" and not e.message["for_user"]]
    assert [fault for fault in faults if fault["module"] != "failing_sun"] == []


@pytest.mark.parametrize(
    "name",
    [*(pytest.param(n, marks=pytest.mark.long) for n in ("day_passing", "sky_on_gpu")),
     "slots_switched"],
)  # fmt: skip
def test_the_skies_hold_without_cpu_features(name):
    """numpy's last bits change with the processor: values may not, nor the quantised cubes.

    The promise binds published, quantised arrays to the byte, and of cubes that stay on the GPU
    the recipes; the rest agrees by value, scalars to 1e-5.
    """
    found = np.show_config(mode="dicts")["SIMD Extensions"]["found"]
    if not found:
        pytest.skip("this processor has no features that numpy could do without")
    done = subprocess.run(
        [sys.executable, __file__, name],
        env=os.environ | {"NPY_DISABLE_CPU_FEATURES": " ".join(found)},
        capture_output=True,
        text=True,
        check=False,
    )
    said, *cubes = done.stdout.splitlines()
    assert said == "compared by value: None", done.stdout + done.stderr
    entries = Journal(journal_scripts.journal_path(name)).entries()
    recorded = [
        e.message["cube"]
        for e in entries
        if e.type_name == "BackgroundChanged" and e.sender not in BY_VALUE
    ]
    assert cubes == [cube.get("$array") or cube["recipe"] for cube in recorded]
    assert cubes


def through_json(message):
    return msgspec.json.decode(msgspec.json.encode(to_plain(message)))


@pytest.mark.parametrize("name", DynamicSkyLightSettings.__struct_fields__)
def test_every_setting_of_the_sky_is_in_a_journal(name):
    """Its number is moved, or each of its choices taken, in some session that is replayed."""
    taken = {
        message.value
        for script in journal_scripts.SCRIPTS.values()
        for message in script
        if isinstance(message, SetSetting) and message.name == name
    }
    hint = get_type_hints(DynamicSkyLightSettings)[name]
    assert taken >= set(get_args(hint)) if get_origin(hint) is Literal else len(taken) > 1


def test_the_gpus_sky_is_shown_when_it_is_done():
    """Textures of answered jobs in time, of twilight too; after a failure the CPU's arrays."""
    entries = Journal(journal_scripts.journal_path("sky_on_gpu")).entries()
    cubes = [e.message["cube"] for e in entries if e.type_name == "BackgroundChanged"]
    on_gpu = ["recipe" in cube for cube in cubes]
    assert on_gpu == [False, True, True, True, False, False, True]


def test_a_session_with_a_card_replays_without_one():
    """With "auto" the recorded trial chooses: textures by their recipes on a card, arrays of the
    CPU where set so, and on a software renderer."""
    entries = Journal(journal_scripts.journal_path("sky_on_card")).entries()
    cubes = [e.message["cube"] for e in entries if e.type_name == "BackgroundChanged"]
    on_card = ["recipe" in cube for cube in cubes]
    assert on_card == [False, True, True, True, True, False, True, False]
    assert {cube["format"] for cube in cubes if "recipe" in cube} == {"rgba32f"}


def test_clouds_on_a_card_replay_without_one():
    """The sum's cube is the card's by its recipe, over a clear sky by its own; after a failure the
    processor's array."""
    entries = list(Journal(journal_scripts.journal_path("clouds_on_card")).entries())
    sums = [e.message for e in entries if e.type_name == "SkyLightChanged"]
    cloudy = [light["background"]["cube"] for light in sums if light["layers"]]
    assert ["recipe" in cube for cube in cloudy] == [True, False]
    jobs = [e.message for e in entries if e.type_name == "GpuJob"]
    added = [job for job in jobs if job["module"] == "sky_sum"]
    skies = {recipe_of_plain(job) for job in jobs if job["module"] == "dynamic_skylight"}
    assert {job["reads"]["recipe"] for job in added} <= skies
    assert cloudy[0]["recipe"] in {recipe_of_plain(job) for job in added}


def test_the_failing_module_fails_over():
    """The journal shows what it is for: three faults, a suspension, another sun."""
    entries = list(Journal(journal_scripts.journal_path("module_failing")).entries())
    faults = [entry.message for entry in entries if entry.type_name == "Fault"]
    suspended = [fault["suspended"] for fault in faults if fault["module"] == "failing_sun"]
    assert suspended[:3] == [False, False, True]
    holders = [
        e.message["holder"]
        for e in entries
        if e.type_name == "SlotChanged" and e.message["name"] == "sun"
    ]
    assert "failing_sun" in holders
    assert holders[holders.index("failing_sun") + 1] == "dynamic_skylight"


def name_of(cube):
    """What tells a cube's texels: a digest of them, or of how the GPU makes them."""
    return cube.digest if isinstance(cube, Array) else cube.recipe


if __name__ == "__main__":
    script = sys.argv[1]
    journal = Journal(journal_scripts.journal_path(script))
    replay = Replay(journal, journal_scripts.modules(script))
    cubes: list[str] = []

    def collect(message, _):
        if isinstance(message, BackgroundChanged) and message.source not in BY_VALUE:
            cubes.append(name_of(message.cube))

    replay.kernel.tap(collect)
    result = replay.run()
    print(f"compared by {'value' if result.by_value else 'digest'}: {result.difference}")
    print("\n".join(cubes))

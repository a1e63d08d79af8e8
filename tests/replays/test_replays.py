"""What the modules said when these journals were recorded, they must say today."""

import os
import subprocess
import sys

import journal_scripts
import msgspec
import numpy as np
import pytest

from vrut_lite.kernel.messages import BackgroundChanged
from vrut_lite.kernel.recording.codec import to_plain
from vrut_lite.kernel.recording.journal_reader import Journal
from vrut_lite.kernel.recording.replay import Replay

LARGEST_BYTES = 32_000


@pytest.mark.parametrize("name", journal_scripts.SCRIPTS)
def test_the_modules_say_what_they_said(replay_journal, name):
    """By digest on the machine of the recording, by value elsewhere: no message differs."""
    path = journal_scripts.journal_path(name)
    outcome = replay_journal(path, journal_scripts.modules(name))
    assert outcome.inputs == len(journal_scripts.SCRIPTS[name])
    assert outcome.messages > 0


@pytest.mark.parametrize("name", journal_scripts.SCRIPTS)
def test_the_journal_is_of_its_script(name):
    """A script that changed without its journal would test nothing new; and git stays small."""
    path = journal_scripts.journal_path(name)
    inputs = [entry.message for entry in Journal(path).entries() if entry.kind == "input"]
    script = [through_json(message) for message in journal_scripts.SCRIPTS[name]]
    assert inputs == script, "run python tests/replays/journal_scripts.py"
    assert path.stat().st_size < LARGEST_BYTES


@pytest.mark.parametrize("name", journal_scripts.SCRIPTS)
def test_no_sky_failed_while_it_was_recorded(name):
    """A journal that was updated while a module was broken would keep it so."""
    entries = Journal(journal_scripts.journal_path(name)).entries()
    faults = [e.message for e in entries if e.type_name == "Fault" and not e.message["for_user"]]
    assert [fault for fault in faults if fault["module"] != "failing_sun"] == []


@pytest.mark.parametrize("name", ["day_passing", "slots_switched"])
def test_the_skies_hold_without_cpu_features(name):
    """numpy's last bits change with the processor: values may not, nor the quantised cubes.

    The promise binds published, quantised arrays to the byte; the rest agrees by value, scalars
    to 1e-12.
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
    recorded = [e.message["cube"]["$array"] for e in entries if e.type_name == "BackgroundChanged"]
    assert cubes == recorded
    assert cubes


def through_json(message):
    return msgspec.json.decode(msgspec.json.encode(to_plain(message)))


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


if __name__ == "__main__":
    script = sys.argv[1]
    journal = Journal(journal_scripts.journal_path(script))
    replay = Replay(journal, journal_scripts.modules(script))
    digests: list[str] = []
    replay.kernel.tap(
        lambda message, _: (
            digests.append(message.cube.digest) if isinstance(message, BackgroundChanged) else None
        )
    )
    result = replay.run()
    print(f"compared by {'value' if result.by_value else 'digest'}: {result.difference}")
    print("\n".join(digests))

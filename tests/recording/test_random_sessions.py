"""What was recorded live, with threads, jobs, faults, changing values, replays to the byte."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import random_sessions

HERE = Path(__file__).parent
SKIES = 3


def test_random_sessions_replay_to_the_byte(tmp_path, request):
    """Full journals are equal, session by session, and the flight recorder's hold the same.

    25 sessions by default, as many as --live-runs says. What fails is played again by
    `python tests/recording/random_sessions.py SEED`.
    """
    seen = set()
    for seed in range(request.config.getoption("--live-runs")):
        fault, types = random_sessions.fault_of(seed, tmp_path)
        assert not fault, f"seed {seed}, journal {tmp_path}/session_{seed}.mcap: {fault}"
        seen |= types
    assert {sender for name, sender in seen if name == "JobResult"} == {"host", "jobs"}
    assert {"Said", "Shone", "Fault", "SlotChanged", "RestartModule"} <= {name for name, _ in seen}


def test_another_process_with_another_hash_seed_replays_to_the_byte(tmp_path):
    """Sets and dictionaries of texts are ordered by the hash seed: none may reach a journal."""
    live = random_sessions.record(1000, tmp_path, per_thread=40)
    path = tmp_path / "journal.mcap"
    path.write_bytes(live)
    said = in_process("random_sessions.py", path, PYTHONHASHSEED="12345")
    assert said == [hashlib.sha256(live).hexdigest(), "compared by digest: None"]


def test_without_cpu_features_values_are_compared(tmp_path):
    """numpy's exp differs in its last bit without AVX: the signature says so, values decide."""
    path = tmp_path / "journal.mcap"
    path.write_bytes(random_sessions.record(1001, tmp_path))
    said = in_process("random_sessions.py", path, NPY_DISABLE_CPU_FEATURES=dispensable())
    assert said[1] == "compared by value: None"


def test_another_target_of_numba_is_told(tmp_path):
    """Kernels for another processor round differently, so digests are not compared."""
    path = tmp_path / "journal.mcap"
    path.write_bytes(random_sessions.record(1002, tmp_path))
    said = in_process("random_sessions.py", path, NUMBA_CPU_NAME="generic")
    assert said[1] == "compared by value: None"


@pytest.mark.long
def test_skies_replay_on_other_sets_of_instructions(tmp_path):
    """Random sessions with the real skies, recorded here, replayed as other processors would.

    A minute of compiling for each set.
    """
    sets = {
        "generic": {"NUMBA_CPU_NAME": "generic", "NPY_DISABLE_CPU_FEATURES": dispensable()},
        "haswell": {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": "+avx2,+fma"},
    }
    recorded = in_process("random_skies.py", "record", tmp_path, SKIES)
    assert recorded == ["recorded"]
    for name, environment in sets.items():
        environment["NUMBA_CACHE_DIR"] = str(tmp_path / name)
        said = in_process("random_skies.py", "replay", tmp_path, **environment)
        assert said == ["compared by value: None"] * SKIES, name


def dispensable():
    """The features that numpy has found and could do without."""
    found = np.show_config(mode="dicts")["SIMD Extensions"]["found"]
    if not found:
        pytest.skip("this processor has no features that numpy could do without")
    return " ".join(found)


def in_process(script, *arguments, **environment):
    """Output of a script of this folder, in a separate process."""
    done = subprocess.run(
        [sys.executable, HERE / script, *map(str, arguments)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(HERE), *sys.path])} | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()

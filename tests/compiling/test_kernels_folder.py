"""Compiled kernels lie in the user's cache folder, apart by version and installation."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from vrut_lite import compiled_code

KERNEL = """
from vrut_lite.njit import njit
@njit(cache=True)
def moved(value):
    return value + {shift}
"""
CALL = """
from kernels_there.moving import moved
from vrut_lite import compiled_code
print(moved(40), compiled_code.compilations)
"""
DAY_S = 86_400.0


def package(folder: Path, shift: int) -> Path:
    """A package of one kernel in a folder."""
    inner = folder / "kernels_there"
    inner.mkdir(parents=True, exist_ok=True)
    (inner / "__init__.py").touch()
    (inner / "moving.py").write_text(KERNEL.format(shift=shift))
    return folder


def called(folder: Path, cache: Path) -> list[str]:
    """The kernel's result and the number of compilations, by a process with its own cache."""
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    done = subprocess.run(
        [sys.executable, "-c", CALL],
        env=environment | {"PYTHONPATH": str(folder), "XDG_CACHE_HOME": str(cache)},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.split()


def test_installations_side_by_side_keep_to_their_own_kernels(tmp_path: Path) -> None:
    """Each is compiled once, neither sees the other's, and nothing lies beside the sources."""
    one, other = package(tmp_path / "one", 1), package(tmp_path / "other", 2)
    assert called(one, tmp_path) == ["41", "1"]
    assert called(other, tmp_path) == ["42", "1"]
    assert called(one, tmp_path) == ["41", "0"]
    assert called(other, tmp_path) == ["42", "0"]
    assert not [*one.rglob("*.nb*"), *other.rglob("*.nb*")]
    assert len([*(tmp_path / "vrut_lite" / "kernels").rglob("*.nbi")]) == 2


@pytest.fixture
def kernels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder of kernels, below a user's cache folder."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return compiled_code.kernels_folder()


def keep(folder: Path, name: str, unused_days: float) -> list[Path]:
    """Files of a kernel with two sets of argument types, last used some days ago."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"{name}.{end}" for end in ("nbi", "1.nbc", "2.nbc")]
    for file in files:
        file.touch()
        os.utime(file, (time.time() - unused_days * DAY_S,) * 2)
    return files


def test_kernels_that_nobody_used_for_a_month_are_removed(kernels: Path) -> None:
    """Those of every version: an upgrade leaves its predecessor's behind."""
    gone = keep(kernels.parent / "0.0.9" / "there_1", "moving.moved-3.py311", 31)
    stay = keep(kernels.parent / "0.0.8" / "there_1", "moving.moved-3.py311", 29)
    stay += keep(kernels / "there_2", "moving.moved-3.py311", 0)
    gone += keep(kernels / "there_2", "moving.moved-33.py311", 31)
    compiled_code.remove_unused()
    assert not [file for file in gone if file.exists()]
    assert [file for file in stay if not file.exists()] == []
    assert not (kernels.parent / "0.0.9").exists()


def test_a_named_folder_is_left_alone(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Other programs keep their kernels there too."""
    files = keep(kernels / "there_1", "moving.moved-3.py311", 300)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(kernels))
    compiled_code.remove_unused()
    assert all(file.exists() for file in files)


def test_a_kernel_in_use_stays(kernels: Path) -> None:
    """A start marks what it loads, once a day; an index marked today is not written."""
    old, fresh = keep(kernels / "there_1", "a", 29)[0], keep(kernels / "there_1", "b", 0.5)[0]
    before_ns = fresh.stat().st_mtime_ns
    for index in (old, fresh):
        compiled_code.mark_used(index)
    assert time.time() - old.stat().st_mtime < DAY_S
    assert fresh.stat().st_mtime_ns == before_ns

"""Kernels are compiled side by side ahead of their use, and whoever waits for one gets it."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from vrut_lite import compiled_code
from vrut_lite.compiling.ahead import CompileAhead
from vrut_lite.compiling.kernel_list import KernelGroup, ListedKernel
from vrut_lite.compiling.pool import KernelPool, Progress
from vrut_lite.studio.progress import compiling_text

# In an empty cache: the sky's kernels by a process, then a sky, which compiles nothing.
AHEAD = """
from dynamic_skylight import HosekWilkieSky
from vrut_lite import compiled_code
from vrut_lite.compiling.kernel_list import announced_kernels
from vrut_lite.compiling.pool import KernelPool
told = []
pool = KernelPool(told.append, processes=1)
groups = announced_kernels().of("dynamic_skylight")
pool.add(groups)
compiled_code.ahead = type("Ahead", (), {"note": None, "wait_for": pool.wait_for})
pool.join()
compiled_code.ahead = None
HosekWilkieSky(turbidity=3.0, albedo=0.1, sun_elevation_rad=0.8).cube_map(size=16)
assert compiled_code.compilations == 0, compiled_code.compilations
assert told[-1].done == told[-1].total == sum(len(group.kernels) for group in groups)
assert [each.done for each in told] == sorted(each.done for each in told)
assert not pool.is_on
"""
SKY = """
import sys
from vrut_lite.compiling import ahead
ahead.LEAST_SECONDS = 0.0
from vrut_lite import compiled_code
from vrut_lite.cli import main
main()
compiled_code.ahead.pool.join()
"""


def run(code: str, cache: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Python code in a process that finds no compiled kernel but those in a folder."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(cache), "XDG_CACHE_HOME": str(cache)}
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, env=environment
    )


def test_what_was_compiled_ahead_is_found(tmp_path: Path) -> None:
    """The list's types are those of the calls: the sky compiles nothing, and progress ends."""
    done = run(AHEAD, tmp_path)
    assert done.returncode == 0, done.stderr


def test_a_first_start_tells_on_stderr_and_prints_the_same(tmp_path: Path) -> None:
    """Scripts read the standard output: the first start's is that of the second."""
    sky = ("sky", "-o", str(tmp_path / "sky.npz"), "--size", "16", "--at", "2026-06-21T12:00Z")
    first, second = (run(SKY, tmp_path / "cache", *sky) for _ in range(2))
    assert (first.returncode, second.returncode) == (0, 0), first.stderr
    assert first.stdout == second.stdout
    lines = first.stderr.splitlines()
    assert lines[0] == "vrut-lite: compiling the numerical kernels, once ..."
    assert "compiled" in lines[-1]
    assert second.stderr == ""


def test_kernels_that_are_not_there_end_too() -> None:
    """A stale list costs its processes alone: progress ends, and nobody waits for ever."""
    told: list[Progress] = []
    pool = KernelPool(told.append, processes=2)
    pool.add(
        [KernelGroup("old", tuple(ListedKernel("vrut_lite.gone", f"_{k}", "[]") for k in range(3)))]
    )
    pool.join()
    assert told[-1].done == told[-1].total == 3
    assert not pool.is_on


GONE = KernelGroup("old", tuple(ListedKernel("vrut_lite.gone", f"_{k}", "[]") for k in range(6)))


def test_without_processes_nobody_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that starts none compiles kernels where they are needed."""
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    told: list[Progress] = []
    pool = KernelPool(told.append, processes=4)
    pool.add([GONE])
    pool.join()
    assert told[-1].done == told[-1].total == 6
    assert not pool.is_on


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_follower_that_fails_holds_nobody_up() -> None:
    """A terminal that was closed must not keep a picture from being drawn."""

    def fails(progress: Progress) -> None:
        raise RuntimeError("closed")

    pool = KernelPool(fails, processes=2)
    pool.add([GONE])
    pool.join()
    assert not pool.is_on


def test_closing_ends_what_is_under_way() -> None:
    """A window that is closed while kernels are compiled leaves no process behind."""
    pool = KernelPool(lambda _: None, processes=1)
    pool.add([KernelGroup("old", (ListedKernel("light_transport.rays.tree", "_nodes", "[]"),) * 2)])
    pool.close()
    assert not pool.is_on
    assert [process.poll() is not None for process in pool._processes] == [True]


class Began:
    """A follower that counts its first calls."""

    def __init__(self) -> None:
        self.count = 0

    def begin(self) -> None:
        """numba will compile."""
        self.count += 1

    def __call__(self, progress: Progress) -> None:
        """Not looked at."""


@pytest.mark.parametrize("known", ["nothing", "compiled code", "an earlier start"])
def test_only_a_first_start_compiles_before_a_kernel_is_called(
    known: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Cores are busy while libraries are imported; later starts pay for no process."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "numba"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    began = Began()
    ahead = CompileAhead(began, scene=True)
    if known == "compiled code":
        kernel = ahead.groups("")[0].kernels[0]
        source = Path(str(importlib.import_module(kernel.module).__file__))
        folder = compiled_code.folder_of(source.parent)
        index = folder / f"{source.stem}.{kernel.function}-1.py311.nbi"
        index.parent.mkdir(parents=True)
        index.touch()
    elif known == "an earlier start":
        (tmp_path / "cache" / "vrut_lite").mkdir(parents=True)
        (tmp_path / "cache" / "vrut_lite" / "compiling.lock").touch()
    ahead.begin()
    is_on = ahead.pool.is_on
    ahead.pool.close()
    assert (began.count, is_on) == ((1, True) if known == "nothing" else (0, False))


@pytest.mark.parametrize("done", [0, 7, 20])
def test_the_line_names_what_is_compiled_and_what_is_left(done: int) -> None:
    """Who waits reads what for, how far it is and for how long."""
    line = compiling_text(Progress("light between surfaces: rays", done, 20, 12.4))
    if done == 20:
        assert line == "compiled 20 kernels"
    else:
        assert f"{done} of 20, 12 s to go (light between surfaces: rays)" in line

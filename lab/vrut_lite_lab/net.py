"""The net of a restructuring: what the program draws and says, kept in a folder, and compared.

    python -m vrut_lite_lab.net make FOLDER
    python -m vrut_lite_lab.net compare BEFORE AFTER [--bound 0.001]

`make` writes three kinds of files:

* `pictures/SCENE-SKY-CLOUDS-HOUR.npz`: linear radiance (60, 96, 3) in W m^-2 sr^-1 and EV100 of
  each bundled scene at four hours under both skies, without clouds and with them. Radiance is
  rounded to the 11 bits of float16, with float32's exponents, for a night is below float16.
* `sky/SKY-HOUR.npz`: `vrut-lite sky`; `daylight/SCENE.npz`: the sensors of `vrut-lite daylight`.
* `digests.txt`: of each derived message of the journals in tests/replays, and of each file that
  `vrut-lite daylight` writes.

On one machine and one set of versions two runs of a commit agree to the byte: all caches but those
of compiled code begin empty, in a process for each scene. A run takes about ten minutes on two
cores. `compare` prints a line for each file that is not equal, and exits with 1 if one has a
relative difference above the bound (root of the mean square), if one is missing on either side, or
if a digest differs. Needs the extra `ref` for FLIP.
"""

import argparse
import hashlib
import importlib.util
import io
import multiprocessing
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite import compiled_code
from vrut_lite.commands.demo import scene_projects
from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetClock
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import Project, daylight_inputs, setting_inputs, view_inputs
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.replay import rerecord
from vrut_lite_lab.path_traced.regions import flip
from vrut_lite_lab.pictures.drawing import SCENES, SKIES

ROOT = SCENES.parent
FOLDERS = (SCENES, SCENES / "work", SCENES / "large")
# Sun 39, 6, -5 and -32 degrees high; at night a moon of 97 % in the south.
HOURS = {"noon": "12:50", "low_sun": "18:15", "twilight": "19:20", "night": "22:30"}
DAY, PLACE = "2026-09-24", "50.0755,14.4378,200"
CLOUDS: dict[str, dict[str, Any]] = {"clear": {}, "clouds": {"genus": "Cu", "high_genus": "Ci"}}
SIZE = (96, 60)
DAYLIGHT_SCENE = "work/indoor.glb"
# Largest root of the mean square of relative differences; rounding to 11 bits makes 1.4e-4.
BOUND = 1e-3
# Radiance below this share of the median counts as that share.
_DARKEST = 0.01
_VRUT_LITE = str(Path(sys.executable).with_name("vrut-lite"))
_DROPPED_BITS = 13


class Difference(NamedTuple):
    """Relative differences of an array: the largest, and the root of the mean square."""

    largest: float
    rms: float


def all_scenes() -> dict[str, Project]:
    """Projects of all bundled scenes, by names such as `street` and `work_room`."""
    return {
        "_".join((*folder.relative_to(SCENES).parts, stem)): project
        for folder in FOLDERS
        for stem, project in scene_projects(folder).items()
    }


def draw_scene(name: str, folder: Path) -> None:
    """Write the pictures of one scene."""
    folder.mkdir(parents=True, exist_ok=True)
    compiled_code.share_kernels()
    with tempfile.TemporaryDirectory() as cache:
        os.environ["XDG_CACHE_HOME"] = cache
        for clouds, cloud_settings in CLOUDS.items():
            for sky in SKIES:
                base = all_scenes()[name]
                project = msgspec.structs.replace(
                    base,
                    place=PLACE,
                    at=f"{DAY}T{HOURS['noon']}",
                    slots={"sky": sky},
                    settings={**base.settings, "clouds": cloud_settings},
                    size=SIZE,
                )
                for hour, picture in draw_hours(project):
                    np.savez_compressed(
                        folder / f"{name}-{sky}-{clouds}-{hour}.npz",
                        radiance=rounded(picture.radiance),
                        ev100=np.array(picture.ev100),
                    )


def draw_hours(project: Project) -> Iterator[tuple[str, Picture]]:
    """Names of hours, with the project's picture at each."""
    with Host() as host:
        host.inject(*setting_inputs(project, host.kernel))
        host.inject(*daylight_inputs(project), *view_inputs(project))
        for hour, time in HOURS.items():
            instant = msgspec.structs.replace(project, at=f"{DAY}T{time}").instant()
            host.inject(SetClock(instant=instant))
            yield hour, host.draw()


def rounded(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Values (...) to the nearest with 11 bits in their mantissa, which compress better."""
    bits = np.ascontiguousarray(values, np.float32).view(np.uint32)
    half = np.uint32(1 << (_DROPPED_BITS - 1))
    return (((bits + half) >> _DROPPED_BITS) << _DROPPED_BITS).view(np.float32)


def write_skies(folder: Path) -> None:
    """Write what `vrut-lite sky` writes of both skies at each hour."""
    folder.mkdir(parents=True, exist_ok=True)
    for sky in SKIES:
        for hour, time in HOURS.items():
            path = folder / f"{sky}-{hour}.npz"
            options = ("--size", "64", "--sun-disc", "--stars", "--sky", sky)
            _command("sky", "-o", str(path), "--at", f"{DAY}T{time}", "--place", PLACE, *options)


def write_daylight(folder: Path) -> Iterator[str]:
    """Write the sensors' numbers of `vrut-lite daylight`; digests of all its files."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as made:
        noon = ("--at", f"{DAY}T{HOURS['noon']}", "--place", PLACE)
        _command("daylight", str(SCENES / DAYLIGHT_SCENE), "-o", made, "--grid", "1", *noon)
        for path in sorted(Path(made).iterdir()):
            content = path.read_bytes()
            if path.suffix == ".npz":
                (folder / f"{Path(DAYLIGHT_SCENE).stem}.npz").write_bytes(content)
            else:
                yield f"daylight/{path.name} {hashlib.sha256(content).hexdigest()}"


def _command(*arguments: str) -> None:
    compiled_code.share_kernels()
    with tempfile.TemporaryDirectory() as cache:
        subprocess.run(
            [_VRUT_LITE, *arguments],
            cwd=ROOT,
            env=os.environ | {"XDG_CACHE_HOME": cache},
            check=True,
            stdout=subprocess.DEVNULL,
        )


def journal_digests() -> Iterator[str]:
    """A line for each derived message of each journal, as the present modules post it."""
    scripts = _journal_scripts()
    for name in sorted(scripts.SCRIPTS):
        recorded = Journal(scripts.journal_path(name))
        again = io.BytesIO()
        rerecord(recorded, again, scripts.modules(name))
        with tempfile.NamedTemporaryFile(suffix=".mcap") as file:
            file.write(again.getvalue())
            file.flush()
            for number, entry in enumerate(Journal(Path(file.name)).entries()):
                if entry.kind == "derived":
                    said = f"{entry.sender} {entry.type_name} {entry.digest}"
                    yield f"journals/{name} {number} {said}"


def _journal_scripts() -> Any:
    """The file that makes the journals: it has the failing module that two of them load."""
    path = ROOT / "tests" / "replays" / "journal_scripts.py"
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    scripts = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scripts)
    return scripts


def write_commands(folder: Path) -> None:
    """Write skies, daylight and digests."""
    write_skies(folder / "sky")
    lines = [*journal_digests(), *write_daylight(folder / "daylight")]
    (folder / "digests.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")


def make(folder: Path) -> None:
    """Write all, on all cores."""
    # One thread a process: as many processes run as there are cores.
    for variable in ("LP_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ[variable] = "1"
    folder.mkdir(parents=True, exist_ok=True)
    # A process for each task, so that none finds what another has left in memory.
    with ProcessPoolExecutor(
        os.cpu_count(), multiprocessing.get_context("spawn"), max_tasks_per_child=1
    ) as workers:
        tasks = [workers.submit(draw_scene, name, folder / "pictures") for name in all_scenes()]
        tasks.append(workers.submit(write_commands, folder))
        for task in tasks:
            task.result()


def difference(after: NDArray[Any], before: NDArray[Any]) -> Difference:
    """Relative to `before`, with dark values counted as a share of its median.

    Infinite where shapes differ, or where one is not finite and the other is.
    """
    if after.shape != before.shape:
        return Difference(np.inf, np.inf)
    old, new = before.astype(np.float64), after.astype(np.float64)
    if not np.array_equal(np.isfinite(old), np.isfinite(new)):
        return Difference(np.inf, np.inf)
    finite = np.isfinite(old)
    old, new = old[finite], new[finite]
    if np.array_equal(old, new):
        return Difference(0.0, 0.0)
    least = max(_DARKEST * float(np.median(np.abs(old))), float(np.finfo(np.float32).tiny))
    relative = np.abs(new - old) / np.maximum(np.abs(old), least)
    return Difference(float(relative.max()), float(np.sqrt(np.mean(relative**2))))


def compare_files(before: Path, after: Path) -> tuple[str, float]:
    """What is to be said of two npz files, empty if they are equal, and the largest rms."""
    if before.read_bytes() == after.read_bytes():
        return "", 0.0
    with np.load(before) as olds, np.load(after) as news:
        if set(olds) != set(news):
            return f"arrays {sorted(olds)} are now {sorted(news)}", np.inf
        said, worst = [], 0.0
        for name in sorted(olds):
            old, new = olds[name], news[name]
            if not np.issubdtype(old.dtype, np.number):
                if not np.array_equal(old, new):
                    said.append(f"{name} {old} is now {new}")
                continue
            found = difference(new, old)
            worst = max(worst, found.rms)
            if found.largest > 0.0:
                seen = f", FLIP {flip(new, old):.4f}" if _is_picture(new, old) else ""
                said.append(f"{name} largest {found.largest:.2e}, rms {found.rms:.2e}{seen}")
        return "; ".join(said), worst


def _is_picture(*arrays: NDArray[Any]) -> bool:
    return all(array.ndim == 3 and array.shape[-1] == 3 for array in arrays)


def compare(before: Path, after: Path, bound: float) -> bool:
    """Print what differs between two folders; whether all is within the bound."""
    olds, news = (
        {path.relative_to(folder) for path in folder.rglob("*.npz")} for folder in (before, after)
    )
    good = bool(olds)
    for name in sorted(olds ^ news):
        print(f"{name} is in {before if name in olds else after} alone")
        good = False
    equal = 0
    for name in sorted(olds & news):
        said, rms = compare_files(before / name, after / name)
        equal += not said
        if said:
            print(f"{name}: {said}{'  ABOVE THE BOUND' if rms > bound else ''}")
        good &= rms <= bound
    print(f"{equal} of {len(olds & news)} files are equal; the bound of rms is {bound:g}")
    lines = [(folder / "digests.txt").read_text("utf-8").splitlines() for folder in (before, after)]
    other = set(lines[0]) ^ set(lines[1])
    for line in sorted(other)[:20]:
        print(f"digest in {before if line in lines[0] else after} alone: {line}")
    print(f"{len(set(lines[0]) & set(lines[1]))} digests are equal, {len(other)} lines differ")
    return good and not other


def main() -> None:
    """Make or compare."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("make").add_argument("folder", type=Path)
    comparison = commands.add_parser("compare")
    comparison.add_argument("before", type=Path)
    comparison.add_argument("after", type=Path)
    comparison.add_argument("--bound", type=float, default=BOUND, help="of rms")
    chosen = parser.parse_args()
    if chosen.command == "make":
        make(chosen.folder)
    elif not compare(chosen.before, chosen.after, chosen.bound):
        sys.exit(1)


if __name__ == "__main__":
    main()

"""Memory and time that broken and hostile files take until they are opened or refused.

    python -m vrut_lite_lab.broken_files.measure [--mangled 130] [--only WORD]

Each file is opened in a process of its own with a limited address space. Memory is the most that
was resident above what the process began with; time is CPU time of all its threads.
"""

import argparse
import contextlib
import multiprocessing
import resource
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from vrut_lite.errors import UserError
from vrut_lite.scene.budget import budget_of_environment
from vrut_lite.scene.loading import load_scene
from vrut_lite_lab.broken_files.bombs import BOMBS, Files, bomb
from vrut_lite_lab.broken_files.mangled import broken

ADDRESS_SPACE_BYTES = 7 * 2**30
MANGLED = "mangled scene"
_MIB = 2.0**20
_PATIENCE_S = 120


class OpenedFile(NamedTuple):
    """How opening a file ended, and the most memory that the rule allows for it."""

    end: str
    allowed_bytes: float


class FileRow(NamedTuple):
    """Time and memory of one file; without `opened` the process was killed or ended itself."""

    kind: str
    file_bytes: int
    peak_bytes: int
    cpu_s: float
    opened: OpenedFile | None


Open = Callable[[Path], OpenedFile]


def open_scene(path: Path) -> OpenedFile:
    """Open a scene under the default limit."""
    budget = budget_of_environment()
    try:
        end = f"{load_scene(path, budget).triangles:,} triangles"
    except UserError as refused:
        end = str(refused).removeprefix(f"cannot open the scene {path}: ")
    return OpenedFile(end, budget.peak_bytes)


def scene_files(
    folder: Path, mangled: int, kinds: Iterable[str] = tuple(BOMBS)
) -> Iterator[tuple[str, Path]]:
    """Kinds and paths of bombs and so many mangled scenes, each written when it is its turn."""
    for kind in kinds:
        yield kind, _written(folder, *bomb(kind))
    for number in range(mangled):
        yield MANGLED, _written(folder, *broken(number))


def measured(files: Iterable[tuple[str, Path]], open_file: Open) -> Iterator[FileRow]:
    """Open each file of a (kind, path) in a process of its own."""
    for kind, path in files:
        size = sum(file.stat().st_size for file in path.parent.iterdir())
        receiver, sender = multiprocessing.Pipe(duplex=False)
        child = multiprocessing.get_context("fork").Process(
            target=_open_alone, args=(open_file, path, sender)
        )
        child.start()
        sender.close()
        told = None
        if receiver.poll(_PATIENCE_S):
            with contextlib.suppress(EOFError):  # It was ended before it could tell.
                told = receiver.recv()
        child.kill()
        child.join()
        yield FileRow(kind, size, *(told or (0, float(_PATIENCE_S), None)))


def table(rows: list[FileRow]) -> Iterator[str]:
    """Markdown: a line for each kind, the most that one of its files took."""
    yield "| kind | files | largest, MiB | peak, MiB | by the rule, MiB | CPU, s | ends |"
    yield "|---|---:|---:|---:|---:|---:|---|"
    for kind in dict.fromkeys(row.kind for row in rows):
        alike = [row for row in rows if row.kind == kind]
        largest = max(row.file_bytes for row in alike) / _MIB
        peak = max(row.peak_bytes for row in alike) / _MIB
        allowed = max(row.opened.allowed_bytes / _MIB if row.opened else 0.0 for row in alike)
        cpu_s = max(row.cpu_s for row in alike)
        ends = {_short(row.opened) for row in alike}
        end = ends.pop() if len(ends) == 1 else f"{len(ends)} ways"
        yield (
            f"| {kind} | {len(alike)} | {largest:.2f} | {peak:.0f} | {allowed:.0f} "
            f"| {cpu_s:.2f} | {end} |"
        )


def _short(opened: OpenedFile | None) -> str:
    if opened is None:
        return "NO END"
    return opened.end if len(opened.end) < 90 else opened.end[:86] + " ..."


def _written(folder: Path, name: str, files: Files) -> Path:
    place = folder / str(sum(1 for _ in folder.iterdir()))
    place.mkdir()
    for file, content in files.items():
        (place / file).write_bytes(content)
    return place / name


def _open_alone(open_file: Open, path: Path, sender: Any) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE_BYTES, ADDRESS_SPACE_BYTES))
    before, start_s = _most_resident_bytes(), time.process_time()
    opened = open_file(path)
    sender.send((_most_resident_bytes() - before, time.process_time() - start_s, opened))


def _most_resident_bytes() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mangled", type=int, default=130, metavar="FILES")
    parser.add_argument("--only", default="", metavar="WORD", help="Bombs with this word in them.")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        kinds = [kind for kind in BOMBS if asked.only in kind]
        files = scene_files(Path(folder), asked.mangled, kinds)
        print("\n".join(table(list(measured(files, open_scene)))))


if __name__ == "__main__":
    main()

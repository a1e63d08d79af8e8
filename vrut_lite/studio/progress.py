"""Progress on a terminal; elsewhere nothing, and rich, which draws it, is not imported."""

import re
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import TYPE_CHECKING, TypeVar

from vrut_lite.compiling.pool import Progress as Compiling
from vrut_lite.kernel.trace import Remark, Trace

if TYPE_CHECKING:
    from rich.console import Console

T = TypeVar("T")
_LOOK_S = 0.3
_BAR_CELLS = 20
_SHARE = re.compile(r"(.*): (\d+)% ?(.*)")


def tracked(steps: Iterable[T], name: str, total: int | None = None) -> Iterable[T]:
    """The steps, with a bar that advances as they are taken."""
    if not _on_terminal():
        return steps
    from rich.progress import track

    return track(steps, name, total, console=_console(), transient=True)


@contextmanager
def advancing_bar(name: str, total: int) -> Iterator[Callable[[int], None]]:
    """A bar, and the function that advances it by a number of steps."""
    if not _on_terminal():
        yield lambda steps: None
        return
    from rich.progress import Progress

    with Progress(console=_console(), transient=True) as progress:
        task = progress.add_task(name, total=total)
        yield lambda steps: progress.advance(task, steps)


def busy_with(name: str, trace: Trace | None = None) -> AbstractContextManager[object]:
    """Shows the present work while entered; with a kernel's trace, the progress of its jobs."""
    return _following(name, trace) if _on_terminal() else nullcontext()


class _Shown:
    """The content of the terminal's one progress line."""

    is_on = False
    compiling: Compiling | None = None


def note_compiling(progress: Compiling) -> bool:
    """Show how far kernels are compiled in the line that `busy_with` keeps; False without one."""
    _Shown.compiling = None if progress.done == progress.total else progress
    return _Shown.is_on


def compiling_text(progress: Compiling) -> str:
    """Name of the kernel that is compiled, a bar, and the seconds left."""
    if progress.done == progress.total:
        return f"compiled {progress.total} kernels"
    cells = _BAR_CELLS * progress.done // max(progress.total, 1)
    bar = "\N{BOX DRAWINGS HEAVY HORIZONTAL}" * cells
    bar += "\N{BOX DRAWINGS LIGHT HORIZONTAL}" * (_BAR_CELLS - cells)
    return (
        f"compiling kernels, once {bar} {progress.done} of {progress.total}, "
        f"{progress.left_s:.0f} s to go ({progress.title})"
    )


@contextmanager
def _following(name: str, trace: Trace | None) -> Iterator[object]:
    """Shows a line with the progress of compilation, or else with the latest work of the trace."""
    ended = threading.Event()
    with _console().status(name) as status:
        _Shown.is_on = True

        def follow() -> None:
            while not ended.wait(_LOOK_S):
                if _Shown.compiling is not None:
                    status.update(f"{name}: {compiling_text(_Shown.compiling)}")
                elif trace is not None:
                    status.update(f"{name}{progress_text(trace.remarks())}")

        thread = threading.Thread(target=follow, daemon=True)
        thread.start()
        try:
            yield status
        finally:
            _Shown.is_on = False
            ended.set()
            thread.join()


def progress_text(remarks: Sequence[Remark]) -> str:
    """How far the job is that told its progress last, and the seconds that it still takes.

    Seconds are those of an even pace since the job's first remark. Empty where no job has told
    any, or where the last has ended.
    """
    told = [
        (remark, share)
        for remark in remarks
        if remark.kind == "progress" and (share := _SHARE.fullmatch(remark.text)) is not None
    ]
    if not told:
        return ""
    last, found = told[-1]
    job = last.module, found[1]
    own = [(r, int(share[2])) for r, share in told if (r.module, share[1]) == job]
    (first, began), done = own[0], int(found[2])
    if done >= 100:
        return ""
    line = f": {found[3] or f'{done} %'}"
    seconds = (last.end_ns - first.end_ns) / 1e9
    if done > began:
        line += f", {seconds * (100 - done) / (done - began):.0f} s to go"
    return line


def _on_terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty()


def _console() -> "Console":
    from rich.console import Console

    return Console(stderr=True)

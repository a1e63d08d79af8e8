"""Progress on a terminal; elsewhere nothing, and rich, which draws it, is not imported."""

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from rich.console import Console

T = TypeVar("T")


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


def busy_with(name: str) -> AbstractContextManager[object]:
    """Shows, while entered, what is being done."""
    return _console().status(name) if _on_terminal() else nullcontext()


def _on_terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty()


def _console() -> "Console":
    from rich.console import Console

    return Console(stderr=True)

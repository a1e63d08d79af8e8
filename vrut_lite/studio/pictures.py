"""Pictures of many instants: made one after another here, or by workers elsewhere.

A `PicturePlan` can be sent to another process, where it opens a `Studio`; that makes a
`MadePicture` of an instant. Its bytes are the same on every worker, and this process writes it
atomically.
"""

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Executor
from datetime import datetime
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import NamedTuple, Protocol

import click

from vrut_lite.errors import UserError
from vrut_lite.pictures.display import Bits
from vrut_lite.studio.progress import tracked
from vrut_lite.studio.time_span import Wanted
from vrut_lite.write_atomic import atomic_output

# Pictures queued ahead of the next one to write: keeps workers busy and bounds memory.
AHEAD = 64


class MadePicture(Protocol):
    """A picture that was made."""

    @property
    def caption(self) -> str:
        """The caption: hour, sun and more."""

    @property
    def notices(self) -> tuple[str, ...]:
        """Lines on what the scene has and the picture lacks."""

    def write(self, path: Path) -> None:
        """Write the picture and its companion files."""


class Studio(Protocol):
    """All that is needed for one picture after another."""

    def shoot(self, instant: datetime) -> MadePicture:
        """The picture of an instant, whatever was made before."""

    def close(self) -> None:
        """Free its resources."""


class PicturePlan(Protocol):
    """The inputs of pictures without the instant; can be pickled and compared."""

    def open(self) -> Studio:
        """Load and open all that the pictures share.

        Raises:
            UserError: the plan is invalid.
        """


class Made(NamedTuple):
    """A picture's files by their suffixes, its caption, and what it lacks."""

    files: dict[str, bytes]
    caption: str
    notices: tuple[str, ...] = ()


def make_pictures(
    plan: PicturePlan, wanted: Sequence[Wanted], workers: Executor | None
) -> list[str]:
    """Make and write pictures, here or by workers; their captions.

    Missing parts are reported once, on the error stream. Finished pictures stay after a failure,
    Ctrl-C included.
    """
    captions: Iterable[str] = _elsewhere(plan, wanted, workers) if workers else _here(plan, wanted)
    if len(wanted) > 1:
        captions = tracked(captions, "pictures", len(wanted))
    return list(captions)


def _here(plan: PicturePlan, wanted: Sequence[Wanted]) -> Iterator[str]:
    studio = plan.open()
    try:
        for number, (instant, path) in enumerate(wanted):
            shot = studio.shoot(instant)
            if number == 0:
                tell_notices(shot.notices)
            shot.write(path)
            yield shot.caption
    finally:
        studio.close()


def _elsewhere(plan: PicturePlan, wanted: Sequence[Wanted], workers: Executor) -> Iterator[str]:
    waiting = iter(wanted)
    asked = deque(
        (path, workers.submit(make_one, plan, instant, path.suffix))
        for (instant, path), _ in zip(waiting, range(AHEAD), strict=False)
    )
    told = False
    while asked:
        path, promise = asked.popleft()
        made = promise.result()
        if not told:
            tell_notices(made.notices)
        told = True
        for suffix, content in made.files.items():
            with atomic_output(path.with_suffix(suffix)) as beside:
                beside.write_bytes(content)
        following = next(waiting, None)
        if following is not None:
            promise = workers.submit(make_one, plan, following.instant, following.path.suffix)
            asked.append((following.path, promise))
        yield made.caption


def tell_notices(notices: Sequence[str]) -> None:
    """Write what a picture or a journal lacks of the scene's files to the error stream."""
    for line in notices:
        click.echo(f"vrut-lite: {line}", err=True)


def said_of(wanted: Sequence[Wanted], captions: Sequence[str]) -> str:
    """One line on the written pictures."""
    if len(wanted) == 1:
        return f"{wanted[0].path}: {captions[0]}"
    files = f"{wanted[0].path} to {wanted[-1].path.name}"
    return f"{files}: {len(wanted)} pictures, from {captions[0]}, to {captions[-1]}"


_lock = Lock()
_open: list[tuple[PicturePlan, Studio]] = []


def make_one(plan: PicturePlan, instant: datetime, suffix: str) -> Made:
    """Make one picture in a worker, whose studio stays open for the next of this plan."""
    # A cluster's worker may have several threads, and a kernel is for one at a time.
    with _lock, TemporaryDirectory() as folder:
        shot = _studio(plan).shoot(instant)
        name = Path(folder) / "picture"
        shot.write(name.with_suffix(suffix))
        files = {path.name.removeprefix(name.name): path.read_bytes()
                 for path in sorted(Path(folder).iterdir())}  # fmt: skip
        return Made(files, shot.caption, shot.notices)


def _studio(plan: PicturePlan) -> Studio:
    if _open and _open[0][0] != plan:
        _open.pop()[1].close()
    if not _open:
        _open.append((plan, plan.open()))
    return _open[0][1]


bits_option = click.option(
    "--bits",
    type=click.Choice(["8", "16"]),
    help="Of a PNG's channels: 8 (the default), dithered, or 16.",
)


def picture_bits(text: str | None, suffix: str) -> Bits:
    """The value of --bits.

    Raises:
        UserError: the format has a fixed precision.
    """
    if text is not None and suffix != ".png":
        raise UserError(f"--bits is for .png: {suffix} has a precision of its own")
    return 16 if text == "16" else 8

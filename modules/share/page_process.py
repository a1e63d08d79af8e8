"""A page made in another process, whose progress a panel shows and which it can cancel."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NamedTuple, TypeVar

from share.shared_page import shared_page
from share.stills import stills_of
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.headless import Project

T = TypeVar("T")
# Basis maps of the light: the default of the command.
TERMS = 40


class PageProgress(NamedTuple):
    """Present work, and how many of its steps are done; no steps where they cannot be counted."""

    work: str
    done: int = 0
    total: int = 0


@dataclass(frozen=True)
class PageMade:
    """The page's text, and the modules whose glows in the sky it lacks."""

    text: str
    left_out: tuple[str, ...]


@dataclass(frozen=True)
class PageRefused:
    """A sentence that says why there is no page."""

    sentence: str


def make_page(pipe: Connection, project: Project, title: str, numbers: Path | None) -> None:
    """Make a page; `PageProgress` and then `PageMade` or `PageRefused` go into the pipe.

    `numbers` is a folder of `vrut-lite daylight`, or None.
    """

    def tracked(steps: Iterable[T], name: str, total: int) -> Iterator[T]:
        for done, step in enumerate(steps):
            pipe.send(PageProgress(name, done, total))
            yield step

    try:
        pipe.send(PageProgress("pictures of four hours"))
        stills = stills_of(project)
        pipe.send(PageProgress("rays of the light map, and skies"))
        page = shared_page(project, title, None, TERMS, stills, numbers, tracked)
        pipe.send(PageMade(page.text, page.left_out))
    except UserError as error:
        pipe.send(PageRefused(str(error)))
    except BaseException as error:
        pipe.send(PageRefused(f"the page failed: {sentence_of(error)}"))
        raise

"""A pytest plugin for module authors: replay a journal, compare, or accept what changed."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.replay import Replay, rerecord
from vrut_lite.write_atomic import atomic_output

# pytest loads this file in every project of the environment: heavy imports are lazy.
if TYPE_CHECKING:
    from vrut_lite.kernel.module import Module
    from vrut_lite.recording.replay import Outcome
    from vrut_lite.recording.setup import Services

_OPTION = "--update-journals"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add --update-journals."""
    parser.addoption(
        _OPTION,
        action="store_true",
        help="Write the journals that tests replay anew, accepting what modules say now.",
    )


@pytest.fixture
def replay_journal(request: pytest.FixtureRequest) -> Callable[..., Outcome]:
    """A function that replays a journal and fails the test at the first message that differs.

    `replay_journal(path, modules=None, services=None)` returns the `Outcome`. `modules` are
    the classes that the journal may name (default: all that are installed, and the host's own but
    for its scene manager), `services` further
    constructor arguments by module name.
    """
    updating = request.config.getoption(_OPTION)

    def replay(
        path: str | Path,
        modules: Iterable[type[Module]] | None = None,
        services: Services | None = None,
    ) -> Outcome:
        known = None if modules is None else list(modules)
        if updating:
            update_journal(path, known, services)
        outcome = Replay(Journal(path), known, services).run()
        if outcome.difference is not None:
            pytest.fail(f"{path}: {outcome.difference}\n(accept it with {_OPTION})", pytrace=False)
        return outcome

    return replay


def update_journal(
    path: str | Path,
    modules: Iterable[type[Module]] | None = None,
    services: Services | None = None,
) -> None:
    """Record a journal again from its own inputs; the old file stays if that fails."""
    journal = Journal(path)
    with atomic_output(path) as beside, beside.open("wb") as stream:
        rerecord(journal, stream, modules, services)

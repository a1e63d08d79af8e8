"""Cancels long work between two of its steps."""

from collections.abc import Callable

# Called between steps; raises GivenUp where the work is to end.
GoOn = Callable[[], None]


class GivenUp(Exception):
    """The work was cancelled."""


def always() -> None:
    """Let the work go on."""


def unless(cancelled: Callable[[], bool]) -> GoOn:
    """Let the work go on until `cancelled` answers yes."""

    def go_on() -> None:
        if cancelled():
            raise GivenUp

    return go_on

"""Cancels long work between two of its steps."""

from collections.abc import Callable

from vrut_lite.errors import GivenUp

# Called between steps; raises GivenUp where the work is to end.
CancelCheck = Callable[[], None]


def always() -> None:
    """Let the work go on."""


def unless(cancelled: Callable[[], bool]) -> CancelCheck:
    """Let the work go on until `cancelled` answers yes."""

    def go_on() -> None:
        if cancelled():
            raise GivenUp

    return go_on

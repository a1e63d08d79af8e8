"""Long work ends between two of its steps when nobody waits for it any more."""

from collections.abc import Callable

# Called between steps; raises GivenUp where the work is to end.
GoOn = Callable[[], None]


class GivenUp(Exception):
    """Nobody waits for what is being made."""


def always() -> None:
    """Let the work go on."""


def unless(cancelled: Callable[[], bool]) -> GoOn:
    """Let the work go on until `cancelled` answers yes."""

    def go_on() -> None:
        if cancelled():
            raise GivenUp

    return go_on

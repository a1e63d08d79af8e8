"""An action: an entry of a menu, of the command palette and of the list of keys."""

from collections.abc import Callable
from typing import Any, NamedTuple


class ActionSpec(NamedTuple):
    """Calls `act` when triggered; a `checkable` action passes its new state.

    Exactly one checkable action of a `group` is on.
    """

    name: str
    menu: str
    title: str
    keys: str
    act: Callable[..., Any]
    checkable: bool = False
    group: str = ""

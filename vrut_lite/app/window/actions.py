"""An action: an entry of a menu, of the command palette and of the list of keys."""

from collections.abc import Callable
from typing import Any, NamedTuple


class ActionSpec(NamedTuple):
    """What `act` does, once it is triggered; a `checkable` one is called with whether it is on.

    Of the checkable actions of a `group` one is on.
    """

    name: str
    menu: str
    title: str
    keys: str
    act: Callable[..., Any]
    checkable: bool = False
    group: str = ""

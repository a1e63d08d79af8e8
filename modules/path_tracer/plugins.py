"""Our own plugins of mitsuba, made known once to each of its variants."""

from collections.abc import Callable
from typing import Any

_registered: set[tuple[str, str]] = set()


def register(mitsuba: Any, name: str, kind: str, make: Callable[[Any], Any]) -> None:
    """Make a plugin known to the variant of mitsuba that is set, unless it is.

    `make` is given mitsuba and returns the class of a `kind` (bsdf, emitter, integrator), which
    must descend from the variant's own.
    """
    key = (mitsuba.variant(), name)
    if key not in _registered:
        getattr(mitsuba, f"register_{kind}")(name, make(mitsuba))
        _registered.add(key)

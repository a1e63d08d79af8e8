"""Tables that follow from a solved sky, kept as long as that sky."""

from collections.abc import Callable
from functools import wraps
from threading import Lock
from typing import Concatenate, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

from bruneton_sky.solver import SourceField

P = ParamSpec("P")
T = TypeVar("T")
# Tables of one field, for instance of the last few altitudes of an eye.
_MOST = 4


def table_of_field(
    function: Callable[Concatenate[SourceField, P], T],
) -> Callable[Concatenate[SourceField, P], T]:
    """Caches results of a function of a field, and of further arguments, until the field is freed.

    A field has 30 MiB, with twelve wavelengths 90, and its tables as much again: a cache of the
    last few fields would keep several of them that nothing shows any more. Results must not refer
    to the field.
    """
    known: WeakKeyDictionary[SourceField, dict[object, T]] = WeakKeyDictionary()
    lock = Lock()

    @wraps(function)
    def table(field: SourceField, *more: P.args, **named: P.kwargs) -> T:
        key = more, tuple(named.items())
        with lock:
            tables = known.setdefault(field, {})
            if key in tables:
                return tables[key]
        made = function(field, *more, **named)
        with lock:
            while len(tables) >= _MOST:
                del tables[next(iter(tables))]
            tables[key] = made
        return made

    return table

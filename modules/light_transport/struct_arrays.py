"""Structures of messages as arrays by name, for the cache of arrays, and back."""

from collections.abc import Iterator
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array

S = TypeVar("S", bound=msgspec.Struct)


def arrays_of(value: msgspec.Struct, before: str = "") -> Iterator[tuple[str, NDArray[Any]]]:
    """The fields of a structure that holds arrays, numbers, texts, rows of numbers, structures of
    these, or None, by `before` and their name."""
    for name in value.__struct_fields__:
        field = getattr(value, name)
        if isinstance(field, msgspec.Struct):
            yield from arrays_of(field, f"{before}{name}.")
        elif isinstance(field, Array):
            yield before + name, field.values
        elif isinstance(field, str):
            yield before + name, np.frombuffer(field.encode(), np.uint8)
        elif field is not None:
            yield before + name, np.asarray(field)


def struct_of(kind: type[S], arrays: dict[str, NDArray[Any]], before: str = "") -> S:
    """The structure whose `arrays_of` these are."""
    hints = get_type_hints(kind)
    fields = {name: _field(hints[name], arrays, before + name) for name in kind.__struct_fields__}
    return kind(**fields)


def _field(hint: Any, arrays: dict[str, NDArray[Any]], name: str) -> Any:
    kinds = [kind for kind in get_args(hint) if isinstance(kind, type)]
    kind = kinds[0] if type(None) in kinds else hint
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        inside = f"{name}."
        there = any(other.startswith(inside) for other in arrays)
        return struct_of(kind, arrays, inside) if there else None
    values = arrays.get(name)
    if values is None:
        return None
    if kind is Array:
        return Array(values)
    if kind is str:
        return values.tobytes().decode()
    return tuple(values.tolist()) if get_origin(kind) is tuple else values.item()

"""Messages as they were delivered, for later inspection.

A message's fields are frozen, but its poster and its listeners can change a list or dictionary in
one.
"""

import dataclasses
from collections.abc import Sequence
from datetime import datetime
from typing import Any, TypeVar

import msgspec
import numpy as np

from vrut_lite.array import Array
from vrut_lite.kernel.messages import Message

M = TypeVar("M", bound=Message)

_UNCHANGING = frozenset({bool, int, float, str, bytes, type(None), datetime, Array})


def frozen_copy(message: M) -> M:
    """The message, or a copy of it that shares nothing mutable with it.

    Both have the same journal entry. Copies cost as much as is copied; what cannot change is
    shared.
    """
    copies = _changed_fields(message)
    return msgspec.structs.replace(message, **copies) if copies else message


def _changed_fields(structure: msgspec.Struct) -> dict[str, Any]:
    """The fields that need copies, and those."""
    copies = {}
    for name in structure.__struct_fields__:
        value = getattr(structure, name)
        if type(value) not in _UNCHANGING and (copy := _copy(value)) is not value:
            copies[name] = copy
    return copies


def _copy(value: Any) -> Any:
    """The value itself if it is immutable, else an equal copy."""
    if type(value) in _UNCHANGING:
        return value
    match value:
        case np.ndarray():
            return value if value.dtype.hasobject else Array(value.copy())
        case list() | tuple() if not hasattr(value, "_fields"):
            return _copy_of_items(value)
        case dict():
            return {key: _copy(item) for key, item in value.items()}
        case msgspec.Struct():
            copies = _changed_fields(value)
            shared = value.__struct_config__.frozen and not copies
            return value if shared else msgspec.structs.replace(value, **copies)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        names = [field.name for field in dataclasses.fields(value)]
    elif hasattr(value, "_fields"):
        names = list(value._fields)
    else:
        return value
    return {name: _copy(getattr(value, name)) for name in names}


def _copy_of_items(value: Sequence[Any]) -> Any:
    if type(value) is tuple and _UNCHANGING.issuperset(map(type, value)):
        return value
    copies = [_copy(item) for item in value]
    same = type(value) is tuple and all(a is b for a, b in zip(value, copies, strict=True))
    return value if same else copies

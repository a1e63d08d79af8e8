"""Types of messages as msgspec can convert them: a union with a type of ours it cannot."""

from functools import cache
from typing import Any, TypeVar, get_args, get_type_hints

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.kernel.array import Array
from vrut_lite.kernel.messages import Message

M = TypeVar("M", bound=Message)


def convert(plain: Any, kind: type[M]) -> M:
    """A message of this type from its fields.

    Raises:
        msgspec.ValidationError, OverflowError: a field does not fit.
        UserError: a field that holds an array holds something else.
    """
    unions = _unions_of(kind)
    if not unions:
        return msgspec.convert(plain, kind)
    wire = msgspec.convert(plain, _wire_type(kind))
    fields = {name: getattr(wire, name) for name in wire.__struct_fields__}
    for name, types in unions.items():
        if not isinstance(fields[name], types):
            raise UserError(f"{name} is no array")
    return kind(**fields)


@cache
def _unions_of(kind: type[Message]) -> dict[str, tuple[type, ...]]:
    """The fields that may hold an array or something else of ours, and what they may hold."""
    hints = get_type_hints(kind)
    return {
        name: get_args(hints[name])
        for name in kind.__struct_fields__
        if Array in get_args(hints[name])
    }


@cache
def _wire_type(kind: type[Message]) -> type[Any]:
    """The type with such fields left open."""
    hints, unions = get_type_hints(kind), _unions_of(kind)
    fields = [
        (
            field.name,
            Any if field.name in unions else hints[field.name],
            *(() if field.required else (field.default,)),
        )
        for field in msgspec.structs.fields(kind)
    ]
    return msgspec.defstruct(kind.__name__, fields, frozen=True, kw_only=True)

"""Message types in a form that msgspec can convert: it refuses unions with our own types."""

from functools import cache
from typing import Any, TypeVar, get_args, get_type_hints

import msgspec

from vrut_lite.array import Array
from vrut_lite.errors import UserError

S = TypeVar("S", bound=msgspec.Struct)


def convert(plain: Any, kind: type[S]) -> S:
    """A message of this type, or a structure that one holds, from its fields.

    Raises:
        msgspec.ValidationError, OverflowError: a field does not fit.
        UserError: a field that holds an array holds something else.
    """
    unions, structures = _unions_of(kind), _structures_of(kind)
    if not unions and not structures:
        return msgspec.convert(plain, kind)
    wire = msgspec.convert(plain, _wire_type(kind))
    fields = {name: getattr(wire, name) for name in wire.__struct_fields__}
    for name, types in unions.items():
        if not isinstance(fields[name], types):
            raise UserError(f"{name} is no array")
    for name, structure in structures.items():
        if fields[name] is not None:
            fields[name] = convert(fields[name], structure)
    return kind(**fields)


@cache
def _unions_of(kind: type[msgspec.Struct]) -> dict[str, tuple[type, ...]]:
    """The fields that may hold an array or something else of ours, and what they may hold."""
    hints = get_type_hints(kind)
    return {
        name: get_args(hints[name])
        for name in kind.__struct_fields__
        if Array in get_args(hints[name])
    }


@cache
def _structures_of(kind: type[msgspec.Struct]) -> dict[str, type[msgspec.Struct]]:
    """Fields that hold None or a structure with such fields itself, and the structure's type."""
    hints = get_type_hints(kind)
    return {
        name: part
        for name in kind.__struct_fields__
        for part in get_args(hints[name])
        if isinstance(part, type) and issubclass(part, msgspec.Struct) and _unions_of(part)
    }


@cache
def _wire_type(kind: type[msgspec.Struct]) -> type[Any]:
    """The type with such fields left open; like it, strict or not about unknown ones."""
    hints, left_open = get_type_hints(kind), {*_unions_of(kind), *_structures_of(kind)}
    fields = [
        (
            field.name,
            Any if field.name in left_open else hints[field.name],
            *(() if field.required else (field.default,)),
        )
        for field in msgspec.structs.fields(kind)
    ]
    strict = kind.__struct_config__.forbid_unknown_fields
    return msgspec.defstruct(
        kind.__name__, fields, frozen=True, kw_only=True, forbid_unknown_fields=strict
    )

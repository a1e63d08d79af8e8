"""Messages as plain JSON values and back; a journal from a stranger can run no code.

A message becomes an object of its fields. An `Array` becomes {"$array": digest, "dtype",
"shape", "sample"}; a float that JSON lacks {"$float": "nan"}; a time is ISO 8601 in UTC.
A value that has no such form (only a job's result may hold one) becomes {"$opaque": its
type} and cannot be read back.
"""

import dataclasses
import functools
import hashlib
import math
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any, TypeVar, get_args, get_type_hints

import msgspec
import numpy as np

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Message

# Limits of messages from strangers: largest JSON text of a message and largest array, in bytes.
MESSAGE_BYTES, ARRAY_BYTES = 2**20, 2**28
# Nested lists: code that walks through a message recurses for each level.
NESTING = 64
# Values of an array that stand in its plain form.
SAMPLES = 32
# A traceback names files and lines: it differs between two checkouts of the same program.
_NOT_RECORDED = {"Fault": ("trace",), "JobResult": ("trace",)}

M = TypeVar("M", bound=Message)
S = TypeVar("S", bound=msgspec.Struct)
Handle = dict[str, Any]
FindArray = Callable[[Handle], Array]


def to_plain(value: Any) -> Any:
    """A message, or a value of one, as JSON types."""
    match value:
        case None | bool() | str():
            return value
        case int():
            return int(value)
        case float() | np.floating():
            number = float(value)
            return number if math.isfinite(number) else {"$float": repr(number)}
        case np.bool_() | np.integer():
            return value.item()
        case datetime():
            return _time_text(value)
        case Array():
            return _handle(value)
        case np.ndarray() if not value.dtype.hasobject:
            return _handle(Array(value.view()))
        case list() | tuple() if not hasattr(value, "_fields"):
            return [to_plain(item) for item in value]
        case dict():
            return {str(key): to_plain(item) for key, item in value.items()}
    return _fields_of(value)


def from_plain(plain: Any, find_array: FindArray) -> Any:
    """The plain value with its arrays and its odd floats put back.

    Raises:
        UserError: an array is missing, a number is too large, or a value was opaque.
    """
    if isinstance(plain, int) and abs(plain) >= 2**63:
        raise UserError("a whole number has more than 64 bits")
    if isinstance(plain, list):
        return [from_plain(item, find_array) for item in plain]
    if not isinstance(plain, dict):
        return plain
    if "$array" in plain:
        return find_array(plain)
    if "$float" in plain:
        return {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}.get(str(plain["$float"]))
    if "$opaque" in plain:
        raise UserError(f"a value of type {plain['$opaque']} is known by name only")
    return {key: from_plain(item, find_array) for key, item in plain.items()}


def no_arrays(handle: Handle) -> Array:
    """The `FindArray` of a light journal."""
    raise UserError(f"the journal lacks the array {handle['$array']}: record it with --full")


def decode(kind: type[M], plain: Any, find_array: FindArray = no_arrays) -> M:
    """A message of this type from its plain form, of the right types; see `Message.check`.

    Raises:
        UserError: a field is missing, unknown, of another type or out of bounds, named.
    """
    check_nesting(plain)
    if isinstance(plain, dict):
        for name in plain:
            if name not in kind.__struct_fields__:
                raise UserError(f"{kind.__name__} has no field {name!r}")
    try:
        return _converted(from_plain(plain, find_array), kind)
    except UserError as error:
        raise UserError(f"{kind.__name__}: {error}") from None
    except (msgspec.ValidationError, OverflowError) as error:
        raise UserError(f"{kind.__name__}: {error}") from None


def check_nesting(plain: Any) -> None:
    """Raise UserError if a plain value has lists or objects within each other for too long."""
    containers = [plain] if isinstance(plain, dict | list) else []
    for _ in range(NESTING):
        containers = [
            part
            for container in containers
            for part in (container.values() if type(container) is dict else container)
            if type(part) is list or type(part) is dict
        ]
    if containers:
        raise UserError(f"it nests more than {NESTING} levels deep")


def digest_of(type_name: str, plain: Any) -> str:
    """Hexadecimal BLAKE2b-128 of a plain message; its arrays count by their own digests.

    Raises:
        UserError: it nests too deep for a journal.
    """
    body = msgspec.json.encode(plain, order="sorted")
    # Most messages are small and without arrays; to walk through them takes ten times as long.
    if body.count(b"[") + body.count(b"{") > NESTING:
        check_nesting(plain)
    if b'"$array"' in body:
        body = msgspec.json.encode(_without_samples(plain), order="sorted")
    return hashlib.blake2b(type_name.encode() + b"\0" + body, digest_size=16).hexdigest()


def arrays_of(value: Any) -> list[Array]:
    """Every array of a message, in order of its fields."""
    match value:
        case Array():
            return [value]
        case np.ndarray() if not value.dtype.hasobject:
            return [Array(value.view())]
        case list() | tuple():
            return [array for item in value for array in arrays_of(item)]
        case dict():
            return [array for item in value.values() for array in arrays_of(item)]
        case msgspec.Struct():
            return arrays_of([getattr(value, name) for name in value.__struct_fields__])
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return arrays_of([getattr(value, field.name) for field in dataclasses.fields(value)])
    return []


def _time_text(time: datetime) -> str:
    """The instant in UTC, without its time zone."""
    try:
        return (time if time.tzinfo is None else time.astimezone(UTC)).isoformat()
    except OverflowError:  # Its UTC lies outside the years 1 to 9999.
        return time.isoformat()


def _fields_of(value: Any) -> Any:
    if isinstance(value, msgspec.Struct):
        return _struct_fields(value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        names = [field.name for field in dataclasses.fields(value)]
    elif hasattr(value, "_fields"):
        names = list(value._fields)
    else:
        return {"$opaque": type(value).__qualname__}
    return {name: to_plain(getattr(value, name)) for name in names}


def _struct_fields(value: msgspec.Struct) -> dict[str, Any]:
    left_out = _NOT_RECORDED.get(type(value).__name__, ())
    floats = _float_fields(type(value))
    plain = {}
    for name in value.__struct_fields__:
        if name not in left_out:
            field = to_plain(getattr(value, name))
            plain[name] = _as_floats(field) if name in floats else field
    return plain


@functools.cache
def _float_fields(kind: type[msgspec.Struct]) -> frozenset[str]:
    """Names of the fields that hold floats alone, be it in tuples."""
    hints = get_type_hints(kind)
    return frozenset(name for name in kind.__struct_fields__ if _leaves(hints[name]) == {float})


def _leaves(hint: Any) -> set[Any]:
    parts = [part for part in get_args(hint) if part is not Ellipsis]
    return {leaf for part in parts for leaf in _leaves(part)} if parts else {hint}


def _as_floats(plain: Any) -> Any:
    """1 as 1.0, since a journal's float fields are read as floats."""
    if isinstance(plain, list):
        return [_as_floats(item) for item in plain]
    return float(plain) if type(plain) is int else plain


def _handle(array: Array) -> dict[str, Any]:
    return {
        "$array": array.digest,
        "dtype": array.dtype.str,
        "shape": list(array.shape),
        "sample": _sample(array),
    }


def _sample(array: Array) -> list[Any]:
    """Up to SAMPLES values, evenly spaced over the flattened array, its ends among them."""
    if array.dtype.kind not in "biuf":
        return []
    flat = array.values.reshape(-1)
    count = min(SAMPLES, flat.size)
    places = np.linspace(0, max(flat.size - 1, 0), count).round().astype(int)
    return [to_plain(_rounded(flat[place])) for place in places]


def _rounded(value: Any) -> Any:
    # Compared to a thousandth: more digits would fill a light journal.
    return float(f"{value:.6g}") if isinstance(value, np.floating) else value


def _without_samples(plain: Any) -> Any:
    if isinstance(plain, list):
        return [_without_samples(item) for item in plain]
    if not isinstance(plain, dict):
        return plain
    handle = "$array" in plain
    return {k: _without_samples(v) for k, v in plain.items() if not (handle and k == "sample")}


# msgspec refuses unions with our own types: such fields are left open, and converted apart.


def _converted(plain: Any, kind: type[S]) -> S:
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
            fields[name] = _converted(fields[name], structure)
    return kind(**fields)


@functools.cache
def _unions_of(kind: type[msgspec.Struct]) -> dict[str, tuple[type, ...]]:
    """The fields that may hold an array or something else of ours, and what they may hold."""
    hints = get_type_hints(kind)
    return {
        name: get_args(hints[name])
        for name in kind.__struct_fields__
        if Array in get_args(hints[name])
    }


@functools.cache
def _structures_of(kind: type[msgspec.Struct]) -> dict[str, type[msgspec.Struct]]:
    """Fields that hold None or a structure with such fields itself, and the structure's type."""
    hints = get_type_hints(kind)
    return {
        name: part
        for name in kind.__struct_fields__
        for part in get_args(hints[name])
        if isinstance(part, type) and issubclass(part, msgspec.Struct) and _unions_of(part)
    }


@functools.cache
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

"""Which messages can cross, and what must hold of one that a stranger sent."""

import math
from typing import Any

import msgspec
import numpy as np

from vrut_lite.errors import UserError
from vrut_lite.kernel import messages
from vrut_lite.kernel.array import Array
from vrut_lite.kernel.gpu_texture import GpuTexture
from vrut_lite.kernel.messages import (
    AirChanged,
    AirVolume,
    BackgroundChanged,
    ClockMoved,
    Derived,
    SceneNeeds,
)
from vrut_lite.kernel.recording.codec import FindArray, arrays_of, decode, no_arrays

# All that a slot's holder says, and what producers of light ask after.
SLOT_PRODUCTS: tuple[type[Derived], ...] = tuple(
    kind
    for kind in vars(messages).values()
    if isinstance(kind, type) and issubclass(kind, Derived) and kind.slot is not None
)
SHAREABLE: tuple[type[Derived], ...] = (*SLOT_PRODUCTS, ClockMoved, SceneNeeds)
BY_NAME = {kind.__name__: kind for kind in SHAREABLE}

# A cube's edge (0: any) and a table's size: what every consumer of these messages relies on.
_SHAPES = {
    "BackgroundChanged": ((6, 0, 0, 3), ("|u1", "<f2", "<f4")),
    "AmbientChanged": ((25, 3), ("<f4", "<f8")),
}


def types_named(names: str, setting: str) -> tuple[type[Derived], ...]:
    """The message types of a comma list.

    Raises:
        UserError: a name is not that of a type which can cross.
    """
    found = []
    for name in filter(None, (part.strip() for part in names.split(","))):
        if name not in BY_NAME:
            raise UserError(
                f"{setting} of zenoh_bridge names {name!r}, which cannot cross: "
                f"choose from {', '.join(BY_NAME)}"
            )
        found.append(BY_NAME[name])
    return tuple(found)


def revive(type_name: str, fields: Any, find_array: FindArray = no_arrays) -> Derived:
    """A message from its type's name and its fields, checked for what consumers rely on.

    Raises:
        UserError: the type cannot cross, or a field is missing, unknown or not as it must be.
    """
    if type_name not in BY_NAME:
        raise UserError(f"a message of type {type_name[:40]!r} cannot cross")
    message = decode(BY_NAME[type_name], fields, find_array)
    if isinstance(message, BackgroundChanged):
        # A stranger's shader is not run; the cube map shows the same, less sharply.
        message = msgspec.structs.replace(message, view=None)
    _check(message)
    return message


def texture_in(message: Derived) -> bool:
    """Whether a message holds a texture, which cannot leave its GPU."""
    carrier: msgspec.Struct = message
    if isinstance(message, AirChanged) and message.volume is not None:
        carrier = message.volume
    values = (getattr(carrier, name) for name in carrier.__struct_fields__)
    return any(isinstance(value, GpuTexture) for value in values)


def _check(message: Derived) -> None:
    name = type(message).__name__
    for field in message.__struct_fields__:
        if not _finite(getattr(message, field)):
            raise UserError(f"{name}: {field} is not finite")
    if name in _SHAPES:
        for array in arrays_of(message):
            _check_array(name, array, *_SHAPES[name])
    if isinstance(message, AirChanged) and message.volume is not None:
        _check_air(message.volume)


def _check_air(volume: AirVolume) -> None:
    """Refuse tables that do not go with each other, or have nothing to blend between."""
    slices, rows, _ = (*volume.extinction.shape, 0, 0, 0)[:3]
    shapes = [array.shape for array in arrays_of(volume)]
    fits = shapes == [(3, slices, rows, volume.columns, 3), (slices, rows, 3)]
    fits &= min(slices, volume.columns) >= 2
    fits &= rows == volume.rows_above + volume.rows_below
    fits &= min(volume.rows_above, volume.rows_below) >= 2
    dtypes = [array.dtype.str for array in arrays_of(volume)]
    lengths = volume.reach_m, volume.ground_radius_m, volume.top_altitude_m
    beneath = volume.observer_altitude_m < 0.0
    if not fits or dtypes != ["<f2", "<f4"] or min(lengths) <= 0.0 or beneath:
        raise UserError("AirChanged: the tables of its volume do not fit each other")


def _check_array(name: str, array: Array, shape: tuple[int, ...], dtypes: tuple[str, ...]) -> None:
    free_edges = {n for n, wanted in zip(array.shape, shape, strict=False) if not wanted}
    fits = len(array.shape) == len(shape) and all(
        n == (wanted or n) for n, wanted in zip(array.shape, shape, strict=True)
    )
    if not fits or len(free_edges) > 1 or 0 in free_edges or array.dtype.str not in dtypes:
        raise UserError(f"{name}: an array {array.shape} of {array.dtype} does not fit it")


def _finite(value: Any) -> bool:
    if isinstance(value, AirVolume):
        return all(_finite(getattr(value, name)) for name in value.__struct_fields__)
    if isinstance(value, tuple):
        return all(_finite(item) for item in value)
    return not isinstance(value, float | np.floating) or math.isfinite(value)

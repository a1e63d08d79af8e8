"""The message types that can cross, and checks of received messages."""

from typing import Any

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import ClockMoved, Derived
from vrut_lite.message_codec import FindArray, decode, no_arrays
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.scene import SceneNeeds
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.vocabulary import DERIVED

# The messages of the slots that the bridge may hold, and those that producers of light need.
SLOTS = ("sun", "sky")
SLOT_PRODUCTS: tuple[type[Derived], ...] = tuple(kind for kind in DERIVED if kind.slot in SLOTS)
SHAREABLE: tuple[type[Derived], ...] = (*SLOT_PRODUCTS, ClockMoved, SceneNeeds)
BY_NAME = {kind.__name__: kind for kind in SHAREABLE}


def types_named(names: str, setting: str) -> tuple[type[Derived], ...]:
    """The message types in a comma-separated list.

    Raises:
        UserError: a name is not a type that can cross.
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
    """A message from its type's name and its fields, checked.

    The content of its arrays is checked by `Message.check_arrays`.

    Raises:
        UserError: the type cannot cross, or a field is missing, unknown or invalid.
    """
    if type_name not in BY_NAME:
        raise UserError(f"a message of type {type_name[:40]!r} cannot cross")
    message = decode(BY_NAME[type_name], fields, find_array)
    if isinstance(message, BackgroundChanged):
        # Foreign shaders are never run; the cube map shows the same sky, less sharply.
        message = msgspec.structs.replace(message, view=None)
    message.check()
    return message


def texture_in(message: Derived) -> bool:
    """Whether a message holds a texture, which cannot leave its GPU."""
    carrier: msgspec.Struct = message
    if isinstance(message, AirChanged) and message.volume is not None:
        carrier = message.volume
    values = (getattr(carrier, name) for name in carrier.__struct_fields__)
    return any(isinstance(value, GpuTexture) for value in values)

"""Which messages can cross, and what must hold of one that a stranger sent."""

from typing import Any

import msgspec

from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.scene import SceneNeeds
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.daylight.vocabulary import DERIVED
from vrut_lite.errors import UserError
from vrut_lite.gpu_texture import GpuTexture
from vrut_lite.kernel.messages import ClockMoved, Derived
from vrut_lite.recording.codec import FindArray, decode, no_arrays

# All that a slot's holder says, and what producers of light ask after.
SLOT_PRODUCTS: tuple[type[Derived], ...] = tuple(kind for kind in DERIVED if kind.slot is not None)
SHAREABLE: tuple[type[Derived], ...] = (*SLOT_PRODUCTS, ClockMoved, SceneNeeds)
BY_NAME = {kind.__name__: kind for kind in SHAREABLE}


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

    What its arrays hold is left to `Message.check_arrays`.

    Raises:
        UserError: the type cannot cross, or a field is missing, unknown or not as it must be.
    """
    if type_name not in BY_NAME:
        raise UserError(f"a message of type {type_name[:40]!r} cannot cross")
    message = decode(BY_NAME[type_name], fields, find_array)
    if isinstance(message, BackgroundChanged):
        # A stranger's shader is not run; the cube map shows the same, less sharply.
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

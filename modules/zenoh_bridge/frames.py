"""Encodes messages as frames and decodes them; a frame is bounded and cannot run code."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import msgspec
import numpy as np

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Derived
from vrut_lite.message_codec import Handle, from_plain, to_plain
from zenoh_bridge.array_store import check_handle
from zenoh_bridge.inputs import RemoteMessage
from zenoh_bridge.shareable import revive, texture_in

VERSION = 1
# A forged message could name many arrays; the most in a genuine one are the air's two.
_MOST_ARRAYS = 4

FetchArray = Callable[[Handle], Array]


class MessageFrame(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The JSON that is sent; `message` is the plain form of codec.to_plain."""

    version: int
    type_name: str
    message: dict[str, Any]


def encode_frame(message: Derived, max_bytes: int) -> bytes:
    """A message as a frame, its arrays by digest.

    Raises:
        UserError: it is too large, or holds a GPU texture.
    """
    name = type(message).__name__
    if texture_in(message):
        raise UserError(f"{name} stays on the GPU and cannot cross: make it on the CPU")
    data = msgspec.json.encode(MessageFrame(VERSION, name, to_plain(message)))
    if len(data) > max_bytes:
        raise UserError(f"{name} takes {len(data)} bytes: raise max_message_kib on both sides")
    return data


def read_frame(data: bytes, type_name: str, max_message: int, max_array: int) -> MessageFrame:
    """Decode and check a frame, except for the content of its arrays, which it only names.

    Raises:
        UserError: the frame is too large, damaged, of another version or type than
            `type_name`, or has invalid fields.
    """
    with _refusing(type_name):
        if len(data) > max_message:
            raise UserError(f"it has {len(data)} bytes: raise max_message_kib")
        frame = msgspec.json.decode(data, type=MessageFrame)
        if frame.version != VERSION:
            raise UserError(f"it is of version {frame.version}, not {VERSION}: update one side")
        if frame.type_name != type_name:
            raise UserError(f"it holds a {frame.type_name[:40]!r}")
        revive(type_name, frame.message, _Dummies(max_array))
    return frame


def remote_message(frame: MessageFrame, fetch: FetchArray) -> RemoteMessage:
    """The input for a frame, with its arrays fetched.

    Raises:
        UserError: an array cannot be fetched, does not fit, or holds unusable values.
    """
    with _refusing(frame.type_name):
        fields = from_plain(frame.message, fetch)
        revive(frame.type_name, fields).check_arrays()
    return RemoteMessage(type_name=frame.type_name, fields=fields)


@contextmanager
def _refusing(type_name: str) -> Iterator[None]:
    """Turn any error from a received frame into a UserError of one clear line."""
    try:
        yield
    except (UserError, msgspec.MsgspecError, ValueError, RecursionError) as error:
        text = str(error) or type(error).__name__
        # Parts of the text may come from the frame.
        clear = "".join(c if c.isprintable() else "?" for c in text)[:300]
        raise UserError(f"a frame of {type_name} was refused: {clear}") from None


class _Dummies:
    """Replaces fetching: arrays of the declared shape that take no memory."""

    def __init__(self, max_array: int):
        self._max_array = max_array
        self._seen = 0

    def __call__(self, handle: Handle) -> Array:
        self._seen += 1
        if self._seen > _MOST_ARRAYS:
            raise UserError(f"it holds more than {_MOST_ARRAYS} arrays")
        _, dtype, shape = check_handle(handle, self._max_array)
        return Array(np.broadcast_to(np.zeros((), dtype), shape))

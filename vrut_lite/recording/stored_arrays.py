"""The arrays of a full journal, each unpacked once however often it is referred to."""

import math
import re
from collections.abc import Mapping

import numpy as np

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.message_codec import Handle, no_arrays
from vrut_lite.recording.contents import PackedContent

_DTYPE = re.compile(r"[<>|][biuf][0-9]{1,2}")
_MOST_DIMENSIONS = 32


class StoredArrays:
    """Finds arrays by their handles."""

    def __init__(self, packed: Mapping[str, PackedContent]):
        self._packed = packed
        self._unpacked: dict[str, Array] = {}

    def find(self, handle: Handle) -> Array:
        """The array of a handle, its content compared with its digest.

        Raises:
            UserError: it is not stored, or is another than the handle says.
            ValueError, TypeError, zstandard.ZstdError: it is damaged.
        """
        digest = str(handle["$array"])
        if digest not in self._packed:
            return no_arrays(handle)
        dtype, shape = _layout(handle)
        if digest not in self._unpacked:
            self._unpacked[digest] = self._unpack(digest, dtype, shape)
        array = self._unpacked[digest]
        if (array.digest, array.dtype, array.shape) != (digest, dtype, shape):
            raise UserError(f"the array {digest} has another content than its name says")
        return array

    def _unpack(self, digest: str, dtype: np.dtype, shape: tuple[int, ...]) -> Array:
        packed = self._packed[digest]
        if packed.size != dtype.itemsize * math.prod(shape):
            raise UserError(f"the array {digest} does not fill its shape")
        return Array(np.frombuffer(packed.unpack(), dtype).reshape(shape))


def _layout(handle: Handle) -> tuple[np.dtype, tuple[int, ...]]:
    dtype, shape = handle.get("dtype"), handle.get("shape")
    if not (isinstance(dtype, str) and _DTYPE.fullmatch(dtype)):
        raise UserError(f"an array's element type is {dtype!r}, not a plain number")
    if not (
        isinstance(shape, list)
        and len(shape) <= _MOST_DIMENSIONS
        and all(type(n) is int and 0 <= n < 2**63 for n in shape)
    ):
        raise UserError(f"an array's shape is {shape!r}")
    return np.dtype(dtype), tuple(shape)

"""The arrays of a full journal, each unpacked once however often it is referred to."""

import math
import re
import weakref
from collections import deque
from collections.abc import Mapping

import numpy as np

from vrut_lite.errors import UserError
from vrut_lite.kernel.array import Array
from vrut_lite.kernel.recording.codec import Handle, no_arrays
from vrut_lite.kernel.recording.contents import Packed
from vrut_lite.kernel.recording.limits import ARRAY_BYTES

_DTYPE = re.compile(r"[<>|][biuf][0-9]{1,2}")
_MOST_DIMENSIONS = 32


class StoredArrays:
    """Finds arrays by their handles; those in use at a time take so many bytes at most."""

    def __init__(self, packed: Mapping[str, Packed], most_bytes: int):
        self._packed = packed
        self._most_bytes = most_bytes
        self._in_use: weakref.WeakValueDictionary[str, Array] = weakref.WeakValueDictionary()
        self._taken_bytes = 0
        # Appended to by finalizers, on any thread and at any moment.
        self._freed_bytes: deque[int] = deque()

    def find(self, handle: Handle) -> Array:
        """The array of a handle, its content compared with its digest.

        Raises:
            UserError: it is not stored, is another than the handle says, or takes too much.
            ValueError, TypeError, zstandard.ZstdError: it is damaged.
        """
        digest = str(handle["$array"])
        if digest not in self._packed:
            return no_arrays(handle)
        dtype, shape = _layout(handle)
        array = self._in_use.get(digest)
        if array is None:
            array = self._unpack(digest, dtype, shape)
            self._in_use[digest] = array
        if (array.digest, array.dtype, array.shape) != (digest, dtype, shape):
            raise UserError(f"the array {digest} has another content than its name says")
        return array

    def _unpack(self, digest: str, dtype: np.dtype, shape: tuple[int, ...]) -> Array:
        packed = self._packed[digest]
        if not 0 <= packed.size <= ARRAY_BYTES:
            raise UserError(f"an array is larger than {ARRAY_BYTES} bytes")
        if packed.size != dtype.itemsize * math.prod(shape):
            raise UserError(f"the array {digest} does not fill its shape")
        self._take(packed.size)
        values = np.frombuffer(packed.unpack(), dtype)
        # A module may keep the numbers and not the `Array`; views keep these alive.
        weakref.finalize(values, self._freed_bytes.append, packed.size).atexit = False
        return Array(values.reshape(shape))

    def _take(self, size_bytes: int) -> None:
        while self._freed_bytes:
            self._taken_bytes -= self._freed_bytes.popleft()
        if self._taken_bytes + size_bytes > self._most_bytes:
            raise UserError(
                f"its arrays take more than the {self._most_bytes >> 20} MiB that are left for "
                "them: set VRUT_LITE_MEMORY_GIB higher if you trust it"
            )
        self._taken_bytes += size_bytes


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

"""Arrays by digest: what was sent or received last, and bytes from outside made arrays."""

import math
import re
import threading
from collections import OrderedDict
from typing import Any

import numpy as np

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.recording.codec import Handle

_MOST_ARRAYS = 32
_DIGEST = re.compile(r"[0-9a-f]{32}")
_DTYPE = re.compile(r"[<|][biuf][1248]")


class ArrayStore:
    """The last arrays by digest, at most `max_bytes` and 32 of them; from any thread."""

    def __init__(self, max_bytes: int):
        self._max_bytes = max_bytes
        self._arrays: OrderedDict[str, Array] = OrderedDict()
        self._bytes = 0
        self._lock = threading.Lock()

    def keep(self, array: Array) -> None:
        """Keep an array, as the latest; those that were longest not asked for give way."""
        digest = array.digest  # Computed here, without the lock.
        with self._lock:
            if digest not in self._arrays:
                self._arrays[digest] = array
                self._bytes += array.values.nbytes
            self._arrays.move_to_end(digest)
            while len(self._arrays) > _MOST_ARRAYS or (
                self._bytes > self._max_bytes and len(self._arrays) > 1
            ):
                _, oldest = self._arrays.popitem(last=False)
                self._bytes -= oldest.values.nbytes

    def find(self, digest: str) -> Array | None:
        """The array of this content, or None."""
        with self._lock:
            array = self._arrays.get(digest)
            if array is not None:
                self._arrays.move_to_end(digest)
            return array

    def __len__(self) -> int:
        return len(self._arrays)


def check_handle(handle: Handle, max_bytes: int) -> tuple[str, np.dtype[Any], tuple[int, ...]]:
    """Digest, element type and shape of a handle from outside.

    Raises:
        UserError: one of them is not as it must be, or the array is too large.
    """
    digest, dtype, shape = (handle.get(name) for name in ("$array", "dtype", "shape"))
    if not (isinstance(digest, str) and _DIGEST.fullmatch(digest)):
        raise UserError("an array has no digest")
    if not (isinstance(dtype, str) and _DTYPE.fullmatch(dtype)):
        raise UserError("an array's element type is not a plain number")
    if not isinstance(shape, list) or not all(type(n) is int and n >= 0 for n in shape):
        raise UserError("an array's shape is not a list of sizes")
    try:
        element = np.dtype(dtype)
    except TypeError:
        raise UserError(f"an array's element type is {dtype}, which there is not") from None
    # Python's integers: a product that overflows would look small.
    if len(shape) > 8 or math.prod(shape) * element.itemsize > max_bytes:
        raise UserError(f"an array is larger than {max_bytes} bytes: raise max_array_mib")
    return digest, element, tuple(shape)


def unpacked(data: bytes, handle: Handle, max_bytes: int) -> Array:
    """The array of a handle from its bytes, its content compared with its digest.

    Raises:
        UserError: the bytes are not those of the handle.
    """
    digest, dtype, shape = check_handle(handle, max_bytes)
    if len(data) != math.prod(shape) * dtype.itemsize:
        raise UserError(f"the array {digest} came with {len(data)} bytes, which do not fit it")
    array = Array(np.frombuffer(data, dtype).reshape(shape))
    if array.digest != digest:
        raise UserError(f"the array {digest} came with another content")
    return array

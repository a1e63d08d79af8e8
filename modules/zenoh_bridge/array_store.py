"""Stores the arrays sent or received last, by digest, and decodes received arrays."""

import math
import re
import threading
from collections import OrderedDict
from typing import Any

import numpy as np

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.message_codec import Handle

_MOST_ARRAYS = 32
_DIGEST = re.compile(r"[0-9a-f]{32}")
_DTYPE = re.compile(r"[<|][biuf][1248]")


class ArrayStore:
    """The last arrays by digest, at most 32 and `max_bytes`; for any thread."""

    def __init__(self, max_bytes: int):
        self._max_bytes = max_bytes
        self._arrays: OrderedDict[str, Array] = OrderedDict()
        self._bytes = 0
        self._lock = threading.Lock()

    def keep(self, array: Array) -> None:
        """Store an array; the least recently used ones are dropped."""
        digest = array.digest  # May take long: computed before the lock is taken.
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
        """The array with this digest, or None."""
        with self._lock:
            array = self._arrays.get(digest)
            if array is not None:
                self._arrays.move_to_end(digest)
            return array

    def __len__(self) -> int:
        return len(self._arrays)


def check_handle(handle: Handle, max_bytes: int) -> tuple[str, np.dtype[Any], tuple[int, ...]]:
    """Digest, element type and shape of a received handle.

    Raises:
        UserError: one of them is invalid, or the array is too large.
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
    # With Python's integers, because an overflowing product would look small.
    if len(shape) > 8 or math.prod(shape) * element.itemsize > max_bytes:
        raise UserError(f"an array is larger than {max_bytes} bytes: raise max_array_mib")
    return digest, element, tuple(shape)


def unpacked(data: bytes, handle: Handle, max_bytes: int) -> Array:
    """Decode an array from its bytes and compare its digest with the handle's.

    Raises:
        UserError: size or digest differ.
    """
    digest, dtype, shape = check_handle(handle, max_bytes)
    if len(data) != math.prod(shape) * dtype.itemsize:
        raise UserError(f"the array {digest} came with {len(data)} bytes, which do not fit it")
    array = Array(np.frombuffer(data, dtype).reshape(shape))
    if array.digest != digest:
        raise UserError(f"the array {digest} came with another content")
    return array

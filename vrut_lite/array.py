"""A read-only array for messages."""

import hashlib
from functools import cached_property
from sys import getrefcount
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Array:
    """A numpy array, passed by reference within a process and by content between processes.

    Its memory is made read-only. The values are copied if others could still write to them
    (through the array that they are a view of, another view, a file or a buffer); memory that
    is read-only already is not copied.

    Raises:
        TypeError: the values are Python objects, which have no digest.
    """

    def __init__(self, values: NDArray[Any]):
        if values.dtype.hasobject:
            raise TypeError(f"an Array holds numbers, not {values.dtype}")
        # Counted here, where only the caller's name and this parameter refer to it.
        alone = values.base is not None or getrefcount(values) <= _NAMED_ONCE
        self.values = values if _sealed(values, alone) else _sealed_copy(values)

    @property
    def shape(self) -> tuple[int, ...]:
        """The array's shape."""
        return self.values.shape

    @property
    def dtype(self) -> np.dtype[Any]:
        """The array's element type."""
        return self.values.dtype

    @cached_property
    def digest(self) -> str:
        """Hexadecimal BLAKE2b-128 of element type, shape and bytes; computed on first use."""
        digest = hashlib.blake2b(f"{self.dtype.str}{self.shape}".encode(), digest_size=16)
        # A view as bytes, not a copy: arrays may be large.
        digest.update(np.ascontiguousarray(self.values).reshape(-1).view(np.uint8).data)
        return digest.hexdigest()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Array) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    def __repr__(self) -> str:
        return f"Array({self.dtype}, {self.shape})"


def _sealed(values: NDArray[Any], alone: bool) -> bool:
    """Make the memory of these values read-only; False if others could still write to it.

    `alone`: no other array shares memory that the values own. All views of an array refer to it,
    so its reference count shows whether others exist.
    """
    if type(values) is not np.ndarray:  # Such as a mapped file.
        return False
    links, base = [values], values.base
    while type(base) is np.ndarray:
        alone = alone and getrefcount(base) <= _SEEN_ONCE
        links.append(base)
        base = base.base
    if isinstance(base, memoryview):
        base = base.obj
    if not (base is None or type(base) is bytes):
        return False
    if not alone and any(link.flags.writeable for link in links):
        return False
    for link in links:
        link.flags.writeable = False
    return True


def _sealed_copy(values: NDArray[Any]) -> NDArray[Any]:
    copied = np.array(values)
    copied.flags.writeable = False
    return copied


class _Count:
    """The result of `getrefcount` inside a constructor; it differs between Python versions."""

    def __init__(self, values: NDArray[Any]):
        self.references = getrefcount(values)


def _named_once() -> int:
    """Reference count of an array in a constructor, if the caller has the only name of it."""
    name = np.empty(0)
    return _Count(name).references


def _seen_once() -> int:
    """Reference count of an array that one view and a local name, as in `_sealed`, refer to."""
    view = np.empty(2)[:1]
    base = view.base
    return getrefcount(base)


_NAMED_ONCE, _SEEN_ONCE = _named_once(), _seen_once()

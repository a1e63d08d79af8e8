"""A read-only array that rides in a message."""

import hashlib
from functools import cached_property
from sys import getrefcount
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Array:
    """A numpy array passed by reference in process and known by its content elsewhere.

    A message is a fact, not a buffer: its memory is made read-only when wrapped. Where others
    could still write to it (through an array that these values are a view of, through another
    view, a file or a buffer), the values are copied; memory that is read-only already is
    taken at its word.

    Raises:
        TypeError: the values are Python objects, which have no content of their own.
    """

    def __init__(self, values: NDArray[Any]):
        if values.dtype.hasobject:
            raise TypeError(f"an Array holds numbers, not {values.dtype}")
        # Counted here, where the caller's name of it and this parameter are what counts.
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
        """Hexadecimal BLAKE2b-128 of element type, shape and bytes; computed when first asked."""
        digest = hashlib.blake2b(f"{self.dtype.str}{self.shape}".encode(), digest_size=16)
        # As bytes and not copied: arrays may be large.
        digest.update(np.ascontiguousarray(self.values).reshape(-1).view(np.uint8).data)
        return digest.hexdigest()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Array) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    def __repr__(self) -> str:
        return f"Array({self.dtype}, {self.shape})"


def _sealed(values: NDArray[Any], alone: bool) -> bool:
    """Make the memory of these values read-only; False if others could go on writing to it.

    `alone`: no other array looks at memory that is the values' own. All views of an array refer
    to it, so that the references to it tell whether there are others.
    """
    if type(values) is not np.ndarray:  # A mapped file, say.
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
    """What `getrefcount` says inside a constructor; versions of Python differ."""

    def __init__(self, values: NDArray[Any]):
        self.references = getrefcount(values)


def _named_once() -> int:
    """References to an array, in a constructor that is given the only name of it."""
    name = np.empty(0)
    return _Count(name).references


def _seen_once() -> int:
    """References to an array that one view alone refers to, beside a name as in `_sealed`."""
    view = np.empty(2)[:1]
    base = view.base
    return getrefcount(base)


_NAMED_ONCE, _SEEN_ONCE = _named_once(), _seen_once()

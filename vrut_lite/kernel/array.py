"""A read-only array that rides in a message."""

import hashlib
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Array:
    """A numpy array passed by reference in process and known by its content elsewhere.

    The array is made read-only when wrapped: a message is a fact, not a buffer.
    """

    def __init__(self, values: NDArray[Any]):
        self.values = values
        self.values.flags.writeable = False

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

"""Digests of what is kept on disk is made of: arrays, and this package's own code."""

import hashlib
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


def digest_of(arrays: Iterable[NDArray]) -> str:
    """Of element types, shapes and bytes."""
    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        digest.update(f"{array.dtype.str}{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
    return digest.hexdigest()


@lru_cache
def code_digest(patterns: tuple[str, ...]) -> str:
    """Of the files of the package that match, in order."""
    digest = hashlib.blake2b(digest_size=16)
    for pattern in patterns:
        for path in sorted(Path(__file__).parent.glob(pattern)):
            digest.update(path.read_bytes())
    return digest.hexdigest()

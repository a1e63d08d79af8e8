"""Arrays kept on disk, found by their recipe.

A file's name is the digest of its recipe; inside, a digest of the contents stands before them.
A file whose digest does not match is ignored, and its arrays are computed. Files are written under
another name and renamed, so that neither a crash nor a second process leaves a half-written one. If
the folder cannot be written, a log line says so and nothing is cached.
"""

import hashlib
import io
import logging
import os
import stat
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.npz_arrays import read_npz

# Version of the file's layout; the layout of the contents is part of the recipe.
VERSION = 3
_MAGIC = f"vrut_lite arrays {VERSION}\n".encode()
_DIGEST_BYTES = 32
_FORGOTTEN_S = 86_400.0
_log = logging.getLogger(__name__)

Arrays = Mapping[str, NDArray[Any]]


class ArrayCache:
    """Arrays by recipe in a folder, the least recently used dropped above `limit_bytes`.

    `warns`: log a folder that cannot be written; off for arrays that are computed quickly.
    """

    def __init__(self, folder: Path, limit_bytes: int = 1 << 30, warns: bool = True):
        self.folder = folder
        self.limit_bytes = limit_bytes
        self._warns = warns

    @classmethod
    def of_user(cls, name: str, limit_bytes: int = 1 << 30, warns: bool = True) -> "ArrayCache":
        """A cache of this name in the user's own cache folder."""
        from platformdirs import user_cache_path

        return cls(user_cache_path("vrut_lite") / name, limit_bytes, warns)

    def get(self, recipe: object) -> dict[str, NDArray[Any]] | None:
        """The arrays made from a recipe; None if there is no file or it is damaged.

        Args:
            recipe: of numbers, texts, tuples and dataclasses; its `repr` is digested.
        """
        path = self._path(recipe)
        try:
            state = path.stat()
            # Reading a pipe would block; a file larger than the whole cache is not an entry.
            ours = stat.S_ISREG(state.st_mode) and state.st_size <= self.limit_bytes
            content = path.read_bytes() if ours else b""
            os.utime(path)
        except OSError:
            return None
        start = len(_MAGIC) + _DIGEST_BYTES
        payload = content[start:]
        whole = content[:start] == _MAGIC + _digest(payload)
        arrays = _arrays(payload) if whole else None
        if arrays is None:
            _log.warning("the cached file %s is damaged: its arrays are made again", path)
        return arrays

    def put(self, recipe: object, arrays: Arrays) -> None:
        """Keep the arrays made from a recipe, if the folder can be written."""
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **arrays)
        payload = buffer.getvalue()
        path = self._path(recipe)
        try:
            self._write(path, _MAGIC + _digest(payload) + payload)
            self._drop_oldest(path)
        except OSError as error:
            if not self._warns:
                return
            _log.warning("arrays are not kept in %s: %s", self.folder, error.strerror or error)

    def _path(self, recipe: object) -> Path:
        text = repr((VERSION, recipe)).encode()
        return self.folder / f"{hashlib.blake2b(text, digest_size=16).hexdigest()}.arrays"

    def _write(self, path: Path, content: bytes) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        handle, beside = tempfile.mkstemp(dir=self.folder, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            os.replace(beside, path)
        except BaseException:
            Path(beside).unlink(missing_ok=True)
            raise

    def _drop_oldest(self, kept: Path) -> None:
        """Delete the least recently used files above the limit, but not `kept`.

        Parts that a killed process left a day ago are deleted too.
        """
        for part, state in self._files("*.part"):
            if state.st_mtime < time.time() - _FORGOTTEN_S:
                part.unlink(missing_ok=True)
        used = sorted(self._files("*.arrays"), key=lambda entry: entry[1].st_mtime_ns)
        total = sum(state.st_size for _, state in used)
        for path, state in used:
            if total <= self.limit_bytes:
                return
            if path != kept:
                total -= state.st_size
                path.unlink(missing_ok=True)

    def _files(self, pattern: str) -> Iterator[tuple[Path, os.stat_result]]:
        """Files and their states; a file that another process deletes meanwhile is skipped."""
        for path in self.folder.glob(pattern):
            with suppress(FileNotFoundError):
                yield path, path.stat()


def _arrays(payload: bytes) -> dict[str, NDArray[Any]] | None:
    """The arrays in a file; None if it is no archive of finite numbers, whatever its digest."""
    try:
        # The archive is not compressed: arrays are no larger than it.
        arrays = read_npz(io.BytesIO(payload), len(payload))
    except ValueError:
        return None
    sound = all(a.dtype.kind in "fiu" and np.isfinite(a).all() for a in arrays.values())
    return arrays if sound else None


def _digest(payload: bytes) -> bytes:
    return hashlib.blake2b(payload, digest_size=_DIGEST_BYTES).digest()

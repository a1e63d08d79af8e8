"""numba's `njit` with digests on its cache files: damaged ones are compiled again.

numba unpickles cached machine code unchecked: a truncated file would end every sky in a traceback
until somebody removes it, a flipped bit in a crash. Also, processes that save at the same time
would lose each other's entries of the index; here a lock makes one wait for the other. And numba
compiles anew when a kernel's own file changes, but not when another changes that it calls, inlines
or has a constant of: here all files of its package that it imports count, directly or not.
"""

import fcntl
import hashlib
import os
import pickle
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

from numba import njit
from numba.core import caching

__all__ = ["SUMS_IN_ORDER", "njit"]
# For `fastmath`: there is no NaN, infinity or signed zero, and a product and its sum may be rounded
# once. Sums keep their order, so that the digits do not depend on the width of vectors. Nor do they
# depend on which process compiled a kernel: calls between kernels find other copies of a function
# there than in a process that loads them, and with `fastmath=True` each copy sums in its own order.
# Journals compare results of kernels by digest. It costs the solver 1 to 2 % of its time.
SUMS_IN_ORDER = {"nnan", "ninf", "nsz", "contract"}
_DIGEST_BYTES = 32
_IMPORTED = re.compile(rb"^from (\S+) import", re.MULTILINE)


class CheckedCacheFile(caching.IndexDataCacheFile):
    """Index and data files with a digest at their end, which numba's own reader ignores."""

    def save(self, key: Any, data: Any) -> None:
        """Save compiled code while no other process does."""
        with _alone_in(Path(self._index_path).parent):
            super().save(key, data)

    def _load_index(self) -> dict[Any, str]:
        try:
            with open(self._index_path, "rb") as stream:
                pickle.load(stream)
                sound = _is_whole(stream.read())
            return super()._load_index() if sound else {}
        except Exception:  # Unpickling damaged data may raise anything.
            return {}

    def _load_data(self, name: str) -> Any:
        if not _is_whole(Path(self._data_path(name)).read_bytes()):
            # numba takes this for a removed file.
            raise FileNotFoundError(name)
        return super()._load_data(name)

    def _dump(self, obj: Any) -> bytes:
        data: bytes = super()._dump(obj)
        return data + _digest(data)


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    handle = os.open(folder, os.O_RDONLY)
    try:
        # Some file systems have no locks; numba then works as without this class.
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def _is_whole(content: bytes) -> bool:
    return content[-_DIGEST_BYTES:] == _digest(content[:-_DIGEST_BYTES])


def _digest(data: bytes) -> bytes:
    return hashlib.blake2b(data, digest_size=_DIGEST_BYTES).digest()


def _stamp(locator: Any) -> tuple[Any, bytes]:
    """Changes with a kernel's file and with the files that it imports from its package."""
    own = Path(locator._py_file)
    package = own.parent
    while (package.parent / "__init__.py").is_file():
        package = package.parent
    found, todo = {own}, [own]
    while todo:
        file = todo.pop()
        for name in _read(file, file.stat().st_mtime_ns)[1]:
            first, *rest = name.split(".")
            module = package.joinpath(*rest)
            other = module / "__init__.py" if module.is_dir() else module.with_suffix(".py")
            if first == package.name and other.is_file() and other not in found:
                todo.append(other)
                found.add(other)
    contents = [_read(file, file.stat().st_mtime_ns)[0] for file in sorted(found)]
    return _stamp_of_file(locator), _digest(b"".join(contents))


@cache
def _read(file: Path, _changed_ns: int) -> tuple[bytes, tuple[str, ...]]:
    """A file's digest and the files that it imports."""
    content = file.read_bytes()
    return _digest(content), tuple(name.decode() for name in _IMPORTED.findall(content))


_stamp_of_file = caching._SourceFileBackedLocatorMixin.get_source_stamp
setattr(caching._SourceFileBackedLocatorMixin, "get_source_stamp", _stamp)  # noqa: B010
# Cached functions use the class that has this name in numba's module.
setattr(caching, "IndexDataCacheFile", CheckedCacheFile)  # noqa: B010

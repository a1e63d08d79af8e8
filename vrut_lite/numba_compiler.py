"""numba, with a cache for our kernels in the user's folder, whose files carry digests.

numba unpickles cached machine code unchecked: a truncated file would end every sky in a traceback
until somebody removes it, a flipped bit in a crash. Also, processes that save at the same time
would lose each other's entries of the index; here a lock makes one wait for the other. And numba
recompiles a kernel when its own file changes, but not when another changes whose functions or
constants it uses: here all files of its package that it imports count, directly or not.
"""

import hashlib
import importlib
import os
import pickle
import re
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

from vrut_lite import compiled_code
from vrut_lite.file_lock import lock_file
from vrut_lite.interrupts import interrupts_held

with interrupts_held():
    from numba import njit
    from numba.core import (
        caching,
        cgutils,
        compiler,
        config,
        environment,
        event,
        sigutils,
        types,
    )
    from numba.core.cpu import CPUContext
    from numba.core.dispatcher import Dispatcher
    from numba.core.registry import cpu_target
    from numba.core.runtime import rtsys
    from numba.extending import intrinsic, register_jitable

    from vrut_lite import numba_shortcuts

# For files of intrinsics: threads that import different parts of numba at once would see each
# other's half-made modules.
__all__ = ["cgutils", "config", "cpu_target", "types"]
_DIGEST_BYTES = 32
_IMPORTED = re.compile(rb"^from (\S+) import", re.MULTILINE)


def compiled_function(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    """numba's object of a function that is compiled by `njit`; with `cache=True` kept on disk."""
    others = {name: value for name, value in options.items() if name != "cache"}
    dispatcher = njit(**others)(function)
    if options.get("cache"):
        dispatcher._cache = _KernelCache(function)
    return dispatcher


def compiled_intrinsic(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    """numba's object of an intrinsic."""
    return intrinsic(function, **options)


def inlined_function(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    """The function itself, which kernels may call from now on."""
    return register_jitable(**options)(function)


def type_of(compiled: Any) -> Any:
    """numba's type of something that kernels call."""
    context = cpu_target.typing_context
    context.refresh()
    return context.resolve_value_type(compiled)


class CheckedCacheFile(caching.IndexDataCacheFile):
    """Index and data files with a digest at their end, which numba's own reader ignores."""

    def save(self, key: Any, data: Any) -> None:
        """Save compiled code while no other process does."""
        with _alone_in(Path(self._index_path).parent):
            super().save(key, data)
        _remove_unused_once()

    def load(self, key: Any) -> Any:
        """Compiled code, or None if it is missing; marks it as used."""
        found = super().load(key)
        if found is not None:
            compiled_code.mark_used(Path(self._index_path))
        return found

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


class _KernelLocator(caching._SourceFileBackedLocatorMixin, caching._CacheLocator):
    """Places compiled code in `compiled_code.kernels_folder`; numba's own go beside the sources."""

    def __init__(self, function: Any, file: str):
        self._py_file, self._lineno = file, function.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        """The folder of this file's kernels."""
        return str(compiled_code.folder_of(Path(self._py_file).parent))


# Functions of notebook cells have no file; the class has an underscore before numba 0.62.
_IN_NOTEBOOKS = [
    each
    for each in caching.CacheImpl._locator_classes
    if each.__name__.endswith("IPythonCacheLocator")
]


class _KernelFiles(caching.CompileResultCacheImpl):
    _locator_classes: ClassVar = [_KernelLocator, *_IN_NOTEBOOKS]


class _KernelCache(caching.FunctionCache):
    _impl_class = _KernelFiles


@cache
def _remove_unused_once() -> None:
    compiled_code.remove_unused()


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    # Some file systems have no locks, and Windows none of folders; numba then works as without
    # this class, and a lost entry is compiled again.
    with ExitStack() as stack:
        with suppress(OSError):
            handle = os.open(folder, os.O_RDONLY)
            stack.callback(os.close, handle)
            lock_file(handle, wait=True)
        yield


def _is_whole(content: bytes) -> bool:
    return content[-_DIGEST_BYTES:] == _digest(content[:-_DIGEST_BYTES])


def _digest(data: bytes) -> bytes:
    return hashlib.blake2b(data, digest_size=_DIGEST_BYTES).digest()


def _stamp(locator: Any) -> tuple[Any, bytes]:
    """Changes with a kernel's file and with the files that it imports from its package."""
    return _stamp_of_file(locator), _digest_with_imports(Path(locator._py_file))


@cache
def _digest_with_imports(own: Path) -> bytes:
    """A digest of a file and of the files of its package that it imports, directly or not."""
    package = own.parent
    while (package.parent / "__init__.py").is_file():
        package = package.parent
    found, todo = {own}, [own]
    while todo:
        for name in _read(todo.pop())[1]:
            first, *rest = name.split(".")
            if first == package.name:
                other = _file_of(package.joinpath(*rest))
                if other is not None and other not in found:
                    todo.append(other)
                    found.add(other)
    return _digest(b"".join(_read(file)[0] for file in sorted(found)))


@cache
def _file_of(module: Path) -> Path | None:
    """The source of a python module or package, None if there is no such file."""
    file = module / "__init__.py" if module.is_dir() else module.with_suffix(".py")
    return file if file.is_file() else None


@cache
def _read(file: Path) -> tuple[bytes, tuple[str, ...]]:
    """A file's digest and the python modules that it imports."""
    content = file.read_bytes()
    return _digest(content), tuple(name.decode() for name in _IMPORTED.findall(content))


class _Teller(event.Listener):
    """Counts compilations, and reports those of kernels that Python calls."""

    def on_start(self, event: event.Event) -> None:
        compiled_code.compilations += 1
        if compiled_code.ahead is not None and _nested.depth == 1:
            compiled_code.ahead.note(event.data["dispatcher"], event.data["args"])

    def on_end(self, event: event.Event) -> None:
        """Nothing to do."""


class _Nested(threading.local):
    """Depth of a thread's nested compilations."""

    depth = 0


def _compile(dispatcher: Any, signature: Any) -> Any:
    """Compile a function or find it on disk; hooks are called before the outermost ones."""
    if _nested.depth == 0:
        arguments = sigutils.normalize_signature(signature)[0]
        for hook in compiled_code.before_kernel:
            hook(dispatcher, arguments)
        if compiled_code.ahead is not None:
            # Before numba's lock is taken: others may compile while this thread waits.
            compiled_code.ahead.wait_for(dispatcher, arguments)
    _nested.depth += 1
    try:
        return _compile_or_load(dispatcher, signature)
    finally:
        _nested.depth -= 1


def _load(self: Any, signature: Any, context: Any) -> Any:
    """A kernel from disk, None if it is not there.

    numba first imports all that it may compile, for 0.35 s; machine code needs the runtime alone.
    """
    rtsys.initialize(context)
    with self._guard_against_spurious_io_errors():
        return self._load_overload(signature, context)


def _environment(module: str, constants: Any, name: str) -> Any:
    """An environment of a kernel from disk: numba would import the module of each inner function.

    Code that runs without Python's objects reads constants of it, and no names of the module.
    """
    known = environment.lookup_environment(name)
    if known is not None:
        return known
    loaded = sys.modules.get(module)
    made = environment.Environment({"__name__": module} if loaded is None else vars(loaded))
    made.consts[:] = constants
    made.env_name = name
    environment.Environment._memo[name] = made
    return made


def _import_all(self: Any) -> None:
    """Import what numba can compile, without scipy.linalg, which takes 0.2 s.

    Functions on arrays only ask whether there is a BLAS. A kernel that multiplies matrices loads it
    all the same.
    """
    linalg: Any = importlib.import_module("numba.np.linalg")
    asked = linalg.ensure_blas
    linalg.ensure_blas = lambda: None
    try:
        importlib.import_module("numba.np.arraymath")
    finally:
        linalg.ensure_blas = asked
    _additional(self)


# Only functions handed to C as callbacks have a use for this wrapper, and none of ours is: 3 of 40
# seconds of compiling were spent on it, in numba's own helpers too.
setattr(compiler.Flags.options["no_cfunc_wrapper"], "_default", True)  # noqa: B010
numba_shortcuts.install()
_additional = CPUContext.load_additional_registries
setattr(CPUContext, "load_additional_registries", _import_all)  # noqa: B010
setattr(caching.Cache, "load_overload", _load)  # noqa: B010
# Under numba's name, by which files hold it.
_environment.__module__, _environment.__qualname__ = environment.__name__, "_rebuild_env"
setattr(environment, "_rebuild_env", _environment)  # noqa: B010
_nested = _Nested()
_compile_or_load = Dispatcher.compile
setattr(Dispatcher, "compile", _compile)  # noqa: B010
event.register("numba:compile", _Teller())
_stamp_of_file = caching._SourceFileBackedLocatorMixin.get_source_stamp
setattr(caching._SourceFileBackedLocatorMixin, "get_source_stamp", _stamp)  # noqa: B010
# Cached functions use the class that has this name in numba's module.
setattr(caching, "IndexDataCacheFile", CheckedCacheFile)  # noqa: B010

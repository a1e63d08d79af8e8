"""Lists of the kernels that a package compiles at its first use, in order of need.

A package's `data/kernels.json` holds groups of kernels; `tools/list_kernels.py` writes it. Numba
compiles a kernel once for each set of argument types, so that these belong to its name.
"""

import importlib
import json
import re
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from vrut_lite import compiled_code
from vrut_lite.njit import types
from vrut_lite.package_facts import MODULES_GROUP, usable_points

FILE = Path("data") / "kernels.json"
_NAMED = re.compile(r"\w+(\.\w+)+:\w+")
_ARRAY = re.compile(r"(\w+)\[(\d+)([CFA])(r?)(u?)\]")


class ListedKernel(msgspec.Struct, frozen=True):
    """A kernel for some types of arguments.

    Attributes:
        module: the python module that holds it.
        function: its name there.
        arguments: JSON of the types, by `encoded`.
        seconds: CPU time of its compilation where the list was made.
    """

    module: str
    function: str
    arguments: str
    seconds: float = 1.0

    @property
    def key(self) -> tuple[str, str, str]:
        """Key of the compiled code: module, function and argument types."""
        return self.module, self.function, self.arguments

    @property
    def family(self) -> str:
        """First named tuple of the arguments, else the name: likely to call the same functions."""
        found = _NAMED.search(self.arguments)
        return found[0] if found else f"{self.module}.{self.function}"

    @property
    def title(self) -> str:
        """A few words."""
        return self.module.rpartition(".")[2].replace("_", " ")


class KernelGroup(msgspec.Struct, frozen=True):
    """Kernels that belong together.

    Attributes:
        title: a description of their result.
        kernels: in order of need.
        on_default_way: every picture of a scene needs them, by the default settings.
        window_alone: no command needs them.
    """

    title: str
    kernels: tuple[ListedKernel, ...]
    on_default_way: bool = True
    window_alone: bool = False

    @property
    def seconds(self) -> float:
        """CPU time of all compilations."""
        return sum(kernel.seconds for kernel in self.kernels)


class Announced(NamedTuple):
    """Groups of kernels by package."""

    groups: dict[str, tuple[KernelGroup, ...]]

    def of(self, package: str) -> tuple[KernelGroup, ...]:
        """The groups of a package."""
        return self.groups.get(package, ())


def announced_kernels() -> Announced:
    """The lists of the host and of all installed modules; one that cannot be read is left out."""
    return Announced({package: tuple(_groups(package)) for package in packages()})


def packages() -> tuple[str, ...]:
    """The host, and the packages of installed modules."""
    points = usable_points(MODULES_GROUP)
    return ("vrut_lite", *sorted({point.value.partition(".")[0] for point in points}))


def list_file(package: str) -> Path | None:
    """Where a package's list is kept, None if there is no such package."""
    try:
        spec = find_spec(package)
    except (ImportError, ValueError):
        return None
    if spec is None or not spec.submodule_search_locations:
        return None
    return Path(next(iter(spec.submodule_search_locations))) / FILE


def _groups(package: str) -> Iterator[KernelGroup]:
    file = list_file(package)
    if file is not None and file.is_file():
        try:
            yield from msgspec.json.decode(file.read_bytes(), type=list[KernelGroup])
        except (OSError, msgspec.DecodeError):
            # Its kernels are compiled where they are needed, as without a list.
            return


def is_on_disk(kernel: ListedKernel) -> bool:
    """Whether numba has an index of compiled code for a kernel, perhaps of an older source."""
    package, *inner, name = kernel.module.split(".")
    file = list_file(package)
    if file is None:
        return False
    beside = file.parents[1].joinpath(*inner)
    return any(compiled_code.folder_of(beside).glob(f"{name}.{kernel.function}-*.nbi"))


def kernel_of(dispatcher: Any, arguments: Any, seconds: float = 1.0) -> ListedKernel | None:
    """The kernel that numba compiles, None where its types have no text or it is not found.

    Args:
        dispatcher: numba's object of a compiled function.
        arguments: numba types.
        seconds: CPU time of the compilation.
    """
    function = dispatcher.py_func
    if "." in function.__qualname__:
        return None
    try:
        text = json.dumps([encoded(each) for each in arguments])
    except ValueError:
        return None
    return ListedKernel(function.__module__, function.__qualname__, text, seconds)


def compile_kernel(module: str, function: str, arguments: str) -> None:
    """Compile a kernel and save it in numba's cache, unless it is there already.

    Raises:
        Exception: any exception of importing and compiling.
    """
    dispatcher = getattr(importlib.import_module(module), function)
    dispatcher.compile(tuple(decoded(each) for each in json.loads(arguments)))


def encoded(kind: Any) -> Any:
    """A numba type as JSON: text for numbers and arrays, lists for tuples.

    Raises:
        ValueError: the type is of another kind.
    """
    if isinstance(kind, types.Array):
        return (
            f"{kind.dtype}[{kind.ndim}{kind.layout}{'' if kind.mutable else 'r'}"
            f"{'' if kind.aligned else 'u'}]"
        )
    if isinstance(kind, types.BaseNamedTuple):
        named = kind.instance_class
        return {f"{named.__module__}:{named.__qualname__}": [encoded(each) for each in kind.types]}
    if isinstance(kind, types.BaseTuple):
        return [encoded(each) for each in kind.types]
    if isinstance(kind, types.Number | types.Boolean | types.NoneType):
        return str(kind)
    raise ValueError(f"no text for arguments of the type {kind}")


def decoded(text: Any) -> Any:
    """The numba type that `encoded` wrote.

    Raises:
        ValueError, ImportError, AttributeError: the text names no type.
    """
    if isinstance(text, list):
        return types.BaseTuple.from_types(tuple(map(decoded, text)))
    if isinstance(text, dict):
        ((name, parts),) = text.items()
        module, _, qualname = name.partition(":")
        named = getattr(importlib.import_module(module), qualname)
        return types.BaseTuple.from_types(tuple(map(decoded, parts)), named)
    found = _ARRAY.fullmatch(text)
    if found is not None:
        dtype, ndim, layout, readonly, unaligned = found.groups()
        return types.Array(
            decoded(dtype), int(ndim), layout, readonly=bool(readonly), aligned=not unaligned
        )
    return {"bool": types.boolean, "none": types.none}.get(text) or getattr(types, text)

"""The text of a compute shader, put together from its files, and numbers as it reads them."""

import re
from functools import lru_cache
from importlib.resources import files

import numpy as np
from numpy.typing import ArrayLike

_INCLUDE = re.compile(r'^#include "([^"]+)"$', re.MULTILINE)
_CORE = "vrut_lite.sky"


@lru_cache(maxsize=32)
def shader_source(name: str, *packages: str) -> str:
    """The shader of that file name with every `#include "file"` line replaced by the file.

    A file that is named several times is included once, where it is named first.

    Args:
        name: of a file in the folder `shaders` of one of the packages or, if it is in none, of
            `vrut_lite.sky`.
        packages: where it is looked for, in this order.

    Raises:
        FileNotFoundError: there is no such file.
    """
    return expand_includes(_read(name, packages), *packages)


def expand_includes(source: str, *packages: str) -> str:
    """A shader's text with the files that it includes; `packages` as for `shader_source`."""
    seen: set[str] = set()

    def insert(match: re.Match[str]) -> str:
        if match[1] in seen:
            return ""
        seen.add(match[1])
        return _INCLUDE.sub(insert, _read(match[1], packages))

    return _INCLUDE.sub(insert, source)


@lru_cache(maxsize=64)
def _read(name: str, packages: tuple[str, ...]) -> str:
    places = [files(package) / "shaders" / name for package in (*packages, _CORE)]
    found = next((place for place in places if place.is_file()), places[-1])
    return found.read_text("utf-8")


def floats(values: ArrayLike) -> tuple[float, ...]:
    """Numbers as a shader reads them, flat.

    Float32: processors differ in the last bit of float64, which would change a job's recipe, and a
    journal would not replay elsewhere.
    """
    return tuple(float(value) for value in np.asarray(values, dtype=np.float32).ravel())

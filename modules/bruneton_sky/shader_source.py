"""The text of a shader, put together from its files, and numbers as it reads them."""

import re
from functools import lru_cache
from importlib.resources import files

import numpy as np
from numpy.typing import ArrayLike

_INCLUDE = re.compile(r'^#include "([^"]+)"$', re.MULTILINE)
_PRODUCT = "bruneton_sky"


@lru_cache(maxsize=32)
def shader_source(name: str, package: str = _PRODUCT) -> str:
    """The shader of that file name with every `#include "file"` line replaced by the file.

    A file that is named several times is included once, where it is named first.

    Args:
        name: of a file in the folder `shaders` of the package or, if it is not there, of
            `bruneton_sky` itself.
        package: whose shader it is.

    Raises:
        FileNotFoundError: there is no such file.
    """
    return expand_includes(_read(name, package), package)


def expand_includes(source: str, package: str = _PRODUCT) -> str:
    """A shader's text with the files that it includes; `package` as for `shader_source`."""
    seen: set[str] = set()

    def insert(match: re.Match[str]) -> str:
        if match[1] in seen:
            return ""
        seen.add(match[1])
        return _INCLUDE.sub(insert, _read(match[1], package))

    return _INCLUDE.sub(insert, source)


@lru_cache(maxsize=32)
def _read(name: str, package: str) -> str:
    own = files(package) / "shaders" / name
    return (own if own.is_file() else files(_PRODUCT) / "shaders" / name).read_text("utf-8")


def floats(values: ArrayLike) -> tuple[float, ...]:
    """Numbers as the shader reads them.

    Float32: processors differ in the last bit of float64, which would change a job's recipe.
    """
    return tuple(float(value) for value in np.asarray(values, dtype=np.float32))

"""The text of a shader, put together from its files."""

import re
from functools import lru_cache
from importlib.resources import files

_INCLUDE = re.compile(r'^#include "([^"]+)"$', re.MULTILINE)


@lru_cache(maxsize=32)
def shader_source(name: str) -> str:
    """The shader of that file name with every `#include "file"` line replaced by the file.

    A file named several times is put in where it is named first.
    """
    return expand_includes(_read(name))


def expand_includes(source: str) -> str:
    """A shader's own text with the module's shader files put in where they are included."""
    seen: set[str] = set()

    def insert(match: re.Match[str]) -> str:
        if match[1] in seen:
            return ""
        seen.add(match[1])
        return _INCLUDE.sub(insert, _read(match[1]))

    return _INCLUDE.sub(insert, source)


@lru_cache(maxsize=32)
def _read(name: str) -> str:
    return (files("bruneton_sky") / "shaders" / name).read_text("utf-8")

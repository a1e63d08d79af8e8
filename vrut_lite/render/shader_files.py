"""Shader sources with their includes."""

import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from vrut_lite.render.uniform_blocks import BLOCK_FILES

SHADERS = Path(__file__).parent / "shaders"
_INCLUDE = re.compile(r"^//!include (\S+)$", re.MULTILINE)


Defines = tuple[str, ...]


@lru_cache(maxsize=32)
def shader_source(name: str | Path) -> str:
    """The text of a shader of ours or, by its path, of a module; each line `//!include FILE` is
    replaced by that file of ours or uniform block."""
    if name in BLOCK_FILES:
        return BLOCK_FILES[str(name)].glsl()
    text = (SHADERS / name).read_text()
    return _INCLUDE.sub(lambda found: shader_source(found.group(1)), text)


def defined(source: str, names: Mapping[str, int]) -> str:
    """The text with these names defined after its version line."""
    version, rest = source.split("\n", 1)
    defines = "".join(f"#define {name} {value}\n" for name, value in names.items())
    return f"{version}\n{defines}{rest}"

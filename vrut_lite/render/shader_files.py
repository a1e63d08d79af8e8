"""Shader sources with their includes."""

import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from vrut_lite.installed_parts import HOOKS_OF_SEVERAL
from vrut_lite.render.hook_glsl import hook_files, hook_of, joined_glsl
from vrut_lite.render.part_slots import part_blocks, part_units
from vrut_lite.render.uniform_blocks import BLOCK_FILES

SHADERS = Path(__file__).parent / "shaders"
_LINE = re.compile(r"^//!(include|sampler) (\S+)(?: (\S+))?$", re.MULTILINE)


Defines = tuple[str, ...]


@lru_cache(maxsize=48)
def shader_source(name: str | Path) -> str:
    """The text of a shader of ours or, by its path, of a module.

    Each line `//!include FILE` is replaced by a file beside it, one of ours, a frame part's hook
    or a uniform block, and `//!sampler TYPE NAME` by the declaration of a part's texture.
    """
    path = SHADERS / name

    def text_of(found: re.Match[str]) -> str:
        line, first, second = found.groups()
        if line == "sampler":
            return f"layout(binding = {part_units()[second]}) uniform {first} {second};"
        return _included(path.parent, first)

    return _LINE.sub(text_of, path.read_text(encoding="utf-8"))


def _included(folder: Path, name: str) -> str:
    beside = folder / name
    if beside.exists():
        return shader_source(beside)
    if (hook := hook_of(name)) is not None:
        sources = {part: shader_source(file) for part, file in hook_files(hook).items()}
        return joined_glsl(hook, sources) if hook in HOOKS_OF_SEVERAL else "".join(sources.values())
    block = BLOCK_FILES.get(name) or part_blocks().get(name)
    return shader_source(name) if block is None else block.glsl()


def defined(source: str, names: Mapping[str, int]) -> str:
    """The text with these names defined after its version line."""
    version, rest = source.split("\n", 1)
    defines = "".join(f"#define {name} {value}\n" for name, value in names.items())
    return f"{version}\n{defines}{rest}"

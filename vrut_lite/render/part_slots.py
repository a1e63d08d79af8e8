"""Bindings and texture units of the frame parts' shaders, given out in the order of their names."""

from functools import cache

from vrut_lite.installed_parts import frame_parts
from vrut_lite.uniform_block import UniformBlock

# After those of the renderer's own blocks and textures.
_FIRST_BINDING, _FIRST_UNIT = 8, 40


@cache
def part_blocks() -> dict[str, UniformBlock]:
    """All parts' uniform blocks by the names that shaders include."""
    named = [item for part in frame_parts().values() for item in part.blocks.items()]
    return {
        name: block._replace(binding=_FIRST_BINDING + number)
        for number, (name, block) in enumerate(named)
    }


@cache
def part_units() -> dict[str, int]:
    """Texture units of all parts' samplers, by name."""
    named = [name for part in frame_parts().values() for name in part.samplers]
    return {name: _FIRST_UNIT + number for number, name in enumerate(named)}

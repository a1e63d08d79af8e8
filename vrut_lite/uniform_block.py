"""A uniform block: one description makes both the GLSL and the bytes, so that they always agree.

Fields are laid out by the rules of std140 (OpenGL 4.3, section 7.6.2.2).
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

# Floats of a type, and the multiple of floats at which it begins.
_LAYOUT = {
    "float": (1, 1),
    "vec2": (2, 2),
    "vec3": (3, 4),
    "vec4": (4, 4),
    "mat4": (16, 4),
}
# Types that lie alike in std140 and std430.
_ALIKE = ("float", "vec2", "vec3", "vec4")


class UniformBlock(NamedTuple):
    """A block `name`, whose fields shaders read as `instance.field`.

    `fields` gives each field's GLSL type, a number, vector or matrix (4, 4) or an array
    `mat4[n]` of these, and its meaning. The renderer gives the blocks of frame parts their binding.
    """

    name: str
    instance: str
    fields: Mapping[str, tuple[str, str]]
    binding: int = -1

    @property
    def size_bytes(self) -> int:
        """Size of the buffer behind it."""
        return 4 * self._places()[1]

    def glsl(self) -> str:
        """Its declaration."""
        return self._declared(f"layout(std140, binding = {self.binding}) uniform")

    def glsl_of_buffer(self, binding: int) -> str:
        """Its declaration as a storage buffer of the same bytes, for programs of a `GpuJob`.

        The fields are no arrays and no matrices, which the two layouts space differently.
        """
        assert all(kind in _ALIKE for kind, _ in self.fields.values())
        return self._declared(f"layout(std430, binding = {binding}) restrict readonly buffer")

    def _declared(self, head: str) -> str:
        lines = [f"    {kind} {name};  // {text}" for name, (kind, text) in self.fields.items()]
        return "\n".join([f"{head} {self.name} {{", *lines, f"}} {self.instance};\n"])

    def packed(self, **values: Any) -> bytes:
        """The bytes of a value for each field; matrices (..., 4, 4) as mathematics writes them.

        Raises:
            ValueError: a field lacks a value, a value lacks a field, or has the wrong length.
        """
        if values.keys() != self.fields.keys():
            odd = sorted(values.keys() ^ self.fields.keys())
            raise ValueError(f"the uniform block {self.name} and its values differ in {odd}")
        places, length = self._places()
        block = np.zeros(length, np.float32)
        for name, value in values.items():
            kind, _ = self.fields[name]
            numbers = np.asarray(value, np.float64)
            if numbers.size != _layout(kind)[0]:
                raise ValueError(f"{name} of the uniform block {self.name} must be a {kind}")
            # GLSL keeps matrices column by column.
            columns = np.swapaxes(numbers, -1, -2) if numbers.ndim > 1 else numbers
            block[places[name] : places[name] + numbers.size] = columns.ravel()
        return block.tobytes()

    def _places(self) -> tuple[dict[str, int], int]:
        """Where each field begins, in floats, and the block's length."""
        places, end = {}, 0
        for name, (kind, _) in self.fields.items():
            size, multiple = _layout(kind)
            places[name] = -(-end // multiple) * multiple
            end = places[name] + size
        return places, -(-end // 4) * 4


def _layout(kind: str) -> tuple[int, int]:
    """Floats of a type, and the multiple of floats at which it begins."""
    element, _, count = kind.partition("[")
    size, multiple = _LAYOUT[element]
    return size * int(count.rstrip("]") or 1), multiple

"""Uniform blocks: the bytes lie where the GL reads them."""

import numpy as np
import pytest

from vrut_lite.render.part_slots import part_blocks
from vrut_lite.uniform_block import UniformBlock

AIR, CLOUDS = (part_blocks()[f"{name}_block.glsl"] for name in ("air", "cloud"))
BLOCK = UniformBlock(
    "Some", "some", {"a": ("float", "one"), "b": ("vec3", "three"), "c": ("mat4", "sixteen")}, 5
)


@pytest.mark.gl
@pytest.mark.parametrize("block", [AIR, CLOUDS, BLOCK], ids=lambda block: block.name)
def test_each_field_lies_where_gl_says(gl_owner, block):
    """The driver's own offsets of std140, and its size of the block."""
    names = list(block.fields)
    read = " + ".join(f"{block.instance}.{name}{_first(block, name)}" for name in names)
    text = (
        f"#version 430 core\nlayout(local_size_x = 1) in;\n{block.glsl()}"
        "layout(std430, binding = 0) writeonly buffer Sum { float total; };\n"
        f"void main() {{ total = {read}; }}\n"
    )

    def layout(context):
        program = context.compute_shader(text)
        offsets = [_offset(program.glo, f"{block.name}.{name}") for name in names]
        size = program[block.name].size
        program.release()
        return offsets, size

    places, _ = block._places()
    offsets, size = gl_owner.call(layout)
    assert offsets == [4 * places[name] for name in names]
    assert size == block.size_bytes


def _offset(program, name):
    from OpenGL import GL

    index = GL.glGetProgramResourceIndex(program, GL.GL_UNIFORM, name.encode())
    wanted = np.array([GL.GL_OFFSET], np.uint32)
    length, found = np.zeros(1, np.int32), np.zeros(1, np.int32)
    GL.glGetProgramResourceiv(program, GL.GL_UNIFORM, index, 1, wanted, 1, length, found)
    return int(found[0])


def _first(block, name):
    return {"float": "", "mat4": "[0][0]"}.get(block.fields[name][0], "[0]")


def test_values_are_packed_by_name_in_any_order():
    """A matrix is kept column by column, as GLSL reads it."""
    matrix = np.arange(16.0).reshape(4, 4)
    packed = np.frombuffer(BLOCK.packed(c=matrix, b=(1, 2, 3), a=9.0), np.float32)
    np.testing.assert_array_equal(packed[[0, 4, 5, 6]], [9, 1, 2, 3])
    np.testing.assert_array_equal(packed[8:], matrix.T.ravel())


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"a": 1.0, "b": (1, 2, 3)}, "differ in \\['c'\\]"),
        ({"a": 1.0, "b": (1, 2, 3), "c": np.eye(4), "d": 1}, "differ in \\['d'\\]"),
        ({"a": 1.0, "b": (1, 2), "c": np.eye(4)}, "b of the uniform block Some must be a vec3"),
    ],
)
def test_a_missing_an_unknown_and_a_misshapen_value_are_refused(values, words):
    """Nothing is shifted silently."""
    with pytest.raises(ValueError, match=words):
        BLOCK.packed(**values)

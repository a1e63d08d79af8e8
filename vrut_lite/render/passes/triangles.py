"""Draw calls of pyrender's primitives, by visible side."""

from typing import Any, NamedTuple

from vrut_lite.render import direct_gl
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.pyrender_scene import PlacedPrimitive
from vrut_lite.render.shader_files import Defines

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)


class Side(NamedTuple):
    """Faces drawn in one call: GL's cull face, 0 without culling, and defines of their programs."""

    hidden: int
    defines: Defines = ()


def sides(placed: PlacedPrimitive, blended: bool) -> tuple[Side, ...]:
    """The visible sides of a mesh in draw order; back faces first if it is blended.

    Where normals agree with the triangles' winding, the front's program omits the back's light,
    which costs a software renderer as much whether it is seen or not.
    """
    primitive = placed.primitive
    if not placed.is_two_sided:
        return (Side(GL.GL_BACK),)
    if blended:
        return Side(GL.GL_FRONT), Side(GL.GL_BACK)
    if primitive.wound_as_normals and not placed.is_mirrored:
        return Side(GL.GL_BACK, ("FRONT",)), Side(GL.GL_FRONT, ("BACK",))
    return (Side(0),)


def draw_side(primitive: Any, side: Side, blended: bool = False) -> None:
    """Draw one side of a mesh."""
    if blended:
        direct_gl.enable(GL.GL_BLEND)
        if primitive.material.terms.transmits:
            # Multiplies the destination by the shader's second output.
            direct_gl.blend_function(GL.GL_ONE, GL.GL_SRC1_COLOR)
        else:
            direct_gl.blend_function(GL.GL_SRC_ALPHA, GL.GL_ONE_MINUS_SRC_ALPHA)
    else:
        direct_gl.disable(GL.GL_BLEND)
    if side.hidden:
        direct_gl.enable(GL.GL_CULL_FACE)
        direct_gl.cull_face(side.hidden)
    else:
        direct_gl.disable(GL.GL_CULL_FACE)
    draw_triangles(primitive)


def draw_triangles(primitive: Any) -> None:
    """Draw a whole primitive with the current GL state."""
    direct_gl.bind_vertices(primitive._vaid)
    if primitive.indices is not None:
        direct_gl.draw_elements(primitive.mode, primitive.indices.size, GL.GL_UNSIGNED_INT, None)
    else:
        direct_gl.draw_arrays(primitive.mode, 0, len(primitive.positions))
    direct_gl.bind_vertices(0)


def draw_whole_picture(primitive: Any) -> None:
    """Draw one triangle of a program that needs no vertices, with a primitive's vertex array."""
    direct_gl.disable(GL.GL_BLEND)
    direct_gl.disable(GL.GL_CULL_FACE)
    direct_gl.bind_vertices(primitive._vaid)
    direct_gl.draw_arrays(GL.GL_TRIANGLES, 0, 3)
    direct_gl.bind_vertices(0)

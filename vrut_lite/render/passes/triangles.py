"""Draw calls of pyrender's primitives, by the sides that show."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from vrut_lite.render import direct_gl
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.pyrender_scene import PlacedPrimitive
from vrut_lite.render.shader_files import Defines

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)


class Side(NamedTuple):
    """Faces that are drawn in one go: which GL hides, none for 0, and defines of their programs."""

    hidden: int
    defines: Defines = ()


class Run(NamedTuple):
    """Consecutive triangles of a mesh: the first, and how many."""

    first: int
    triangles: int


PlacedSide = tuple[PlacedPrimitive, Side]
_BYTES_OF_INDEX = 4


def sides(placed: PlacedPrimitive, blended: bool) -> tuple[Side, ...]:
    """The sides of a mesh that show, one after another: of a blended one the backs first.

    Where normals agree with the triangles' winding, programs of the front need no light of the
    back, which on a software renderer costs as much whether it is seen or not.
    """
    primitive = placed.primitive
    if not placed.is_two_sided:
        return (Side(GL.GL_BACK),)
    if blended:
        return Side(GL.GL_FRONT), Side(GL.GL_BACK)
    if primitive.wound_as_normals and not placed.is_mirrored:
        return Side(GL.GL_BACK, ("FRONT",)), Side(GL.GL_FRONT, ("BACK",))
    return (Side(0),)


def runs_of(primitive: Any, longest: int) -> tuple[Run, ...]:
    """A mesh's triangles in runs of a like length; none of what has no triangles by indices."""
    if primitive.indices is None or primitive.mode != GL.GL_TRIANGLES:
        return ()
    count = primitive.indices.size // 3
    starts = range(0, count, longest)
    return tuple(Run(first, min(longest, count - first)) for first in starts)


def joined(runs: Sequence[Run]) -> tuple[Run, ...]:
    """The same triangles in as few runs as possible."""
    found: list[Run] = []
    for run in runs:
        if found and found[-1].first + found[-1].triangles == run.first:
            found[-1] = Run(found[-1].first, found[-1].triangles + run.triangles)
        else:
            found.append(run)
    return tuple(found)


def draw_side(
    primitive: Any, side: Side, blended: bool = False, runs: Sequence[Run] | None = None
) -> None:
    """Draw one side of a mesh, or of some of its triangles."""
    show_side(primitive, side, blended)
    if runs is None:
        draw_triangles(primitive)
        return
    direct_gl.bind_vertices(primitive._vaid)
    for run in runs:
        draw_run(primitive, run)
    direct_gl.bind_vertices(0)


def show_side(primitive: Any, side: Side, blended: bool = False) -> None:
    """Set what draws one side of a mesh."""
    if blended:
        direct_gl.enable(GL.GL_BLEND)
        if primitive.material.terms.transmits:
            # What is behind times a colour that the shader says.
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


def draw_triangles(primitive: Any) -> None:
    """Draw all of a primitive with the state that is set."""
    direct_gl.bind_vertices(primitive._vaid)
    if primitive.indices is not None:
        direct_gl.draw_elements(primitive.mode, primitive.indices.size, GL.GL_UNSIGNED_INT, None)
    else:
        direct_gl.draw_arrays(primitive.mode, 0, len(primitive.positions))
    direct_gl.bind_vertices(0)


def draw_run(primitive: Any, run: Run) -> None:
    """Draw some triangles of a primitive that is bound."""
    start = 3 * _BYTES_OF_INDEX * run.first
    direct_gl.draw_elements(primitive.mode, 3 * run.triangles, GL.GL_UNSIGNED_INT, start)

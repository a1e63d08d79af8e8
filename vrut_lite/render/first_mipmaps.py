"""What llvmpipe compiles for the first mipmaps, early: while other threads import libraries."""

from typing import Any

from vrut_lite.render.unlocked import build_mipmaps

_EDGE_PX = 16


def make_first_mipmaps(context: Any) -> None:
    """Make some of a cube map like the sky's, and of a picture like a material's."""
    from OpenGL import GL

    cube = context.texture_cube((_EDGE_PX, _EDGE_PX), 4, dtype="f2")
    picture = context.texture((_EDGE_PX, _EDGE_PX), 3, internal_format=GL.GL_SRGB8)
    for target, texture in ((GL.GL_TEXTURE_CUBE_MAP, cube), (GL.GL_TEXTURE_2D, picture)):
        build_mipmaps(target, texture)
        texture.release()

"""Early compilation of llvmpipe's mipmap code, while other threads import libraries."""

import ctypes
from typing import Any

_EDGE_PX = 16
_CUBE_MAP, _PICTURE, _SRGB8_ALPHA8 = 0x8513, 0x0DE1, 0x8C43


def make_first_mipmaps(context: Any) -> None:
    """Generate mipmaps of a cube map like the sky's and of a texture like a material's."""
    # Importing all of PyOpenGL takes 0.2 s; moderngl would not let other threads run.
    from OpenGL.platform import PLATFORM

    address = PLATFORM.getExtensionProcedure(b"glGenerateMipmap")
    generate = ctypes.CFUNCTYPE(None, ctypes.c_uint)(address)
    cube = context.texture_cube((_EDGE_PX, _EDGE_PX), 4, dtype="f2")
    picture = context.texture((_EDGE_PX, _EDGE_PX), 4, internal_format=_SRGB8_ALPHA8)
    for target, texture in ((_CUBE_MAP, cube), (_PICTURE, picture)):
        texture.use(location=0)
        generate(target)
        texture.release()

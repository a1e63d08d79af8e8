"""Maps of colour, which are decoded before they are filtered.

A mean of sRGB's numbers is darker than the mean of the light they stand for: bricks seen from
afar lost 3 % of theirs, and a chequerboard more than half (glTF 2.0, section 3.9.2).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.gl_environment import import_pyrender

pyrender = import_pyrender()


class ColourTexture(pyrender.Texture):  # type: ignore[name-defined]
    """pyrender's texture, kept in a format that the GPU decodes texel by texel."""

    def _add_to_context(self) -> None:
        # Not before the environment for EGL is prepared.
        from OpenGL import GL

        super()._add_to_context()
        opaque = self.source_channels == "RGB"
        channels = GL.GL_RGB if opaque else GL.GL_RGBA
        stored_as = GL.GL_SRGB8 if opaque else GL.GL_SRGB8_ALPHA8
        height, width = self.source.shape[:2]
        # pyrender has set wrapping and filters; its texels, turned upside down, are replaced.
        texels = self.source[::-1].tobytes()
        GL.glBindTexture(self.tex_type, self._texid)
        GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
        GL.glTexImage2D(
            self.tex_type, 0, stored_as, width, height, 0, channels, GL.GL_UNSIGNED_BYTE, texels
        )
        GL.glGenerateMipmap(self.tex_type)
        GL.glBindTexture(self.tex_type, 0)


def colour_texture(texels: NDArray[np.uint8] | None, channels: str) -> Any:
    """The texture of sRGB-encoded texels (h, w, 3 or 4); `channels` is RGB or RGBA."""
    return None if texels is None else ColourTexture(source=texels, source_channels=channels)

"""Maps of a material as textures of pyrender, with their samplers.

Colours are decoded before they are filtered: a mean of sRGB values is darker than the mean of the
linear values. Distant bricks lost 3 % of their light, a chequerboard more than half (glTF 2.0,
section 3.9.2).
"""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.scene_content import COLOUR_MAPS, MapName, Material, MaterialMap, Sampler
from vrut_lite.render.cut_out import cut_out_levels
from vrut_lite.render.gl_environment import import_pyrender

pyrender = import_pyrender()

# OpenGL's codes.
_WRAPS = {"repeat": 10497, "clamp": 33071, "mirror": 33648}
_NEAREST, _LINEAR = 9728, 9729
# Channels uploaded, where not RGB. A single channel fails in pyrender for images one pixel wide or
# high.
_CHANNELS: dict[MapName, str] = {
    "base_colour": "RGBA",
    "metallic_roughness": "GB",
    "specular": "RGBA",
}


class ColourTexture(pyrender.Texture):  # type: ignore[name-defined]
    """pyrender's texture, kept in a format that the GPU decodes texel by texel."""

    # pyrender's property: texels (h, w, channels).
    source: Any

    def _add_to_context(self) -> None:
        # pyrender sets up the sampler and uploads one texel; `_store` replaces it by the image.
        whole = self.source
        self._source = whole[:1, :1]
        try:
            super()._add_to_context()
        finally:
            self._source = whole
        self._store(self._levels())

    def _levels(self) -> Iterable[NDArray[np.uint8]]:
        return [self.source]

    def _store(self, levels: Iterable[NDArray[np.uint8]]) -> None:
        """Upload mip levels, flipped vertically; a single level gets generated mipmaps."""
        # Not before the environment for EGL is prepared.
        from OpenGL import GL

        opaque = self.source_channels == "RGB"
        channels = GL.GL_RGB if opaque else GL.GL_RGBA
        stored_as = GL.GL_SRGB8 if opaque else GL.GL_SRGB8_ALPHA8
        GL.glBindTexture(self.tex_type, self._texid)
        GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
        number = -1
        for number, texels in enumerate(levels):
            height, width = texels.shape[:2]
            GL.glTexImage2D(
                self.tex_type, number, stored_as, width, height, 0, channels, GL.GL_UNSIGNED_BYTE,
                texels[::-1].tobytes(),
            )  # fmt: skip
        if number == 0:
            GL.glGenerateMipmap(self.tex_type)
        GL.glBindTexture(self.tex_type, 0)


class CutOutTexture(ColourTexture):
    """A map with an alpha cut-off of `cut_off`; `cut_out.py` describes its mip levels."""

    cut_off = 0.5

    def _levels(self) -> Iterable[NDArray[np.uint8]]:
        return cut_out_levels(self.source, self.cut_off)


def textures_of(material: Material) -> dict[MapName, Any]:
    """The textures of a material's maps."""
    return {name: _texture(material, name, found) for name, found in material.maps.items()}


def _texture(material: Material, name: MapName, found: MaterialMap) -> Any:
    kept = {
        "source": found.texels,
        "source_channels": _CHANNELS.get(name, "RGB"),
        "sampler": _sampler(found.sampler),
    }
    if name == "base_colour" and is_cut_out(material):
        texture = CutOutTexture(**kept)
        # The factor multiplies alpha before it is cut.
        texture.cut_off = material.alpha_cutoff / max(float(material.base_colour_rgba[3]), 1e-6)
        return texture
    return (ColourTexture if name in COLOUR_MAPS else pyrender.Texture)(**kept)


def is_cut_out(material: Material) -> bool:
    """Whether a map's alpha cuts holes."""
    found = material.maps.get("base_colour")
    return material.alpha_mode == "MASK" and found is not None and found.texels.shape[2] == 4


def _sampler(sampler: Sampler) -> Any:
    return pyrender.Sampler(
        wrapS=_WRAPS[sampler.wrap_u],
        wrapT=_WRAPS[sampler.wrap_v],
        magFilter=_NEAREST if sampler.nearest else _LINEAR,
    )

"""Terms of glTF's material extensions for shaders: a uniform block, maps and defines.

Materials without extensions have programs without them, at no cost.
"""

from typing import Any

import numpy as np

from vrut_lite.geometry.thin_film import film_table
from vrut_lite.messages.scene_content import MapName
from vrut_lite.messages.surface_terms import SurfaceTerms
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.shader_files import Defines
from vrut_lite.render.uniform_blocks import SURFACE_TERMS

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)

# Texture units of surface_terms.glsl.
_MAP_UNITS: dict[MapName, int] = {
    "specular": 18,
    "specular_colour": 19,
    "clearcoat": 20,
    "transmission": 21,
    "iridescence": 27,
    "iridescence_thickness": 28,
}
_FILM_UNIT = 33
BACKDROP_UNIT = 22
# Roughness up to which a pane shows the background without blur.
_SMOOTH = 0.05
_PLAIN = SurfaceTerms()
Film = tuple[float, float, float]
_LINEAR_AND_CLAMPED = {
    GL.GL_TEXTURE_MIN_FILTER: GL.GL_LINEAR,
    GL.GL_TEXTURE_MAG_FILTER: GL.GL_LINEAR,
    GL.GL_TEXTURE_WRAP_S: GL.GL_CLAMP_TO_EDGE,
    GL.GL_TEXTURE_WRAP_T: GL.GL_CLAMP_TO_EDGE,
    GL.GL_TEXTURE_WRAP_R: GL.GL_CLAMP_TO_EDGE,
}


def term_defines(material: Any, blended: bool) -> Defines:
    """Defines of a material's programs, by its terms."""
    terms: SurfaceTerms = material.terms
    if terms.unlit:
        return ("UNLIT",)
    if not _has_terms(material):
        return ()
    defines = ["TERMS", *(f"HAS_{name.upper()}_TEX" for name in material.further)]
    if any(terms.sheen_rgb):
        defines.append("SHEEN")
    if terms.anisotropy > 0.0:
        defines.append("ANISOTROPY")
    if terms.clearcoat > 0.0:
        defines.append("CLEARCOAT")
    if terms.iridescence > 0.0:
        defines.append("IRIDESCENCE")
    if terms.transmits and blended:
        defines.append("GLASS")
        if needs_backdrop(material):
            defines.append("BACKDROP")
    return tuple(defines)


def needs_backdrop(material: Any) -> bool:
    """Whether a material refracts or blurs the background."""
    terms: SurfaceTerms = material.terms
    return terms.transmits and (not terms.is_pane or material.roughnessFactor > _SMOOTH)


def _has_terms(material: Any) -> bool:
    return material.terms != _PLAIN and not material.matte


class SurfaceTermsOnGpu:
    """The block's buffer, and the tables of thin films; used on the GL thread only."""

    def __init__(self) -> None:
        self._buffer: int | None = None
        self._films: dict[Film, int] = {}

    def bind(self, material: Any, world_from_model: np.ndarray) -> None:
        """Bind a material's terms and maps for the next mesh, which a matrix (4, 4) places."""
        if not _has_terms(material):
            return
        terms: SurfaceTerms = material.terms
        layer = {f"{name}_layer": material.layer_of.get(name, 0) for name in _MAP_UNITS}
        data = SURFACE_TERMS.packed(
            f0=terms.f0_rgb,
            f90=terms.f90,
            sheen_rgb=terms.sheen_rgb,
            sheen_roughness=terms.sheen_roughness,
            extinction_per_m=terms.extinction_per_m,
            thickness_m=terms.thickness_m * _scale_of(world_from_model),
            ior=terms.ior,
            transmission=terms.transmission,
            clearcoat=terms.clearcoat,
            clearcoat_roughness=terms.clearcoat_roughness,
            anisotropy=terms.anisotropy,
            anisotropy_rad=terms.anisotropy_rad,
            iridescence=terms.iridescence,
            **layer,
        )
        if self._buffer is None:
            self._buffer = int(GL.glGenBuffers(1))
        GL.glBindBufferBase(GL.GL_UNIFORM_BUFFER, SURFACE_TERMS.binding, self._buffer)
        GL.glBufferData(GL.GL_UNIFORM_BUFFER, len(data), data, GL.GL_STREAM_DRAW)
        for name, texture in material.further.items():
            GL.glActiveTexture(GL.GL_TEXTURE0 + _MAP_UNITS[name])
            texture._bind()
        if terms.iridescence > 0.0:
            GL.glActiveTexture(GL.GL_TEXTURE0 + _FILM_UNIT)
            GL.glBindTexture(GL.GL_TEXTURE_3D, self._film(terms))
        GL.glActiveTexture(GL.GL_TEXTURE0)

    def _film(self, terms: SurfaceTerms) -> int:
        """The texture of a film's table."""
        film = terms.film_ior, terms.film_least_nm, terms.film_most_nm
        if film not in self._films:
            table = film_table(*film)
            self._films[film] = int(GL.glGenTextures(1))
            GL.glBindTexture(GL.GL_TEXTURE_3D, self._films[film])
            layers, rows, columns, _ = table.shape
            GL.glTexImage3D(
                GL.GL_TEXTURE_3D, 0, GL.GL_RGB32F, columns, rows, layers, 0, GL.GL_RGB,
                GL.GL_FLOAT, table,
            )  # fmt: skip
            for name, value in _LINEAR_AND_CLAMPED.items():
                GL.glTexParameteri(GL.GL_TEXTURE_3D, name, value)
        return self._films[film]

    def release(self) -> None:
        """Free the buffer and the tables."""
        if self._buffer is not None:
            GL.glDeleteBuffers(1, [self._buffer])
        if self._films:
            GL.glDeleteTextures(list(self._films.values()))
        self._buffer = None
        self._films.clear()


def _scale_of(world_from_model: np.ndarray) -> float:
    """Mean scale factor of a matrix (4, 4)."""
    return float(np.abs(np.linalg.det(world_from_model[:3, :3])) ** (1 / 3))

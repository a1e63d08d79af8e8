"""The maps of a material as arrays in linear values, multiplied by its factors beforehand.

mitsuba's textures multiply nothing, so factor and map become one bitmap. Its row 0 lies at
v = 0, as in glTF's own coordinates.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.messages.scene_content import MapName, Material
from vrut_lite.messages.surface_terms import SurfaceTerms

FloatArray = NDArray[np.float32]
# A cut-out map is enlarged to at most so many texels, to have smooth edges after the cut.
_CUT_OUT_TEXELS = 4 * 2**20
_ENLARGED = 4


class Maps(NamedTuple):
    """The maps of a surface: arrays (h, w, c) float32, or None where a factor suffices.

    base_colour linear RGB; roughness, metallic and opacity one channel; normal in [0, 1] as
    mitsuba reads it; emission W m^-2 sr^-1 times 683 (cd m^-2). Those of extensions lack their
    factors.
    """

    base_colour: FloatArray | None
    roughness: FloatArray | None
    metallic: FloatArray | None
    normal: FloatArray | None
    emission: FloatArray | None
    opacity: FloatArray | None
    specular: FloatArray | None
    specular_colour: FloatArray | None
    clearcoat: FloatArray | None
    transmission: FloatArray | None
    iridescence: FloatArray | None
    film_thickness: FloatArray | None

    def f0_and_f90(self, terms: SurfaceTerms) -> tuple[FloatArray, FloatArray]:
        """A dielectric's reflectance (h, w, 3) at normal incidence, (h, w, 1) at grazing angles."""
        specular = np.ones((1, 1, 1)) if self.specular is None else self.specular
        colour = np.ones((1, 1, 3)) if self.specular_colour is None else self.specular_colour
        if specular.shape[:2] != colour.shape[:2] and colour.size > 3 and specular.size > 1:
            # With two maps of different sizes, the one that seldom varies is replaced by its mean.
            specular = specular.mean(axis=(0, 1), keepdims=True)
        f0 = specular * colour * terms.f0_rgb
        return np.asarray(f0, np.float32), np.asarray(specular * terms.f90, np.float32)


def maps_of(material: Material, layer: int) -> Maps:
    """The maps of a material that use one layer of texture coordinates."""

    def pixels(name: MapName) -> FloatArray | None:
        found = material.maps.get(name)
        if found is None or found.uv_layer != layer:
            return None
        return found.texels.astype(np.float32) / np.float32(255.0)

    colour, both = pixels("base_colour"), pixels("metallic_roughness")
    normal, emission = pixels("normal"), pixels("emission")
    tint = pixels("specular_colour")
    factor = np.asarray(material.base_colour_rgba, dtype=np.float32)
    return Maps(
        base_colour=None if colour is None else _linear(colour[..., :3]) * factor[:3],
        roughness=None if both is None else both[..., 1:2] * np.float32(material.roughness),
        metallic=None if both is None else both[..., 2:3] * np.float32(material.metallic),
        normal=None if normal is None else scaled_normals(normal[..., :3], material.normal_scale),
        emission=None if emission is None
        else _linear(emission[..., :3]) * np.asarray(material.emission_rgb, np.float32),
        opacity=_opacity(material, colour),
        specular=_channel(pixels("specular"), 3),
        specular_colour=None if tint is None else _linear(tint[..., :3]),
        clearcoat=_channel(pixels("clearcoat"), 0),
        transmission=_channel(pixels("transmission"), 0),
        iridescence=_channel(pixels("iridescence"), 0),
        film_thickness=_channel(pixels("iridescence_thickness"), 1),
    )  # fmt: skip


def _channel(texels: FloatArray | None, number: int) -> FloatArray | None:
    if texels is None or texels.shape[2] <= number:
        return None
    return texels[..., number : number + 1]


def scaled_normals(encoded: FloatArray, scale: float) -> FloatArray:
    """A normal map (h, w, 3), its slopes scaled, unit vectors again, encoded in [0, 1]."""
    normal = 2.0 * encoded - 1.0
    normal[..., :2] *= scale
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    normal = np.where(length > 0.0, normal / np.maximum(length, 1e-6), [0.0, 0.0, 1.0])
    return np.asarray(0.5 * normal + 0.5, np.float32)


def _opacity(material: Material, colour: FloatArray | None) -> FloatArray | None:
    """Alpha (h, w, 1) of a surface that a map cuts out or blends; None without such a map."""
    if material.alpha_mode == "OPAQUE" or colour is None or colour.shape[2] < 4:
        return None
    alpha = colour[..., 3:4] * np.float32(material.base_colour_rgba[3])
    return alpha if material.alpha_mode == "BLEND" else _cut(alpha, float(material.alpha_cutoff))


def _cut(alpha: FloatArray, cut_off: float) -> FloatArray:
    height, width = alpha.shape[:2]
    factor = _ENLARGED if alpha.size * _ENLARGED**2 <= _CUT_OUT_TEXELS else 1
    image = Image.fromarray(alpha[..., 0], mode="F")
    larger = image.resize((width * factor, height * factor), Image.Resampling.BILINEAR)
    return (np.asarray(larger) >= cut_off).astype(np.float32)[..., None]


def _linear(encoded: FloatArray) -> FloatArray:
    """Linear values of sRGB-encoded ones (IEC 61966-2-1)."""
    low, high = encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, low, high).astype(np.float32)

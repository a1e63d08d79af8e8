"""The maps of a material as arrays in linear values, multiplied by its factors beforehand.

mitsuba's textures multiply nothing, so factor and map become one bitmap. Its row 0 lies at
v = 0, as in glTF's own coordinates.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.scene.materials import SurfaceMaterial

FloatArray = NDArray[np.float32]
# A cut-out map is enlarged to at most so many texels, to have smooth edges after the cut.
_CUT_OUT_TEXELS = 4 * 2**20
_ENLARGED = 4


class Maps(NamedTuple):
    """What varies over a surface: arrays (h, w, c) float32, or None where the factor says all.

    base_colour linear RGB; roughness, metallic and opacity one channel; normal in [0, 1] as
    mitsuba reads it; emission W m^-2 sr^-1 times 683 (cd m^-2).
    """

    base_colour: FloatArray | None
    roughness: FloatArray | None
    metallic: FloatArray | None
    normal: FloatArray | None
    emission: FloatArray | None
    opacity: FloatArray | None


def maps_of(material: SurfaceMaterial, layer: int) -> Maps:
    """The maps of a material that use one layer of texture coordinates."""

    def pixels(name: str) -> FloatArray | None:
        image = getattr(material, name)
        return None if image is None or material.layer_of.get(name, 0) != layer else _array(image)

    colour, both = pixels("baseColorTexture"), pixels("metallicRoughnessTexture")
    normal, emission = pixels("normalTexture"), pixels("emissiveTexture")
    factor = np.asarray(material.baseColorFactor, dtype=np.float32)
    return Maps(
        base_colour=None if colour is None else _linear(colour[..., :3]) * factor[:3],
        roughness=None if both is None else both[..., 1:2] * np.float32(material.roughnessFactor),
        metallic=None if both is None else both[..., 2:3] * np.float32(material.metallicFactor),
        normal=None if normal is None else scaled_normals(normal[..., :3], material.normal_scale),
        emission=None if emission is None
        else _linear(emission[..., :3]) * np.asarray(material.emissiveFactor, np.float32),
        opacity=_opacity(material, colour),
    )  # fmt: skip


def scaled_normals(encoded: FloatArray, scale: float) -> FloatArray:
    """A normal map (h, w, 3), its slopes scaled, unit vectors again, encoded in [0, 1]."""
    normal = 2.0 * encoded - 1.0
    normal[..., :2] *= scale
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    normal = np.where(length > 0.0, normal / np.maximum(length, 1e-6), [0.0, 0.0, 1.0])
    return np.asarray(0.5 * normal + 0.5, np.float32)


def _opacity(material: SurfaceMaterial, colour: FloatArray | None) -> FloatArray | None:
    """Alpha (h, w, 1) of what is cut out or blended by a map; None if one number says it."""
    if material.alphaMode == "OPAQUE" or colour is None or colour.shape[2] < 4:
        return None
    alpha = colour[..., 3:4] * np.float32(material.baseColorFactor[3])
    return alpha if material.alphaMode == "BLEND" else _cut(alpha, float(material.alphaCutoff))


def _cut(alpha: FloatArray, cut_off: float) -> FloatArray:
    height, width = alpha.shape[:2]
    factor = _ENLARGED if alpha.size * _ENLARGED**2 <= _CUT_OUT_TEXELS else 1
    image = Image.fromarray(alpha[..., 0], mode="F")
    larger = image.resize((width * factor, height * factor), Image.Resampling.BILINEAR)
    return (np.asarray(larger) >= cut_off).astype(np.float32)[..., None]


def _array(image: Image.Image) -> FloatArray:
    """Pixels (h, w, 3 or 4) in [0, 1]."""
    return np.asarray(image, dtype=np.float32) / np.float32(255.0)


def _linear(encoded: FloatArray) -> FloatArray:
    """Linear values of sRGB-encoded ones (IEC 61966-2-1)."""
    low, high = encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, low, high).astype(np.float32)

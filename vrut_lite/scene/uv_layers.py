"""Assigns each map of a material to one of the mesh's layers of texture coordinates.

A layer is a set of coordinates under a transform. A mesh has at most two, enough for the usual
export (a tiled surface and a baked occlusion map); maps on a third layer are left out.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.gltf_schema import GltfMaterial, TextureInfo, TextureTransform
from vrut_lite.scene.gltf_terms import further_textures

MOST_LAYERS = 2


class UvLayer(NamedTuple):
    """A vertex attribute's name and the transform of its values."""

    attribute: str
    transform: TextureTransform | None

    def coordinates(self, values: NDArray[Any]) -> NDArray[np.float64]:
        """Texture coordinates (V, 2) with v upwards, from glTF's (V, 2), where it points down."""
        uv = values.astype(np.float64)
        if self.transform is not None and uv.shape[1] == 2:
            c, s = np.cos(self.transform.rotation), np.sin(self.transform.rotation)
            uv = (uv * self.transform.scale) @ np.array([[c, -s], [s, c]]) + self.transform.offset
        return np.concatenate([uv[:, :1], 1.0 - uv[:, 1:]], axis=1)


def texture_infos(source: GltfMaterial) -> dict[str, TextureInfo]:
    """The textures of a material by glTF's names, the base colour's first.

    Those of extensions follow, by the names of maps.
    """
    pbr = source.pbr_metallic_roughness
    named = {
        "baseColorTexture": pbr.base_color_texture,
        "metallicRoughnessTexture": pbr.metallic_roughness_texture,
        "normalTexture": source.normal_texture,
        "occlusionTexture": source.occlusion_texture,
        "emissiveTexture": source.emissive_texture,
    }
    core = {name: info for name, info in named.items() if info is not None}
    return {**core, **further_textures(source)}


def layers_of(source: GltfMaterial) -> tuple[list[UvLayer], dict[str, int]]:
    """The layers of a material, and the number of the layer for each map that has one."""
    layers: list[UvLayer] = []
    numbers: dict[str, int] = {}
    for name, info in texture_infos(source).items():
        layer = _layer(info)
        if layer not in layers:
            if len(layers) == MOST_LAYERS:
                continue
            layers.append(layer)
        numbers[name] = layers.index(layer)
    return layers, numbers


def _layer(info: TextureInfo) -> UvLayer:
    transform = info.extensions.transform
    number = info.tex_coord
    if transform is not None and transform.tex_coord is not None:
        number = transform.tex_coord
    return UvLayer(f"TEXCOORD_{number}", transform)

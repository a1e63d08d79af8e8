"""Specular-glossiness materials as metallic-roughness (KHR_materials_pbrSpecularGlossiness).

The extension is archived, and many files have it. Below a reflection whose colour at normal
incidence is `specular` lies matter of colour `diffuse`: a dielectric whose index reflects all,
tinted by KHR_materials_specular. Roughness is 1 less glossiness. glTF-Transform converts
alike.
"""

from typing import Any

import msgspec
import numpy as np
from msgspec import field
from PIL import Image

from vrut_lite.numeric_types import Vector
from vrut_lite.scene.gltf_schema import (
    GltfMaterial,
    GltfPart,
    MetallicRoughness,
    TextureInfo,
    Vector4,
)
from vrut_lite.scene.scene_file_error import SceneFileError

NAME = "KHR_materials_pbrSpecularGlossiness"


class SpecGloss(GltfPart, frozen=True):
    """The extension, with its defaults; alpha of its texture is glossiness, RGB sRGB-encoded."""

    diffuse_factor: Vector4 = (1.0, 1.0, 1.0, 1.0)
    diffuse_texture: TextureInfo | None = None
    specular_factor: Vector = (1.0, 1.0, 1.0)
    glossiness_factor: float = 1.0
    specular_glossiness_texture: TextureInfo | None = None


class _Extensions(GltfPart, frozen=True):
    spec_gloss: SpecGloss | None = field(default=None, name=NAME)


def spec_gloss_of(source: GltfMaterial) -> SpecGloss | None:
    """The extension of a material, also of a converted one.

    Raises:
        SceneFileError: it is not valid.
    """
    raw = bytes(source.extensions)
    if NAME.encode() not in raw:
        return None
    try:
        return msgspec.json.decode(raw, type=_Extensions).spec_gloss
    except msgspec.ValidationError as fault:
        raise SceneFileError(f"its {NAME} is not valid ({fault}); export it again") from fault


def as_metallic_roughness(source: GltfMaterial) -> GltfMaterial:
    """The material itself, or the replacement of its specular-glossiness."""
    found = spec_gloss_of(source)
    if found is None:
        return source
    extensions: dict[str, Any] = msgspec.json.decode(source.extensions)
    reflection: dict[str, Any] = {"specularColorFactor": found.specular_factor}
    if found.specular_glossiness_texture is not None:
        texture = extensions[NAME]["specularGlossinessTexture"]
        reflection["specularColorTexture"] = texture
    # An index of 0 means that everything is reflected, whatever the angle.
    extensions |= {"KHR_materials_specular": reflection, "KHR_materials_ior": {"ior": 0.0}}
    has_map = found.specular_glossiness_texture is not None
    return msgspec.structs.replace(
        source,
        pbr_metallic_roughness=MetallicRoughness(
            base_color_factor=found.diffuse_factor,
            base_color_texture=found.diffuse_texture,
            metallic_factor=0.0,
            # A map holds the whole roughness (roughness_image).
            roughness_factor=1.0 if has_map else 1.0 - found.glossiness_factor,
            metallic_roughness_texture=found.specular_glossiness_texture,
        ),
        extensions=msgspec.Raw(msgspec.json.encode(extensions)),
    )


def roughness_image(image: Image.Image, glossiness_factor: float) -> Image.Image:
    """Roughness in green, as metallic-roughness maps have it, from glossiness in alpha."""
    size = (image.height, image.width)
    alpha = np.asarray(image)[..., 3] if image.mode == "RGBA" else np.full(size, 255, np.uint8)
    texels = np.zeros((*size, 3), np.uint8)
    texels[..., 1] = np.clip(255.0 - glossiness_factor * alpha, 0.0, 255.0).round()
    return Image.fromarray(texels)

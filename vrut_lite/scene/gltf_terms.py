"""Extensions of glTF's materials: KHR_materials_* as the numbers and maps of `SurfaceTerms`.

Six of their maps are kept texel by texel. The others scale their factor by their mean.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import msgspec
import numpy as np
from msgspec import field
from PIL import Image

from vrut_lite.messages.surface_terms import SurfaceTerms
from vrut_lite.numeric_types import Vector
from vrut_lite.scene.gltf_schema import GltfMaterial, GltfPart, TextureInfo
from vrut_lite.scene.scene_file_error import SceneFileError

# Which extensions of materials are drawn.
DRAWN_EXTENSIONS = (
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
)
_MOST_IOR = 1e6
# Least transmittance of a black absorber, for the logarithm.
_LEAST_LEFT = 1e-4
_WHITE: Vector = (1.0, 1.0, 1.0)
_BLACK: Vector = (0.0, 0.0, 0.0)


class _Strength(GltfPart, frozen=True):
    emissive_strength: float = 1.0


class _Ior(GltfPart, frozen=True):
    ior: float = 1.5


class _Specular(GltfPart, frozen=True):
    specular_factor: float = 1.0
    specular_texture: TextureInfo | None = None
    specular_color_factor: Vector = _WHITE
    specular_color_texture: TextureInfo | None = None


class _Clearcoat(GltfPart, frozen=True):
    clearcoat_factor: float = 0.0
    clearcoat_texture: TextureInfo | None = None
    clearcoat_roughness_factor: float = 0.0
    clearcoat_roughness_texture: TextureInfo | None = None
    clearcoat_normal_texture: TextureInfo | None = None


class _Sheen(GltfPart, frozen=True):
    sheen_color_factor: Vector = _BLACK
    sheen_color_texture: TextureInfo | None = None
    sheen_roughness_factor: float = 0.0
    sheen_roughness_texture: TextureInfo | None = None


class _Anisotropy(GltfPart, frozen=True):
    anisotropy_strength: float = 0.0
    anisotropy_rotation: float = 0.0
    anisotropy_texture: TextureInfo | None = None


class _Transmission(GltfPart, frozen=True):
    transmission_factor: float = 0.0
    transmission_texture: TextureInfo | None = None


class _Volume(GltfPart, frozen=True):
    thickness_factor: float = 0.0
    thickness_texture: TextureInfo | None = None
    attenuation_distance: float | None = None
    attenuation_color: Vector = _WHITE


class _Iridescence(GltfPart, frozen=True):
    iridescence_factor: float = 0.0
    iridescence_texture: TextureInfo | None = None
    iridescence_ior: float = 1.3
    iridescence_thickness_minimum: float = 100.0
    iridescence_thickness_maximum: float = 400.0
    iridescence_thickness_texture: TextureInfo | None = None


class _Extensions(GltfPart, frozen=True):
    strength: _Strength = field(default=_Strength(), name="KHR_materials_emissive_strength")
    ior: _Ior = field(default=_Ior(), name="KHR_materials_ior")
    specular: _Specular = field(default=_Specular(), name="KHR_materials_specular")
    clearcoat: _Clearcoat = field(default=_Clearcoat(), name="KHR_materials_clearcoat")
    sheen: _Sheen = field(default=_Sheen(), name="KHR_materials_sheen")
    anisotropy: _Anisotropy = field(default=_Anisotropy(), name="KHR_materials_anisotropy")
    transmission: _Transmission = field(default=_Transmission(), name="KHR_materials_transmission")
    volume: _Volume = field(default=_Volume(), name="KHR_materials_volume")
    iridescence: _Iridescence = field(default=_Iridescence(), name="KHR_materials_iridescence")
    unlit: dict[str, Any] | None = field(default=None, name="KHR_materials_unlit")


ImageOf = Callable[[TextureInfo], Image.Image | None]


def emissive_strength(source: GltfMaterial) -> float:
    """Factor of a material's emission."""
    return max(_finite(_extensions(source).strength.emissive_strength, 1.0), 0.0)


def further_textures(source: GltfMaterial) -> dict[str, TextureInfo]:
    """The textures of extensions that are kept texel by texel, by the names of maps."""
    found = _extensions(source)
    named = {
        "specular": found.specular.specular_texture,
        "specular_colour": found.specular.specular_color_texture,
        "clearcoat": found.clearcoat.clearcoat_texture,
        "transmission": found.transmission.transmission_texture,
        "iridescence": found.iridescence.iridescence_texture,
        "iridescence_thickness": found.iridescence.iridescence_thickness_texture,
    }
    return {name: info for name, info in named.items() if info is not None}


def averaged_maps(source: GltfMaterial) -> list[str]:
    """The file's names of those that scale their factor by their mean, or that are left out."""
    found = _extensions(source)
    textures = {
        "clearcoatRoughnessTexture": found.clearcoat.clearcoat_roughness_texture,
        "clearcoatNormalTexture": found.clearcoat.clearcoat_normal_texture,
        "sheenColorTexture": found.sheen.sheen_color_texture,
        "sheenRoughnessTexture": found.sheen.sheen_roughness_texture,
        "anisotropyTexture": found.anisotropy.anisotropy_texture,
        "thicknessTexture": found.volume.thickness_texture,
    }
    return [name for name, info in textures.items() if info is not None]


def bounded_factors(source: GltfMaterial) -> dict[str, Any]:
    """Factors of extensions that belong to [0, 1], by the names that users read."""
    found = _extensions(source)
    return {
        "specular": found.specular.specular_factor,
        "clearcoat": found.clearcoat.clearcoat_factor,
        "clearcoat_roughness": found.clearcoat.clearcoat_roughness_factor,
        "sheen": found.sheen.sheen_color_factor,
        "sheen_roughness": found.sheen.sheen_roughness_factor,
        "anisotropy": found.anisotropy.anisotropy_strength,
        "transmission": found.transmission.transmission_factor,
        "attenuation_colour": found.volume.attenuation_color,
        "iridescence": found.iridescence.iridescence_factor,
    }


def terms_of(source: GltfMaterial, image_of: ImageOf) -> SurfaceTerms:
    """The numbers of a material's extensions, inside their ranges.

    `image_of` decodes a texture's image.
    """
    found = _extensions(source)

    def mean(info: TextureInfo | None, channel: int) -> float:
        image = None if info is None else image_of(info)
        if image is None or len(image.getbands()) <= channel:
            return 1.0
        return float(np.asarray(image)[..., channel].mean() / 255.0)

    clearcoat, sheen, volume, film = (
        found.clearcoat,
        found.sheen,
        found.volume,
        found.iridescence,
    )
    film_most_nm = max(_finite(film.iridescence_thickness_maximum, 400.0), 0.0)
    # Without a map a film is as thick as it may be.
    film_least_nm = (
        film_most_nm
        if film.iridescence_thickness_texture is None
        else max(_finite(film.iridescence_thickness_minimum, 100.0), 0.0)
    )
    tint = 1.0
    if sheen.sheen_color_texture is not None:
        image = image_of(sheen.sheen_color_texture)
        if image is not None:
            tint = np.asarray(image)[..., :3].reshape(-1, 3).mean(axis=0) / 255.0
            tint = tint**2.2
    return SurfaceTerms(
        # 0 is the specification's way to say that nothing goes below the coat.
        ior=float(np.clip(_finite(found.ior.ior, 1.5), 1.0, _MOST_IOR))
        if found.ior.ior
        else _MOST_IOR,
        specular=_share(found.specular.specular_factor),
        specular_rgb=_colour(found.specular.specular_color_factor, most=1e3),
        clearcoat=_share(clearcoat.clearcoat_factor),
        clearcoat_roughness=_share(
            clearcoat.clearcoat_roughness_factor * mean(clearcoat.clearcoat_roughness_texture, 1)
        ),
        sheen_rgb=_colour(np.multiply(sheen.sheen_color_factor, tint)),
        sheen_roughness=_share(
            sheen.sheen_roughness_factor * mean(sheen.sheen_roughness_texture, 3)
        ),
        anisotropy=_share(
            found.anisotropy.anisotropy_strength * mean(found.anisotropy.anisotropy_texture, 2)
        ),
        anisotropy_rad=_finite(found.anisotropy.anisotropy_rotation, 0.0),
        transmission=_share(found.transmission.transmission_factor),
        thickness_m=max(_finite(volume.thickness_factor, 0.0), 0.0)
        * mean(volume.thickness_texture, 1),
        extinction_per_m=_extinction_per_m(volume),
        unlit=float(found.unlit is not None),
        iridescence=_share(film.iridescence_factor),
        film_ior=float(np.clip(_finite(film.iridescence_ior, 1.3), 1.0, 4.0)),
        film_least_nm=film_least_nm,
        film_most_nm=film_most_nm,
    )


def _extinction_per_m(volume: _Volume) -> Vector:
    """The extinction that leaves the colour after the distance; 0 without a distance."""
    distance_m = volume.attenuation_distance
    if distance_m is None or not math.isfinite(distance_m) or distance_m <= 0.0:
        return _BLACK
    left = np.maximum(_colour(volume.attenuation_color), _LEAST_LEFT)
    red, green, blue = np.minimum(-np.log(left) / distance_m, 1e9)
    return float(red), float(green), float(blue)


def _extensions(source: GltfMaterial) -> _Extensions:
    return _decoded(bytes(source.extensions))


@lru_cache(maxsize=4096)
def _decoded(text: bytes) -> _Extensions:
    try:
        return msgspec.json.decode(text, type=_Extensions)
    except msgspec.ValidationError as fault:
        raise SceneFileError(
            f"an extension of a material in it is not valid ({fault}); export it again"
        ) from fault


def _finite(value: float, default: float) -> float:
    return value if math.isfinite(value) else default


def _share(value: float) -> float:
    return float(np.clip(_finite(value, 0.0), 0.0, 1.0))


def _colour(values: Any, most: float = 1.0) -> Vector:
    red, green, blue = np.clip(np.nan_to_num(np.asarray(values, float)), 0.0, most)
    return float(red), float(green), float(blue)

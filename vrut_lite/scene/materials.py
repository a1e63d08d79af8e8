"""Surfaces: metallic-roughness materials with exact factors, from glTF and from OBJ's MTL."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from vrut_lite.messages.scene_content import MAP_NAMES, AlphaMode, Sampler, Wrap
from vrut_lite.messages.surface_terms import SurfaceTerms
from vrut_lite.scene.gltf_file import GltfFile, item_at
from vrut_lite.scene.gltf_schema import GltfMaterial, Texture, TextureInfo
from vrut_lite.scene.gltf_terms import bounded_factors, emissive_strength, terms_of
from vrut_lite.scene.images import Encoded, PixelBudget, decode_image
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.scene_file_error import UnreadFile
from vrut_lite.scene.spec_gloss import roughness_image, spec_gloss_of
from vrut_lite.scene.uv_layers import UvLayer, layers_of, texture_infos

DEFAULT_ALBEDO = 0.5
TOLD_GREY = f"matt grey of {DEFAULT_ALBEDO:g} instead"
# OpenGL's codes, as glTF has them.
_WRAPS: dict[int, Wrap] = {10497: "repeat", 33071: "clamp", 33648: "mirror"}
_NEAREST = 9728
# How many numbers the statements of an MTL have.
_MTL_SIZES = {"kd": 3, "d": 1, "tr": 1, "pm": 1, "pr": 1}


@dataclass(eq=False)
class SurfaceMaterial:
    """A metallic-roughness material in glTF's names, its factors linear and floating point.

    `baseColorFactor` is RGBA (4,) in [0, 1], `emissiveFactor` RGB (3,) from 0. Textures are RGB or
    RGBA images with 8 bits, colour textures sRGB-encoded. `layer_of` maps a texture's name to its
    layer of the mesh's texture coordinates, where a missing name means layer 0, and `sampler_of`
    to its sampler. `further_maps` has those of extensions.
    """

    name: str | None
    baseColorFactor: NDArray[np.float64]
    metallicFactor: float
    roughnessFactor: float
    emissiveFactor: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    alphaMode: AlphaMode = "OPAQUE"
    alphaCutoff: float = 0.5
    doubleSided: bool = False
    baseColorTexture: Image.Image | None = None
    metallicRoughnessTexture: Image.Image | None = None
    normalTexture: Image.Image | None = None
    occlusionTexture: Image.Image | None = None
    emissiveTexture: Image.Image | None = None
    uv_layers: Sequence[UvLayer] = ()
    layer_of: Mapping[str, int] = field(default_factory=dict)
    sampler_of: Mapping[str, Sampler] = field(default_factory=dict)
    further_maps: Mapping[str, Image.Image] = field(default_factory=dict)
    terms: SurfaceTerms = field(default_factory=SurfaceTerms)
    normal_scale: float = 1.0
    occlusion_strength: float = 1.0

    def __post_init__(self) -> None:
        """Keep the base colour and the metallic-roughness factors in their ranges."""
        self.baseColorFactor = np.clip(self.baseColorFactor, 0.0, 1.0, dtype=np.float64)
        self.metallicFactor = float(np.clip(self.metallicFactor, 0.0, 1.0))
        self.roughnessFactor = float(np.clip(self.roughnessFactor, 0.0, 1.0))


def default_material(coloured: bool = False) -> SurfaceMaterial:
    """Matt mid-grey, for a mesh that names no material; white where its vertices have colours.

    glTF's default is a white metal, which shows reflections only.
    """
    albedo = 1.0 if coloured else DEFAULT_ALBEDO
    rgba = np.array([albedo] * 3 + [1.0])
    return SurfaceMaterial("default", rgba, metallicFactor=0.0, roughnessFactor=1.0)


def tell_clipped(notices: Notices, **factors: ArrayLike) -> None:
    """Tell factors of a material that do not lie in [0, 1], to which `SurfaceMaterial` clips."""
    for name, values in factors.items():
        stated = np.asarray(values, float)
        if not ((stated >= 0.0) & (stated <= 1.0)).all():
            notices.tell(f"material whose {name.replace('_', ' ')} is outside 0 to 1", "clipped")


class GltfMaterials:
    """The materials of one glTF file, made when first asked for; shared images decode once.

    All images that textures name are admitted before the first is decoded.
    """

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._keys: dict[int, Hashable] = {}
        self._encoded = self._admitted()
        self._images: dict[Hashable, Image.Image] = {}
        self._materials: dict[int, SurfaceMaterial] = {}

    def material(self, index: int | None, coloured: bool = False) -> SurfaceMaterial:
        """The material of this number, or the default one of a mesh with or without colours."""
        if index is None:
            if not coloured:
                self._file.notices.tell_once("mesh without material", TOLD_GREY)
            return default_material(coloured)
        if index not in self._materials:
            source = item_at(self._file.document.materials, index, "material")
            self._materials[index] = self._convert(source)
        return self._materials[index]

    def _convert(self, source: GltfMaterial) -> SurfaceMaterial:
        pbr = source.pbr_metallic_roughness
        layers, numbers = layers_of(source)
        infos = texture_infos(source)
        further = [name for name in numbers if name in MAP_NAMES]
        tell_clipped(
            self._file.notices,
            base_colour=pbr.base_color_factor,
            metalness=pbr.metallic_factor,
            roughness=pbr.roughness_factor,
            **bounded_factors(source),
        )
        material = SurfaceMaterial(
            name=source.name,
            baseColorFactor=np.array(pbr.base_color_factor),
            metallicFactor=pbr.metallic_factor,
            roughnessFactor=pbr.roughness_factor,
            emissiveFactor=np.maximum(source.emissive_factor, 0.0) * emissive_strength(source),
            alphaMode=source.alpha_mode,
            alphaCutoff=source.alpha_cutoff,
            doubleSided=source.double_sided,
            uv_layers=layers,
            layer_of=numbers,
            sampler_of={name: self._sampler(infos[name]) for name in numbers},
            terms=terms_of(source, self._texture),
        )
        for name in numbers:
            if name not in further:
                setattr(material, name, self._texture(infos[name]))
        gloss = spec_gloss_of(source)
        if gloss is not None and material.metallicRoughnessTexture is not None:
            material.metallicRoughnessTexture = roughness_image(
                material.metallicRoughnessTexture, gloss.glossiness_factor
            )
        maps = {name: self._texture(infos[name]) for name in further}
        material.further_maps = {name: image for name, image in maps.items() if image is not None}
        if source.normal_texture is not None:
            material.normal_scale = source.normal_texture.scale
        if source.occlusion_texture is not None:
            material.occlusion_strength = source.occlusion_texture.strength
        return material

    def _texture(self, info: TextureInfo) -> Image.Image | None:
        texture = item_at(self._file.document.textures, info.index, "texture")
        index = _image_index(texture)
        if index is None or index not in self._keys:
            return None
        key = self._keys[index]
        if key not in self._images:
            self._images[key] = decode_image(self._encoded.pop(key), f"number {index}")
        return self._images[key]

    def _sampler(self, info: TextureInfo) -> Sampler:
        texture = item_at(self._file.document.textures, info.index, "texture")
        if texture.sampler is None:
            return Sampler()
        found = item_at(self._file.document.samplers, texture.sampler, "sampler")
        wrap_u, wrap_v = (_WRAPS.get(code, "repeat") for code in (found.wrap_s, found.wrap_t))
        return Sampler(wrap_u, wrap_v, found.mag_filter == _NEAREST)

    def _admitted(self) -> dict[Hashable, Encoded]:
        """The distinct encoded images by key; sets `_keys`, the key of each image number."""
        document, memory = self._file.document, self._file.folder.budget
        pixels = PixelBudget(memory)
        encoded: dict[Hashable, Encoded] = {}
        for texture in document.textures:
            index = _image_index(texture)
            if index is None or index in self._keys:
                continue
            image = item_at(document.images, index, "image")
            try:
                key, data = self._file.image_source(image)
            except UnreadFile as fault:
                self._file.notices.tell(f"picture {image.uri}", f"{fault.why}, left out")
                continue
            if key not in encoded:
                memory.ask(len(data), f"the image number {index}")
                pixels.admit(data, f"number {index}")
                encoded[key] = data
            self._keys[index] = key
        return encoded


def _image_index(texture: Texture) -> int | None:
    """The image to take: a KTX 2 picture only where the file has no other."""
    webp, basis = texture.extensions.webp, texture.extensions.basis
    if webp is not None:
        return webp.source
    return texture.source if texture.source is not None or basis is None else basis.source


def from_mtl(
    name: str,
    statements: Mapping[str, Sequence[str]],
    image: Image.Image | None,
    coloured: bool = False,
) -> SurfaceMaterial:
    """Metallic-roughness from the statements of an MTL file, in lower case, and map_Kd's image.

    Without Kd it is white where a picture or the vertices (`coloured`) have the colour, else grey.

    Kd is the base colour, a metal's only if the file says so (Pm). Ns, the exponent of
    Blinn-Phong, becomes a roughness r with r^4 = 2 / (Ns + 2) (Karis 2013, alpha = r^2); Pr
    sets it outright. d, or 1 - Tr, is the alpha; `Tr 1` alone is opaque, for MeshLab writes it so.
    An image with an alpha channel cuts out.
    OBJ has no back faces: materials are double-sided.
    """

    def numbers(word: str, size: int, default: float) -> list[float]:
        return _numbers(statements.get(word, ()), size, default)

    colour = numbers("kd", 3, 1.0 if coloured or image is not None else DEFAULT_ALBEDO)
    (transparency,) = numbers("tr", 1, 0.0)
    (alpha,) = numbers("d", 1, 1.0 - transparency if transparency < 1.0 else 1.0)
    (glossiness,) = numbers("ns", 1, 0.0)
    cut_out = image is not None and image.mode == "RGBA"
    return SurfaceMaterial(
        name=name,
        baseColorFactor=np.array([*colour, alpha]),
        baseColorTexture=image,
        metallicFactor=numbers("pm", 1, 0.0)[0],
        roughnessFactor=numbers("pr", 1, (2.0 / (glossiness + 2.0)) ** 0.25)[0],
        emissiveFactor=np.array(numbers("ke", 3, 0.0)),
        alphaMode="BLEND" if alpha < 1.0 else "MASK" if cut_out else "OPAQUE",
        doubleSided=True,
    )


def tell_mtl(statements: Mapping[str, Sequence[str]], notices: Notices) -> None:
    """Tell what `from_mtl` changes of the statements of a material that has them."""
    stated = {word: _stated(statements.get(word, ()), size) for word, size in _MTL_SIZES.items()}
    if stated["kd"] is None and "kd" in statements:
        notices.tell("material whose Kd is no RGB", "as without Kd")
    if stated["d"] is None and (stated["tr"] or [0.0])[0] >= 1.0:
        notices.tell("material of `Tr 1` without `d`", "opaque, as MeshLab means it")
    if stated["d"] is not None and stated["d"][0] <= 0.0:
        notices.tell("material of `d 0`", "not seen")
    named = {"Kd": "kd", "Pm": "pm", "Pr": "pr", "d": "d"}
    tell_clipped(notices, **{name: stated[word] or 0.0 for name, word in named.items()})


def _numbers(words: Sequence[str], size: int, default: float) -> list[float]:
    """`size` finite numbers of an MTL statement, one repeated; the default without numbers."""
    numbers = _stated(words, size)
    return [default] * size if numbers is None else [max(number, 0.0) for number in numbers]


def _stated(words: Sequence[str], size: int) -> list[float] | None:
    """Unclamped numbers of a statement; None if they are not numbers."""
    try:
        numbers = [float(word) for word in words[:size]]
    except ValueError:
        return None
    if len(numbers) == 1:
        numbers *= size
    return numbers if len(numbers) == size and bool(np.all(np.isfinite(numbers))) else None

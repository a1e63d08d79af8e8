"""Materials as glTF writes them: factors, textures, and KHR_materials_* of their terms."""

from typing import Any

import numpy as np

from vrut_lite.messages.scene_content import MapName, Material, MaterialMap, Wrap
from vrut_lite.messages.surface_terms import SurfaceTerms
from vrut_lite.scene.glb_document import GlbDocument

_WRAP: dict[Wrap, int] = {"repeat": 10497, "clamp": 33071, "mirror": 33648}
_NEAREST, _LINEAR, _MIPMAPPED = 9728, 9729, 9987
_DEFAULT = SurfaceTerms()


class GlbMaterials:
    """Adds materials to a document; images that they share are added once."""

    def __init__(self, document: GlbDocument):
        self._document = document
        self._images: dict[tuple[Any, ...], int] = {}
        self._samplers: dict[tuple[int, int, int], int] = {}
        self._textures: dict[tuple[int, int], int] = {}

    def add(self, material: Material) -> int:
        """Add a material."""
        maps = material.maps
        rough: dict[str, Any] = {
            "baseColorFactor": _numbers(material.base_colour_rgba),
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
            **self._maybe("baseColorTexture", maps.get("base_colour")),
            **self._maybe("metallicRoughnessTexture", maps.get("metallic_roughness")),
        }
        made: dict[str, Any] = {
            "name": material.name,
            "pbrMetallicRoughness": rough,
            "doubleSided": material.double_sided,
            "alphaMode": material.alpha_mode,
            **self._maybe("normalTexture", maps.get("normal"), scale=material.normal_scale),
            **self._maybe(
                "occlusionTexture", maps.get("occlusion"), strength=material.occlusion_strength
            ),
            **self._maybe("emissiveTexture", maps.get("emission")),
        }
        if material.alpha_mode == "MASK":
            made["alphaCutoff"] = material.alpha_cutoff
        extensions = self._terms(material)
        # A factor lies in [0, 1]; the extension multiplies it for brighter emission.
        strength = max(float(np.max(material.emission_rgb)), 1.0)
        if np.any(material.emission_rgb > 0.0):
            made["emissiveFactor"] = _numbers(material.emission_rgb / strength)
        if strength > 1.0:
            extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
        if extensions:
            made["extensions"] = extensions
        for name in extensions:
            self._document.use(name)
        return self._document.add("materials", made)

    def _terms(self, material: Material) -> dict[str, Any]:
        """The extensions of the terms that differ from glTF's core material."""
        terms = material.terms
        if terms.unlit:
            return {"KHR_materials_unlit": {}}

        def texture(name: str, kind: MapName) -> dict[str, Any]:
            return self._maybe(name, material.maps.get(kind))

        parts = {
            "KHR_materials_ior": _without_defaults(terms, {"ior": "ior"}),
            "KHR_materials_specular": {
                **_without_defaults(
                    terms, {"specular": "specularFactor", "specular_rgb": "specularColorFactor"}
                ),
                **texture("specularTexture", "specular"),
                **texture("specularColorTexture", "specular_colour"),
            },
            "KHR_materials_clearcoat": {
                **_without_defaults(
                    terms,
                    {
                        "clearcoat": "clearcoatFactor",
                        "clearcoat_roughness": "clearcoatRoughnessFactor",
                    },
                ),
                **texture("clearcoatTexture", "clearcoat"),
            },
            "KHR_materials_sheen": _without_defaults(
                terms, {"sheen_rgb": "sheenColorFactor", "sheen_roughness": "sheenRoughnessFactor"}
            ),
            "KHR_materials_anisotropy": _without_defaults(
                terms, {"anisotropy": "anisotropyStrength", "anisotropy_rad": "anisotropyRotation"}
            ),
            "KHR_materials_transmission": {
                **_without_defaults(terms, {"transmission": "transmissionFactor"}),
                **texture("transmissionTexture", "transmission"),
            },
            "KHR_materials_volume": _volume(terms),
            "KHR_materials_iridescence": self._film(material),
        }
        return {name: part for name, part in parts.items() if part}

    def _film(self, material: Material) -> dict[str, Any]:
        """KHR_materials_iridescence: whole, or empty without a film."""
        terms = material.terms
        if terms.iridescence == 0.0:
            return {}
        film = {
            "iridescenceFactor": terms.iridescence,
            "iridescenceIor": terms.film_ior,
            "iridescenceThicknessMaximum": terms.film_most_nm,
            **self._maybe("iridescenceTexture", material.maps.get("iridescence")),
        }
        thickness = material.maps.get("iridescence_thickness")
        if thickness is not None:
            film["iridescenceThicknessMinimum"] = terms.film_least_nm
            film |= self._maybe("iridescenceThicknessTexture", thickness)
        return film

    def _maybe(self, name: str, found: MaterialMap | None, **factors: float) -> dict[str, Any]:
        """A reference to a map's texture by its name in glTF; empty without a map."""
        if found is None:
            return {}
        reference = {"index": self._texture(found), "texCoord": found.uv_layer}
        return {name: reference | factors}

    def _texture(self, found: MaterialMap) -> int:
        texels = np.ascontiguousarray(found.texels)
        # Images are views of the scene's one array: their address identifies them.
        key = (texels.__array_interface__["data"][0], texels.shape)
        if key not in self._images:
            self._images[key] = self._document.image(texels)
        wrapped = found.sampler
        codes = (
            _WRAP[wrapped.wrap_u], _WRAP[wrapped.wrap_v], _NEAREST if wrapped.nearest else _LINEAR,
        )  # fmt: skip
        if codes not in self._samplers:
            names = ("wrapS", "wrapT", "magFilter")
            sampler = dict(zip(names, codes, strict=True)) | {"minFilter": _MIPMAPPED}
            self._samplers[codes] = self._document.add("samplers", sampler)
        pair = self._images[key], self._samplers[codes]
        if pair not in self._textures:
            texture = {"source": pair[0], "sampler": pair[1]}
            self._textures[pair] = self._document.add("textures", texture)
        return self._textures[pair]


def _without_defaults(terms: SurfaceTerms, names: dict[str, str]) -> dict[str, Any]:
    """Terms by their names in glTF, of those that are not the default."""
    return {
        theirs: list(value) if isinstance(value, tuple) else value
        for ours, theirs in names.items()
        if (value := getattr(terms, ours)) != getattr(_DEFAULT, ours)
    }


def _volume(terms: SurfaceTerms) -> dict[str, Any]:
    """KHR_materials_volume: the colour that is left after the depth of the strongest channel."""
    volume = _without_defaults(terms, {"thickness_m": "thicknessFactor"})
    strongest = max(terms.extinction_per_m)
    if strongest > 0.0:
        volume["attenuationDistance"] = 1.0 / strongest
        volume["attenuationColor"] = _numbers(np.exp(-np.divide(terms.extinction_per_m, strongest)))
    return volume


def _numbers(values: Any) -> list[float]:
    return [float(value) for value in values]

"""A scene as one GLB: quantised vertices packed by meshoptimizer, textures as WebP.

glTF 2.0 with KHR_mesh_quantization, EXT_texture_webp and, where the Python package meshopt is
there, EXT_meshopt_compression. Meshes have TEXCOORD_0, and places in the light map as `_LIGHT`.
Any viewer of glTF that knows these extensions opens it, without the light.
"""

import io
import json
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from share.scene_mesh import GROUND, MeshGroup
from share.t_junctions import without_t_junctions
from vrut_lite.lazy import lazy
from vrut_lite.messages.scene_content import Material, MaterialMap
from vrut_lite.numeric_types import Float32Array, FloatArray

_meshopt = lazy("meshopt")

_FLOAT, _USHORT, _UINT, _SHORT, _UBYTE = 5126, 5123, 5125, 5122, 5121
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_WRAP = {"repeat": 10497, "clamp": 33071, "mirror": 33648}
_WEBP_QUALITY = 88
# Edge (texels) beyond which textures are halved.
MOST_TEXTURE_PX = 2048


def has_meshopt() -> bool:
    """Whether buffers can be packed."""
    try:
        _meshopt.load()
    except ImportError:
        return False
    return True


def glb_of(
    groups: Sequence[MeshGroup], materials: Sequence[Material], ground_rgb: Sequence[float]
) -> bytes:
    """The bytes of a GLB of groups; `ground_rgb` is the albedo of the ground disc."""
    writer = _Writer(packs=has_meshopt())
    for material in materials:
        writer.material(material)
    writer.ground(ground_rgb)
    # One lattice for all, so that surfaces which touch still do.
    meshes = [group for group in groups if group.material != GROUND]
    places = [group.positions_m for group in meshes]
    lower = np.min([part.min(axis=0) for part in places], axis=0).astype(float)
    upper = np.max([part.max(axis=0) for part in places], axis=0).astype(float)
    step = np.maximum(upper - lower, 1e-6) / 65535.0
    meshes = without_t_junctions(meshes, float(step.max()))
    for group in [*meshes, *(group for group in groups if group.material == GROUND)]:
        writer.group(group, len(materials), lower, step)
    return writer.bytes()


class _Writer:
    """Collects buffers and the parts of a glTF document."""

    def __init__(self, packs: bool):
        self._packs = packs
        self._binary = bytearray()
        self._views: list[dict[str, Any]] = []
        self._unpacked = 0
        self._images: dict[int, int] = {}
        self._document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "vrut_lite share"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "accessors": [],
            "materials": [],
            "textures": [],
            "images": [],
            "samplers": [],
        }

    # --- materials ----------------------------------------------------------------------------

    def material(self, material: Material) -> None:
        """Add a material; what glTF's core lacks lies in its extras."""
        maps, terms = material.maps, material.terms
        rough: dict[str, Any] = {
            "baseColorFactor": [float(v) for v in material.base_colour_rgba],
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        }
        made: dict[str, Any] = {
            "name": material.name,
            "pbrMetallicRoughness": rough,
            "doubleSided": material.double_sided,
            "alphaMode": material.alpha_mode,
            "extras": {
                "emission_cd": [float(v) for v in material.emission_rgb],
                "f0": [float(v) for v in terms.f0_rgb],
                "f90": float(terms.f90),
                "transmission": float(terms.transmission),
                "unlit": float(terms.unlit),
                "clearcoat": float(terms.clearcoat),
                "clearcoat_roughness": float(terms.clearcoat_roughness),
            },
        }
        if material.alpha_mode == "MASK":
            made["alphaCutoff"] = material.alpha_cutoff
        if "base_colour" in maps:
            rough["baseColorTexture"] = self._texture(maps["base_colour"])
        if "metallic_roughness" in maps:
            rough["metallicRoughnessTexture"] = self._texture(maps["metallic_roughness"])
        if "normal" in maps:
            scale = {"scale": material.normal_scale}
            made["normalTexture"] = self._texture(maps["normal"]) | scale
        if "occlusion" in maps:
            strength = {"strength": material.occlusion_strength}
            made["occlusionTexture"] = self._texture(maps["occlusion"]) | strength
        if "emission" in maps:
            made["emissiveTexture"] = self._texture(maps["emission"])
        self._document["materials"].append(made)

    def ground(self, albedo_rgb: Sequence[float]) -> None:
        """Add the ground disc's material."""
        self._document["materials"].append(
            {
                "name": "open ground",
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*map(float, albedo_rgb), 1.0],
                    "metallicFactor": 0.0,
                    "roughnessFactor": 1.0,
                },
                "extras": {"ground": 1},
            }
        )

    def _texture(self, found: MaterialMap) -> dict[str, Any]:
        texels = np.ascontiguousarray(found.texels)
        key = texels.__array_interface__["data"][0]
        if key not in self._images:
            self._images[key] = len(self._document["images"])
            picture = Image.fromarray(texels)
            while max(picture.size) > MOST_TEXTURE_PX:
                picture = picture.resize((picture.width // 2 or 1, picture.height // 2 or 1))
            target = io.BytesIO()
            picture.save(target, "WEBP", quality=_WEBP_QUALITY, method=4)
            view = self._view(target.getvalue())
            self._document["images"].append({"bufferView": view, "mimeType": "image/webp"})
        sampler = {
            "wrapS": _WRAP[found.sampler.wrap_u],
            "wrapT": _WRAP[found.sampler.wrap_v],
            "magFilter": 9728 if found.sampler.nearest else 9729,
            "minFilter": 9987,
        }
        samplers = self._document["samplers"]
        if sampler not in samplers:
            samplers.append(sampler)
        texture = {
            "sampler": samplers.index(sampler),
            "extensions": {"EXT_texture_webp": {"source": self._images[key]}},
        }
        textures = self._document["textures"]
        if texture not in textures:
            textures.append(texture)
        return {"index": textures.index(texture), "texCoord": found.uv_layer}

    # --- meshes -------------------------------------------------------------------------------

    def group(self, group: MeshGroup, ground: int, lower: FloatArray, step: FloatArray) -> None:
        """Add a mesh and its node, which undoes the quantisation: lower + whole numbers * step."""
        if group.material == GROUND:
            # Metres would be lost beside its kilometres.
            lower, step, places = np.zeros(3), np.ones(3), group.positions_m
        else:
            places = np.rint((group.positions_m - lower) / step).astype(np.uint16)
        attributes = {
            "POSITION": self._accessor(_padded(places), 3, bounds=True),
            "NORMAL": self._accessor(_normals(group.normals), 3, normalized=True),
        }
        if group.uv is not None:
            attributes["TEXCOORD_0"] = self._accessor(_flipped(group.uv), 2)
        if group.second_uv is not None:
            attributes["TEXCOORD_1"] = self._accessor(_flipped(group.second_uv), 2)
        if group.light_px is not None:
            attributes["_LIGHT"] = self._accessor(group.light_px.astype(np.float32), 2)
        if group.colours is not None:
            colours = np.rint(np.clip(group.colours, 0.0, 1.0) * 255.0).astype(np.uint8)
            attributes["COLOR_0"] = self._accessor(colours, 4, normalized=True)
        material = ground if group.material == GROUND else group.material
        primitive = {
            "attributes": attributes,
            "indices": self._indices(group.triangles),
            "material": material,
        }
        self._document["meshes"].append({"primitives": [primitive]})
        node: dict[str, Any] = {
            "mesh": len(self._document["meshes"]) - 1,
            "translation": lower.tolist(),
            "scale": step.tolist(),
        }
        if group.mirror is not None:
            node["extras"] = {"mirror": group.mirror}
        self._document["nodes"].append(node)
        self._document["scenes"][0]["nodes"].append(len(self._document["nodes"]) - 1)

    def _accessor(
        self, values: NDArray, components: int, normalized: bool = False, bounds: bool = False
    ) -> int:
        kinds = {"f": _FLOAT, "u": _USHORT if values.itemsize == 2 else _UBYTE, "i": _SHORT}
        accessor: dict[str, Any] = {
            "bufferView": self._view(values.tobytes(), values, "ATTRIBUTES"),
            "componentType": kinds[values.dtype.kind],
            "count": len(values),
            "type": _TYPES[components],
        }
        if normalized:
            accessor["normalized"] = True
        if bounds:
            accessor["min"] = values[:, :components].min(axis=0).tolist()
            accessor["max"] = values[:, :components].max(axis=0).tolist()
        self._document["accessors"].append(accessor)
        return len(self._document["accessors"]) - 1

    def _indices(self, triangles: NDArray[np.uint32]) -> int:
        flat = np.ascontiguousarray(triangles.ravel(), np.uint32)
        self._document["accessors"].append(
            {
                "bufferView": self._view(flat.tobytes(), flat, "TRIANGLES"),
                "componentType": _UINT,
                "count": len(flat),
                "type": "SCALAR",
            }
        )
        return len(self._document["accessors"]) - 1

    def _view(self, plain: bytes, values: NDArray | None = None, mode: str = "") -> int:
        """Add bytes, packed where they are values of vertices or triangles."""
        view: dict[str, Any] = {"buffer": 0}
        if values is not None and values.ndim > 1:
            view["byteStride"] = values.shape[1] * values.itemsize
        packed = plain
        if values is not None and self._packs:
            stride = view.get("byteStride", values.itemsize)
            packed = _meshopt.encode_gltf_buffer(values, mode)
            view["extensions"] = {
                "EXT_meshopt_compression": {
                    "buffer": 0,
                    "byteOffset": len(self._binary),
                    "byteLength": len(packed),
                    "byteStride": stride,
                    "count": len(values),
                    "mode": mode,
                }
            }
            view |= {"buffer": 1, "byteOffset": self._unpacked, "byteLength": len(plain)}
            self._unpacked += _aligned(len(plain))
        else:
            view |= {"byteOffset": len(self._binary), "byteLength": len(plain)}
        self._binary += packed + bytes(_aligned(len(packed)) - len(packed))
        self._views.append(view)
        return len(self._views) - 1

    def bytes(self) -> bytes:
        """The GLB."""
        needed = ["KHR_mesh_quantization"]
        buffers: list[dict[str, Any]] = [{"byteLength": len(self._binary)}]
        if self._packs:
            needed.append("EXT_meshopt_compression")
            fallback = {"EXT_meshopt_compression": {"fallback": True}}
            buffers.append({"byteLength": self._unpacked, "extensions": fallback})
        if self._document["textures"]:
            needed.append("EXT_texture_webp")
        document = {name: part for name, part in self._document.items() if part != []}
        document |= {
            "extensionsUsed": needed,
            "extensionsRequired": needed,
            "bufferViews": self._views,
            "buffers": buffers,
        }
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (_aligned(len(text)) - len(text))
        length = 12 + 8 + len(text) + 8 + len(self._binary)
        return b"".join(
            (
                struct.pack("<4sII", b"glTF", 2, length),
                struct.pack("<I4s", len(text), b"JSON"),
                text,
                struct.pack("<I4s", len(self._binary), b"BIN\0"),
                bytes(self._binary),
            )
        )


def _aligned(length: int) -> int:
    return (length + 3) // 4 * 4


def _padded(values: NDArray) -> NDArray:
    """Rows (n, 3) padded to a multiple of four bytes."""
    if values.itemsize % 4 == 0:
        return np.ascontiguousarray(values)
    return np.ascontiguousarray(np.pad(values, ((0, 0), (0, 1))))


def _normals(normals: Float32Array) -> NDArray[np.int16]:
    """Unit vectors (n, 3) in 16 bits (n, 4)."""
    return _padded(np.rint(np.clip(normals, -1.0, 1.0) * 32767.0).astype(np.int16))


def _flipped(uv: Float32Array) -> Float32Array:
    """Texture coordinates with v downwards, as glTF has them."""
    return np.stack([uv[:, 0], 1.0 - uv[:, 1]], axis=1).astype(np.float32)

"""A small glTF 2.0 writer that makes the same bytes each time."""

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite_lab.scenes.shapes import PlainMesh

_FLOAT, _SHORT, _SIGNED_BYTE, _BYTE = 5126, 5123, 5120, 5121
_VERTICES, _INDICES = 34962, 34963
_DECIMALS = 5


class GltfWriter:
    """Collects materials, meshes, nodes and a camera; ends in a GLB or a glTF with its buffer."""

    def __init__(self) -> None:
        self._binary = b""
        self._stored: dict[tuple[int, bytes], int] = {}
        self._document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "vrut_lite scenes/build_scenes.py"},
            "scene": 0,
            "scenes": [{"nodes": []}],
        }

    def material(
        self,
        name: str,
        albedo: ArrayLike,
        *,
        roughness: float = 1.0,
        metallic: float = 0.0,
        texture: str | None = None,
        emissive: ArrayLike | None = None,
        alpha: float = 1.0,
        double_sided: bool = False,
    ) -> int:
        """A material of linear base colour (3,), blended where its alpha is below 1.

        A texture is a file beside the scene.
        """
        pbr: dict[str, Any] = {
            "baseColorFactor": [*(float(value) for value in np.asarray(albedo)), alpha],
            "metallicFactor": metallic,
            "roughnessFactor": roughness,
        }
        if texture is not None:
            image = self._add("images", {"uri": texture})
            pbr["baseColorTexture"] = {"index": self._add("textures", {"source": image})}
        material: dict[str, Any] = {"name": name, "pbrMetallicRoughness": pbr}
        if emissive is not None:
            material["emissiveFactor"] = [float(value) for value in np.asarray(emissive)]
        if alpha < 1.0:
            material["alphaMode"] = "BLEND"
        if double_sided:
            material["doubleSided"] = True
        return self._add("materials", material)

    def mesh(self, name: str, parts: list[tuple[PlainMesh, int]]) -> int:
        """A mesh of shapes with their materials."""
        primitives = [self._primitive(shape, material) for shape, material in parts]
        return self._add("meshes", {"name": name, "primitives": primitives})

    def tiled_material(self, name: str, grain: bytes, bumps: bytes, side: float) -> int:
        """A matt material for `painted_mesh`: PNGs of grain and normals, repeated.

        `side` is their side in texture coordinates.
        """
        self._use("KHR_texture_transform")
        once = 1.0 / side
        maps = [
            {"index": self._embedded(png), "extensions": {
                "KHR_texture_transform": {"scale": [once, once]}}}
            for png in (grain, bumps)
        ]  # fmt: skip
        pbr = {"baseColorTexture": maps[0], "metallicFactor": 0.0, "roughnessFactor": 1.0}
        return self._add(
            "materials", {"name": name, "pbrMetallicRoughness": pbr, "normalTexture": maps[1]}
        )

    def painted_mesh(
        self, name: str, shape: PlainMesh, colours: NDArray[np.float64], material: int
    ) -> int:
        """A mesh in few bytes, with a linear colour (V, 3) in [0, 1] at each vertex.

        Positions and texture coordinates are stored as whole numbers of 16 bits, normals and
        colours in 8 bits a number (KHR_mesh_quantization).
        """
        self._use("KHR_mesh_quantization")
        attributes = {
            "POSITION": self._packed(shape.positions, "<u2", bounds=True),
            "NORMAL": self._packed(np.round(127.0 * shape.normals), "i1"),
            "COLOR_0": self._packed(np.round(255.0 * colours), "u1"),
        }
        if len(shape.uv):
            attributes["TEXCOORD_0"] = self._packed(shape.uv, "<u2")
        primitive = {
            "attributes": attributes, "indices": self._indices(shape.faces), "material": material
        }  # fmt: skip
        return self._add("meshes", {"name": name, "primitives": [primitive]})

    def place(
        self,
        name: str,
        mesh: int,
        at: tuple[float, float, float] = (0.0, 0.0, 0.0),
        scale: tuple[float, float, float] = (1.0, 1.0, 1.0),
        azimuth_deg: float = 0.0,
    ) -> None:
        """Put a mesh into the scene, scaled, then turned clockwise seen from above, then moved."""
        half = np.radians(-azimuth_deg) / 2.0
        rotation = [0.0, _rounded(np.sin(half)), 0.0, _rounded(np.cos(half))]
        self._root(
            {
                "name": name,
                "mesh": mesh,
                "translation": list(at),
                "rotation": rotation,
                "scale": list(scale),
            }
        )

    def camera(
        self, eye_m: ArrayLike, target_m: ArrayLike, vertical_field_of_view_rad: float
    ) -> None:
        """The view to open the scene with."""
        eye, target = np.asarray(eye_m, float), np.asarray(target_m, float)
        back = (eye - target) / np.linalg.norm(eye - target)
        right = np.cross([0.0, 1.0, 0.0], back)
        right /= np.linalg.norm(right)
        columns = [(right, 0.0), (np.cross(back, right), 0.0), (back, 0.0), (eye, 1.0)]
        matrix = [_rounded(value) for axis, w in columns for value in (*axis, w)]
        lens = {"yfov": vertical_field_of_view_rad, "znear": 0.1, "aspectRatio": 1.6}
        camera = self._add("cameras", {"type": "perspective", "perspective": lens})
        self._root({"name": "view", "camera": camera, "matrix": matrix})

    def glb(self) -> bytes:
        """The scene as one binary file (glTF 2.0, section 4)."""
        text = self._json(None)
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self._binary)
        return (
            struct.pack("<4sII", b"glTF", 2, size)
            + struct.pack("<I4s", len(text), b"JSON")
            + text
            + struct.pack("<I4s", len(self._binary), b"BIN\0")
            + self._binary
        )

    def gltf(self, buffer_name: str) -> tuple[bytes, bytes]:
        """The document and the buffer, which is to be saved under the given name."""
        return self._json(buffer_name), self._binary

    def _json(self, buffer_name: str | None) -> bytes:
        buffer: dict[str, Any] = {"byteLength": len(self._binary)}
        if buffer_name is not None:
            buffer["uri"] = buffer_name
        document = {**self._document, "buffers": [buffer]}
        return json.dumps(document, separators=(",", ":")).encode()

    def _primitive(self, shape: PlainMesh, material: int) -> dict[str, Any]:
        return {
            "attributes": {
                "POSITION": self._array(shape.positions, "VEC3", bounds=True),
                "NORMAL": self._array(shape.normals, "VEC3"),
                "TEXCOORD_0": self._array(shape.uv, "VEC2"),
            },
            "indices": self._indices(shape.faces),
            "material": material,
        }

    def _array(self, values: NDArray[np.float64], kind: str, *, bounds: bool = False) -> int:
        # Rounded, so that the last bit of a sine, which machines differ in, does not show.
        data = (np.round(values, _DECIMALS) + 0.0).astype("<f4")
        accessor = {"componentType": _FLOAT, "count": len(data), "type": kind}
        if bounds:
            accessor["min"], accessor["max"] = data.min(axis=0).tolist(), data.max(axis=0).tolist()
        return self._accessor(accessor, data.tobytes(), _VERTICES)

    def _packed(self, values: NDArray[np.float64], kind: str, *, bounds: bool = False) -> int:
        """Whole numbers (V, 2 or 3), each row filled up to whole words."""
        rows, dtype = values.astype(kind), np.dtype(kind)
        accessor: dict[str, Any] = {
            "componentType": {"u2": _SHORT, "i1": _SIGNED_BYTE, "u1": _BYTE}[dtype.str[1:]],
            "count": len(rows), "type": f"VEC{rows.shape[1]}", "normalized": dtype.itemsize == 1,
        }  # fmt: skip
        if bounds:
            accessor["min"], accessor["max"] = rows.min(axis=0).tolist(), rows.max(axis=0).tolist()
        fill = -rows.shape[1] % (4 // dtype.itemsize)
        rows = np.pad(rows, ((0, 0), (0, fill)))
        return self._accessor(accessor, rows.tobytes(), _VERTICES, rows.shape[1] * dtype.itemsize)

    def _embedded(self, png: bytes) -> int:
        """A texture of an image within the binary."""
        view = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(png)}
        self._binary += png + b"\0" * (-len(png) % 4)
        image = {"bufferView": self._add("bufferViews", view), "mimeType": "image/png"}
        return self._add("textures", {"source": self._add("images", image)})

    def _use(self, extension: str) -> None:
        for key in ("extensionsUsed", "extensionsRequired"):
            names = self._document.setdefault(key, [])
            if extension not in names:
                names.append(extension)

    def _indices(self, faces: NDArray[np.int64]) -> int:
        data = faces.reshape(-1).astype("<u2")
        accessor = {"componentType": _SHORT, "count": data.size, "type": "SCALAR"}
        return self._accessor(accessor, data.tobytes(), _INDICES)

    def _accessor(self, accessor: dict[str, Any], data: bytes, target: int, stride: int = 0) -> int:
        """The accessor of these bytes; equal bytes are stored once."""
        if (target, data) not in self._stored:
            view = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(data)}
            self._binary += data + b"\0" * (-len(data) % 4)
            layout = {"byteStride": stride} if stride else {}
            accessor["bufferView"] = self._add("bufferViews", {**view, **layout, "target": target})
            self._stored[target, data] = self._add("accessors", accessor)
        return self._stored[target, data]

    def _root(self, node: dict[str, Any]) -> None:
        self._document["scenes"][0]["nodes"].append(self._add("nodes", node))

    def _add(self, kind: str, item: dict[str, Any]) -> int:
        items = self._document.setdefault(kind, [])
        items.append(item)
        return len(items) - 1


def _rounded(value: float) -> float:
    return round(float(value), 7) + 0.0

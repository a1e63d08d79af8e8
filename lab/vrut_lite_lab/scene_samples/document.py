"""A glTF document in the making: floor, ball and panel, and what a sample adds to them."""

import io
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from vrut_lite_lab.scenes.shapes import PlainMesh, box, sphere

_KINDS = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
BALL_AT, PANEL_AT = (-0.75, 0.55, 0.0), (0.75, 0.6, 0.0)
PANEL = np.array([[-0.55, -0.55, 0], [0.55, -0.55, 0], [0.55, 0.55, 0], [-0.55, 0.55, 0]])
PANEL_UV = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float)
_LEAN = [-0.12, 0.0, 0.0, 0.9928]
QUAD = np.array([0, 1, 2, 0, 2, 3])


class Document:
    """Accessors, images, materials, meshes and nodes by number; `json` is the document itself."""

    def __init__(self) -> None:
        self._binary = bytearray()
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}],
            **{name: [] for name in ("accessors", "bufferViews", "meshes", "nodes", "materials")},
        }  # fmt: skip

    def add(self, kind: str, value: dict[str, Any]) -> int:
        """Append to a list of the document; its number."""
        found = self.json.setdefault(kind, [])
        found.append(value)
        return len(found) - 1

    def view(self, data: bytes) -> int:
        """A buffer view of these bytes."""
        self._binary += b"\0" * (-len(self._binary) % 4)
        at = len(self._binary)
        self._binary += data
        return self.add("bufferViews", {"buffer": 0, "byteOffset": at, "byteLength": len(data)})

    def array(self, values: ArrayLike, dtype: str = "<f4", **more: Any) -> int:
        """An accessor of rows (n, columns), or of numbers (n,)."""
        stored = np.asarray(values).astype(dtype)
        columns = 1 if stored.ndim == 1 else int(np.prod(stored.shape[1:]))
        accessor = {
            "bufferView": self.view(stored.tobytes()),
            "componentType": _KINDS[stored.dtype.char],
            "count": len(stored),
            "type": _TYPES[columns],
        }
        return self.add("accessors", {**accessor, **more})

    def texture(self, pixels: ArrayLike, format: str = "PNG", **sampler: Any) -> dict[str, int]:
        """A texture's info of pixels (h, w, 3 or 4) in 8 bits."""
        packed = io.BytesIO()
        Image.fromarray(np.asarray(pixels, np.uint8)).save(packed, format)
        view = self.view(packed.getvalue())
        mime = f"image/{format.lower()}"
        image = self.add("images", {"bufferView": view, "mimeType": mime})
        texture: dict[str, Any] = {"source": image}
        if sampler:
            texture["sampler"] = self.add("samplers", sampler)
        return {"index": self.add("textures", texture)}

    def material(
        self, colour: ArrayLike = (0.6, 0.6, 0.6), rough: float = 0.5, metal: float = 0.0,
        *, alpha: float = 1.0, khr: dict[str, Any] | None = None, pbr: dict[str, Any] | None = None,
        **more: Any,
    ) -> int:  # fmt: skip
        """A material; `khr` are KHR_materials_* by their last words, `more` its other fields."""
        base = {
            "baseColorFactor": [*np.asarray(colour, float).tolist(), alpha],
            "roughnessFactor": rough,
            "metallicFactor": metal,
        }
        named = {f"KHR_materials_{name}": value for name, value in (khr or {}).items()}
        for name in named:
            self.uses(name)
        made = {"pbrMetallicRoughness": {**base, **(pbr or {})}, "extensions": named, **more}
        return self.add("materials", made)

    def uses(self, extension: str, required: bool = False) -> None:
        """Name an extension."""
        for kind in ("extensionsUsed", *(("extensionsRequired",) if required else ())):
            found = self.json.setdefault(kind, [])
            if extension not in found:
                found.append(extension)

    def mesh(self, shape: PlainMesh, material: int, **more: Any) -> int:
        """A mesh of one primitive."""
        attributes = {
            "POSITION": self.array(shape.positions),
            "NORMAL": self.array(shape.normals),
            "TEXCOORD_0": self.array(shape.uv),
        }
        primitive = {"attributes": attributes, "material": material,
                     "indices": self.array(shape.faces.reshape(-1), "<u4"), **more}  # fmt: skip
        return self.add("meshes", {"primitives": [primitive]})

    def place(self, mesh: int, at: ArrayLike = (0.0, 0.0, 0.0), **more: Any) -> int:
        """A node of the scene with a mesh."""
        return self.node(mesh=mesh, translation=np.asarray(at, float).tolist(), **more)

    def node(self, **fields: Any) -> int:
        """A node of the scene."""
        number = self.add("nodes", fields)
        self.json["scenes"][0]["nodes"].append(number)
        return number

    def floor(self, half_m: float = 3.0) -> None:
        """Dark and light squares of half a metre."""
        board = np.indices((12, 12)).sum(axis=0) % 2
        pixels = np.repeat(np.where(board, 190, 110)[..., None], 3, axis=2)
        paint = self.material(
            (1, 1, 1), 1.0, pbr={"baseColorTexture": self.texture(pixels, magFilter=9728)}
        )
        corners = np.array([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]]) * half_m
        self.place(self.mesh(_quad(corners, (0.0, 1.0, 0.0)), paint))

    def ball(self, material: int, at: ArrayLike = BALL_AT, radius_m: float = 0.5) -> int:
        """A ball on the floor."""
        return self.place(self.mesh(sphere(radius_m, 48), material), at)

    def panel(self, material: int, at: ArrayLike = PANEL_AT, **more: Any) -> int:
        """An upright square that leans back a little."""
        lean = {"rotation": _LEAN}
        return self.place(
            self.mesh(_quad(PANEL, (0.0, 0.0, 1.0)), material), at, **{**lean, **more}
        )

    def slab(self, material: int) -> int:
        """A box of a tenth of a metre in the panel's place."""
        shape = box((-0.55, -0.55, -0.05), (0.55, 0.55, 0.05))
        return self.place(self.mesh(shape, material), PANEL_AT, rotation=_LEAN)

    def behind(self) -> None:
        """A red and a blue column, for what is seen through."""
        for x, colour in ((-0.95, (0.7, 0.06, 0.05)), (0.95, (0.05, 0.1, 0.6))):
            column = PlainMesh(
                sphere(0.16, 24).positions * [1, 4, 1], sphere(0.16, 24).normals,
                sphere(0.16, 24).uv, sphere(0.16, 24).faces,
            )  # fmt: skip
            self.place(self.mesh(column, self.material(colour, 0.8)), (x, 0.6, -1.2))

    def write(self, path: Path) -> Path:
        """As a GLB."""
        text = json.dumps({**self.json, "buffers": [{"byteLength": len(self._binary)}]}).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self._binary) + b"\0" * (-len(self._binary) % 4)
        size = 12 + 8 + len(text) + 8 + len(binary)
        path.write_bytes(
            struct.pack("<4sII", b"glTF", 2, size)
            + struct.pack("<I4s", len(text), b"JSON") + text
            + struct.pack("<I4s", len(binary), b"BIN\0") + binary
        )  # fmt: skip
        return path


def _quad(corners: NDArray[Any], normal: ArrayLike) -> PlainMesh:
    return PlainMesh(
        np.asarray(corners, float), np.tile(normal, (4, 1)), PANEL_UV, QUAD.reshape(-1, 3)
    )

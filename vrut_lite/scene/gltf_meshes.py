"""The triangle meshes of a glTF file, bent and unbent."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.draco import decode_draco
from vrut_lite.scene.gltf_file import GltfFile, item_at, normalised
from vrut_lite.scene.gltf_schema import Primitive
from vrut_lite.scene.gltf_shapes import TRIANGLES, ShapeKey, shape_of
from vrut_lite.scene.gltf_skinning import UNBENT, Bend, joints_and_weights
from vrut_lite.scene.materials import GltfMaterials
from vrut_lite.scene.mesh import (
    MESH_BYTES,
    Geometry,
    TriangleMesh,
    make_geometry,
    make_mesh,
    used_vertices,
)
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.scene.skinning import bent_normals, bent_positions, morphed, skin_matrices
from vrut_lite.scene.vertex_colours import within_range

_FAN = 6


class GltfMeshes:
    """The triangle meshes behind glTF's mesh numbers, each made once, bent ones once a pose."""

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._materials = GltfMaterials(file)
        self._geometries: dict[ShapeKey, Geometry | None] = {}
        self._made: dict[tuple[int, Bend], list[tuple[str, TriangleMesh]]] = {}
        self._palettes: Mapping[int, NDArray[np.float64]] = {}
        self._bent_bytes = 0

    def begin(self, palettes: Mapping[int, NDArray[np.float64]]) -> None:
        """Begin a pose with these joints' matrices (J, 4, 4) by skin: drop deformed meshes."""
        self._palettes = palettes
        self._geometries = {key: one for key, one in self._geometries.items() if not key.bent}
        self._made = {key: made for key, made in self._made.items() if key[1] == UNBENT}
        self._file.folder.budget.release(self._bent_bytes)
        self._bent_bytes = 0

    def get(self, index: int, bend: Bend) -> list[tuple[str, TriangleMesh]]:
        """Named meshes, one for each primitive that is made of triangles."""
        if (index, bend) not in self._made:
            source = item_at(self._file.document.meshes, index, "mesh")
            name = source.name or f"mesh {index}"
            made = [(name, self._make(primitive, name, bend)) for primitive in source.primitives]
            self._made[index, bend] = [(name, mesh) for name, mesh in made if mesh is not None]
        return self._made[index, bend]

    def _make(self, primitive: Primitive, name: str, bend: Bend) -> TriangleMesh | None:
        shape = shape_of(self._file, primitive, bend)
        if shape is None:
            return None
        if shape not in self._geometries:
            self._geometries[shape] = self._geometry(shape, name)
        geometry = self._geometries[shape]
        if geometry is None:
            return None
        self._take(MESH_BYTES, name, bend != UNBENT)
        coloured = geometry.colours is not None
        return make_mesh(geometry, self._materials.material(primitive.material, coloured))

    def _take(self, size_bytes: int, name: str, bent: bool) -> None:
        self._file.folder.budget.take(size_bytes, f"mesh {ascii(name)[:60]}")
        self._bent_bytes += size_bytes if bent else 0

    # Converting signalling NaNs warns; `make_geometry` refuses them afterwards.
    @np.errstate(invalid="ignore", over="ignore")
    def _geometry(self, shape: ShapeKey, name: str) -> Geometry | None:
        budget = self._file.folder.budget
        self._take(shape.size_bytes(self._file), name, shape.bent)
        arrays, faces = self._arrays(shape)
        if len(faces) == 0:
            return None
        for number, (_, target) in enumerate(shape.targets):
            arrays.update({f"{key} {number}": self._file.array(at) for key, at in target})
        faces, arrays = used_vertices(name, faces, arrays)
        for key, number in self._named(shape):
            if key in arrays and self._file.is_share(key, number):
                arrays[key] = normalised(arrays[key])
        if "COLOR_0" in arrays:
            arrays["COLOR_0"] = within_range(arrays["COLOR_0"], self._file.notices)
        if shape.bent:
            faces = self._bend(shape, arrays, faces)
        uv = [
            layer.coordinates(arrays[layer.attribute]) if layer.attribute in arrays else None
            for layer in shape.layers
        ]
        return make_geometry(
            name,
            arrays["POSITION"],
            faces,
            budget,
            normals=arrays.get("NORMAL"),
            uv=uv[0],
            second_uv=uv[1] if len(uv) > 1 else None,
            colours=arrays.get("COLOR_0"),
        )

    def _named(self, shape: ShapeKey) -> list[tuple[str, int]]:
        """The attributes and the targets' displacements, with their accessors."""
        moved = [
            (f"{key} {number}", at)
            for number, (_, target) in enumerate(shape.targets)
            for key, at in target
        ]
        return [*shape.attributes, *moved]

    def _bend(
        self, shape: ShapeKey, arrays: dict[str, NDArray[Any]], faces: NDArray[np.int64]
    ) -> NDArray[np.int64]:
        """Move positions and normals by targets and skin; the triangles as they then wind."""
        for key in ("POSITION", "NORMAL"):
            deltas = [
                (weight, arrays[f"{key} {number}"])
                for number, (weight, _) in enumerate(shape.targets)
                if f"{key} {number}" in arrays
            ]
            if key in arrays and deltas:
                arrays[key] = morphed(arrays[key], deltas)
        if shape.skin is None:
            return faces
        palette = self._palettes[shape.skin]
        matrices = skin_matrices(*joints_and_weights(arrays, len(palette)), palette)
        arrays["POSITION"] = bent_positions(arrays["POSITION"].astype(np.float64), matrices)
        if "NORMAL" in arrays:
            arrays["NORMAL"] = bent_normals(arrays["NORMAL"].astype(np.float64), matrices)
        mirrored = np.linalg.det(matrices[0, :3, :3]) < 0
        return faces[:, ::-1] if mirrored else faces

    def _arrays(self, shape: ShapeKey) -> tuple[dict[str, NDArray[Any]], NDArray[np.int64]]:
        """The attributes that exist, as stored, and the triangles (F, 3)."""
        if shape.draco is None:
            arrays = {key: self._file.array(number) for key, number in shape.attributes}
            return arrays, self._faces(shape, len(arrays["POSITION"]))
        view, attributes = shape.draco
        counts = {key: self._file.accessor(number).count for key, number in shape.attributes}
        arrays, faces = decode_draco(
            self._file.view_bytes(view),
            dict(attributes),
            counts,
            shape.triangles(self._file),
            self._file.folder.budget,
        )
        if "POSITION" not in arrays:
            raise SceneFileError("its Draco data lack positions; export it again")
        return arrays, faces

    def _faces(self, shape: ShapeKey, vertices: int) -> NDArray[np.int64]:
        """Triangles (F, 3) of a list, strip or fan, with or without indices."""
        if shape.indices is None:
            order = np.arange(vertices)
        else:
            indices = self._file.array(shape.indices)
            if indices.dtype.kind != "u":
                raise SceneFileError("indices in it are not whole numbers; export it again")
            order = indices[:, 0].astype(np.int64)
        if shape.mode == TRIANGLES:
            return order[: order.size // 3 * 3].reshape(-1, 3)
        if shape.mode == _FAN:
            return np.stack([np.full(max(order.size - 2, 0), order[0]), order[1:-1], order[2:]], 1)
        strip = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)
        strip[1::2] = strip[1::2, [1, 0, 2]]
        return strip

"""glTF's tree of nodes as placed triangle meshes and a camera."""

from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from vrut_lite.scene.draco import decode_draco
from vrut_lite.scene.file_checks import SceneFileError
from vrut_lite.scene.gltf_file import GltfFile, item_at, normalised
from vrut_lite.scene.gltf_schema import Node, Primitive
from vrut_lite.scene.materials import GltfMaterials
from vrut_lite.scene.mesh import make_mesh
from vrut_lite.scene.placed import PlacedMesh, SceneCamera, check_triangles
from vrut_lite.scene.uv_layers import UvLayer

MAX_ELEMENTS = 50_000_000
_STRIP, _FAN, _TRIANGLES = 5, 6, 4
_READ = ("POSITION", "NORMAL", "COLOR_0")


def read_gltf_scene(file: GltfFile) -> tuple[list[PlacedMesh], SceneCamera | None]:
    """The meshes of the default scene, in world axes, and its first perspective camera.

    A mesh that several nodes place is one object, shared.

    Raises:
        SceneFileError: for references, counts or values that do not hold.
    """
    nodes = list(_placed_nodes(file))
    _check_size(file, [node.mesh for node, _ in nodes if node.mesh is not None])
    meshes = _Meshes(file)
    placed = [
        PlacedMesh(node.name or name, mesh, world_from_node)
        for node, world_from_node in nodes
        if node.mesh is not None
        for name, mesh in meshes.get(node.mesh)
    ]
    return placed, _first_camera(file, nodes)


def _placed_nodes(file: GltfFile) -> Iterator[tuple[Node, NDArray[np.float64]]]:
    """Each node of the scene with its 4 x 4 matrix to world axes, parents first."""
    document = file.document
    waiting = [(index, np.eye(4)) for index in reversed(_roots(file))]
    seen: set[int] = set()
    while waiting:
        index, world_from_parent = waiting.pop()
        node = item_at(document.nodes, index, "node")
        if index in seen:
            raise SceneFileError(f"node {index} has several parents; export the scene again")
        seen.add(index)
        with np.errstate(over="ignore", invalid="ignore"):
            world_from_node = world_from_parent @ _local_matrix(node)
        yield node, world_from_node
        waiting += [(child, world_from_node) for child in reversed(node.children)]


def _roots(file: GltfFile) -> list[int]:
    document = file.document
    if document.scenes:
        return item_at(document.scenes, document.scene or 0, "scene").nodes
    children = {child for node in document.nodes for child in node.children}
    return [index for index in range(len(document.nodes)) if index not in children]


def _local_matrix(node: Node) -> NDArray[np.float64]:
    """Parent from node: the matrix, or translation times rotation times scale."""
    if node.matrix is not None:
        return np.reshape(node.matrix, (4, 4)).T
    quaternion = np.array(node.rotation)
    length = np.linalg.norm(quaternion)
    x, y, z, w = quaternion / length if length > 0 else (0.0, 0.0, 0.0, 1.0)
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, :3] *= node.scale
    matrix[:3, 3] = node.translation
    return matrix


def _first_camera(
    file: GltfFile, nodes: list[tuple[Node, NDArray[np.float64]]]
) -> SceneCamera | None:
    for node, world_from_node in nodes:
        if node.camera is None:
            continue
        camera = item_at(file.document.cameras, node.camera, "camera")
        axes = world_from_node[:3, :3]
        usable = np.all(np.isfinite(world_from_node)) and np.linalg.matrix_rank(axes) == 3
        if camera.perspective is None or not usable:
            continue
        pose = world_from_node.copy()
        left, _, right = np.linalg.svd(axes)
        pose[:3, :3] = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
        return SceneCamera(pose, camera.perspective.yfov)
    return None


def _check_size(file: GltfFile, placed: list[int]) -> None:
    """Counts are judged beforehand, so that nothing large is made of a small file."""
    elements, triangles = 0, 0
    for mesh, times in Counter(placed).items():
        for primitive in item_at(file.document.meshes, mesh, "mesh").primitives:
            numbers = [*primitive.attributes.values(), primitive.indices]
            counts = [file.accessor(number).count for number in numbers if number is not None]
            elements += sum(counts)
            triangles += times * (counts[-1] // 3) if counts else 0
    check_triangles(triangles)
    if elements > MAX_ELEMENTS:
        raise SceneFileError(
            f"its meshes count {elements} elements, above the limit of {MAX_ELEMENTS}; simplify it"
        )


class _Meshes:
    """The triangle meshes behind glTF's mesh numbers, each made once."""

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._materials = GltfMaterials(file)
        self._made: dict[int, list[tuple[str, trimesh.Trimesh]]] = {}

    def get(self, index: int) -> list[tuple[str, trimesh.Trimesh]]:
        """Named meshes, one for each primitive that is made of triangles."""
        if index not in self._made:
            source = item_at(self._file.document.meshes, index, "mesh")
            name = source.name or f"mesh {index}"
            made = [(name, self._make(p, name)) for p in source.primitives if p.mode >= _TRIANGLES]
            self._made[index] = [(name, mesh) for name, mesh in made if mesh is not None]
        return self._made[index]

    # Signalling NaNs complain when they are converted; they are judged after it.
    @np.errstate(invalid="ignore", over="ignore")
    def _make(self, primitive: Primitive, name: str) -> trimesh.Trimesh | None:
        if "POSITION" not in primitive.attributes:
            return None
        material = self._materials.material(primitive.material)
        layers = material.uv_layers or [UvLayer("TEXCOORD_0", None)]
        arrays, faces = self._arrays(primitive, {*_READ, *(layer.attribute for layer in layers)})
        uv = [
            layer.coordinates(arrays[layer.attribute]) if layer.attribute in arrays else None
            for layer in layers
        ]
        return make_mesh(
            name,
            arrays["POSITION"],
            faces,
            material=material,
            normals=arrays.get("NORMAL"),
            uv=uv[0],
            second_uv=uv[1] if len(uv) > 1 else None,
            colours=arrays.get("COLOR_0"),
        )

    def _arrays(
        self, primitive: Primitive, wanted: set[str]
    ) -> tuple[dict[str, NDArray[Any]], NDArray[np.int64]]:
        """The wanted attributes that there are, and the triangles (F, 3)."""
        numbers = {key: number for key, number in primitive.attributes.items() if key in wanted}
        draco = primitive.extensions.draco
        if draco is None:
            arrays = {key: self._file.array(number) for key, number in numbers.items()}
            return arrays, self._faces(primitive, len(arrays["POSITION"]))
        accessors = {key: self._file.accessor(number) for key, number in numbers.items()}
        counts = {key: accessor.count for key, accessor in accessors.items()}
        packed = self._file.view_bytes(draco.buffer_view)
        arrays, faces = decode_draco(packed, draco.attributes, counts)
        if "POSITION" not in arrays:
            raise SceneFileError("its Draco data lack positions; export it again")
        for key, array in arrays.items():
            if accessors[key].normalized:
                arrays[key] = normalised(array)
        return arrays, faces

    def _faces(self, primitive: Primitive, vertices: int) -> NDArray[np.int64]:
        """Triangles (F, 3) of a list, strip or fan, with or without indices."""
        if primitive.indices is None:
            order = np.arange(vertices)
        else:
            indices = self._file.array(primitive.indices)
            if indices.dtype.kind != "u":
                raise SceneFileError("indices in it are not whole numbers; export it again")
            order = indices[:, 0].astype(np.int64)
        if primitive.mode == _TRIANGLES:
            return order[: order.size // 3 * 3].reshape(-1, 3)
        if primitive.mode == _FAN:
            return np.stack([np.full(max(order.size - 2, 0), order[0]), order[1:-1], order[2:]], 1)
        strip = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)
        strip[1::2] = strip[1::2, [1, 0, 2]]
        return strip

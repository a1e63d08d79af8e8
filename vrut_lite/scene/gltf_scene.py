"""glTF's tree of nodes as placed triangle meshes and a camera."""

from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray

from vrut_lite.scene.draco import decode_draco
from vrut_lite.scene.gltf_file import GltfFile, item_at, normalised
from vrut_lite.scene.gltf_schema import Material, Node, Primitive
from vrut_lite.scene.materials import GltfMaterials
from vrut_lite.scene.mesh import (
    MESH_BYTES,
    Geometry,
    geometry_bytes,
    make_geometry,
    make_mesh,
    used_vertices,
)
from vrut_lite.scene.placed import PlacedMesh, SceneCamera, check_places, check_triangles
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.scene.uv_layers import UvLayer, layers_of

_FAN, _TRIANGLES = 6, 4
_READ = ("POSITION", "NORMAL", "COLOR_0")
_INDEX_BYTES = 4
_STILL = Node()


def read_gltf_scene(file: GltfFile) -> tuple[list[PlacedMesh], SceneCamera | None]:
    """The meshes of the default scene, in world axes, and its first perspective camera.

    A mesh that several nodes place is one object, shared.

    Raises:
        SceneFileError: for references, counts or values that do not hold, or are too many.
    """
    nodes = list(_placed_nodes(file))
    _check_size(file, Counter(node.mesh for node, _ in nodes if node.mesh is not None))
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
    origin = np.eye(4)
    waiting = [(index, origin) for index in reversed(_roots(file))]
    seen: set[int] = set()
    while waiting:
        check_places(len(seen) + len(waiting))
        index, world_from_parent = waiting.pop()
        node = item_at(document.nodes, index, "node")
        if index in seen:
            raise SceneFileError(f"node {index} has several parents; export the scene again")
        seen.add(index)
        world_from_node = world_from_parent
        if _moves(node):
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


def _moves(node: Node) -> bool:
    """Whether a node has a matrix or parts of one; most of a large tree have none."""
    parts = (node.translation, node.rotation, node.scale)
    return node.matrix is not None or parts != (_STILL.translation, _STILL.rotation, _STILL.scale)


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
        if camera.perspective is None or not np.all(np.isfinite(world_from_node)):
            continue
        if np.linalg.matrix_rank(axes) < 3:
            continue
        pose = world_from_node.copy()
        left, _, right = np.linalg.svd(axes)
        pose[:3, :3] = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
        return SceneCamera(pose, camera.perspective.yfov)
    return None


class _Shape(NamedTuple):
    """Key of a geometry: primitives of one shape share triangles, whatever their materials."""

    mode: int
    attributes: tuple[tuple[str, int], ...]
    indices: int | None
    layers: tuple[UvLayer, ...]
    draco: tuple[int, tuple[tuple[str, int], ...]] | None

    def draws(self, file: GltfFile) -> int:
        """The number of indices, or of vertices where there are no indices."""
        number = dict(self.attributes)["POSITION"] if self.indices is None else self.indices
        return file.accessor(number).count

    def triangles(self, file: GltfFile) -> int:
        """How many triangles are declared."""
        draws = self.draws(file)
        return draws // 3 if self.mode == _TRIANGLES else max(draws - 2, 0)

    def size_bytes(self, file: GltfFile) -> int:
        """The most bytes that its geometry holds, by what the file declares."""
        attributes = dict(self.attributes)
        return geometry_bytes(
            file.accessor(attributes["POSITION"]).count,
            self.triangles(file),
            normals="NORMAL" in attributes,
            layers=len(self.layers) + ("COLOR_0" in attributes),
        )


def _shape(file: GltfFile, primitive: Primitive) -> _Shape | None:
    """The shape of a primitive, or None if it has no triangles."""
    if primitive.mode < _TRIANGLES or "POSITION" not in primitive.attributes:
        return None
    number = primitive.material
    source = Material() if number is None else item_at(file.document.materials, number, "material")
    layers = layers_of(source)[0] or [UvLayer("TEXCOORD_0", None)]
    wanted = {*_READ, *(layer.attribute for layer in layers)}
    attributes = sorted((key, at) for key, at in primitive.attributes.items() if key in wanted)
    packed = primitive.extensions.draco
    draco = None
    if packed is not None:
        draco = (packed.buffer_view, tuple(sorted(packed.attributes.items())))
    return _Shape(primitive.mode, tuple(attributes), primitive.indices, tuple(layers), draco)


def _check_size(file: GltfFile, placed: Counter[int]) -> None:
    """Checks declared counts before arrays are made: a small file cannot make large ones."""
    places = triangles = size_bytes = 0
    shapes: set[_Shape] = set()
    arrays: set[int] = set()
    for number, times in placed.items():
        for primitive in item_at(file.document.meshes, number, "mesh").primitives:
            shape = _shape(file, primitive)
            if shape is None:
                continue
            places += times
            triangles += times * shape.triangles(file)
            size_bytes += MESH_BYTES
            if shape in shapes:
                continue
            shapes.add(shape)
            size_bytes += shape.size_bytes(file)
            if shape.draco is None:
                _ask(file, shape, arrays)
    check_places(places)
    check_triangles(triangles)
    file.folder.budget.check(size_bytes, "its meshes")


def _ask(file: GltfFile, shape: _Shape, arrays: set[int]) -> None:
    """Counts each accessor once, and the triangle list that is made for each shape."""
    budget = file.folder.budget
    for index in (*(at for _, at in shape.attributes), shape.indices):
        if index is not None and index not in arrays:
            arrays.add(index)
            budget.ask(file.accessor_bytes(index), f"accessor {index}")
    budget.ask(shape.draws(file) * _INDEX_BYTES, "a list of triangles in it")


class _Meshes:
    """The triangle meshes behind glTF's mesh numbers, each made once."""

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._materials = GltfMaterials(file)
        self._geometries: dict[_Shape, Geometry | None] = {}
        self._made: dict[int, list[tuple[str, trimesh.Trimesh]]] = {}

    def get(self, index: int) -> list[tuple[str, trimesh.Trimesh]]:
        """Named meshes, one for each primitive that is made of triangles."""
        if index not in self._made:
            source = item_at(self._file.document.meshes, index, "mesh")
            name = source.name or f"mesh {index}"
            made = [(name, self._make(primitive, name)) for primitive in source.primitives]
            self._made[index] = [(name, mesh) for name, mesh in made if mesh is not None]
        return self._made[index]

    def _make(self, primitive: Primitive, name: str) -> trimesh.Trimesh | None:
        shape = _shape(self._file, primitive)
        if shape is None:
            return None
        if shape not in self._geometries:
            self._geometries[shape] = self._geometry(shape, name)
        geometry = self._geometries[shape]
        if geometry is None:
            return None
        self._file.folder.budget.take(MESH_BYTES, f"mesh {ascii(name)[:60]}")
        return make_mesh(geometry, self._materials.material(primitive.material))

    # Converting signalling NaNs warns; `make_geometry` refuses them afterwards.
    @np.errstate(invalid="ignore", over="ignore")
    def _geometry(self, shape: _Shape, name: str) -> Geometry | None:
        budget = self._file.folder.budget
        budget.take(shape.size_bytes(self._file), f"mesh {ascii(name)[:60]}")
        arrays, faces = self._arrays(shape)
        if len(faces) == 0:
            return None
        faces, arrays = used_vertices(name, faces, arrays)
        for key, number in shape.attributes:
            if key in arrays and self._file.accessor(number).normalized:
                arrays[key] = normalised(arrays[key])
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

    def _arrays(self, shape: _Shape) -> tuple[dict[str, NDArray[Any]], NDArray[np.int64]]:
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

    def _faces(self, shape: _Shape, vertices: int) -> NDArray[np.int64]:
        """Triangles (F, 3) of a list, strip or fan, with or without indices."""
        if shape.indices is None:
            order = np.arange(vertices)
        else:
            indices = self._file.array(shape.indices)
            if indices.dtype.kind != "u":
                raise SceneFileError("indices in it are not whole numbers; export it again")
            order = indices[:, 0].astype(np.int64)
        if shape.mode == _TRIANGLES:
            return order[: order.size // 3 * 3].reshape(-1, 3)
        if shape.mode == _FAN:
            return np.stack([np.full(max(order.size - 2, 0), order[0]), order[1:-1], order[2:]], 1)
        strip = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)
        strip[1::2] = strip[1::2, [1, 0, 2]]
        return strip

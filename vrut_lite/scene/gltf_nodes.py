"""glTF's tree of nodes: where each stands at rest or in a pose, and its cameras."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.gltf_file import GltfFile, item_at
from vrut_lite.scene.gltf_schema import Node
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.placed import SceneCamera, check_places
from vrut_lite.scene.scene_file_error import SceneFileError

_LONGEST_NAME = 80
_STILL = Node()
Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Pose:
    """State of an animation by node: translation, rotation and scale, and weights.

    `moved` maps a node's number to names and values of `Node`'s fields; an empty pose is the rest.
    """

    moved: Mapping[int, Mapping[str, tuple[float, ...]]] = field(default_factory=dict)

    def parts(self, index: int, node: Node) -> dict[str, tuple[float, ...]]:
        """Translation, rotation and scale of a node without a matrix."""
        at_rest = {"translation": node.translation, "rotation": node.rotation, "scale": node.scale}
        moved = self.moved.get(index, {})
        return {name: moved.get(name, value) for name, value in at_rest.items()}


REST = Pose()


class PlacedNode(NamedTuple):
    """A node of the scene, by its number, and the matrix (4, 4) from its axes to the scene's."""

    number: int
    node: Node
    scene_from_node: Matrix


def placed_nodes(file: GltfFile, pose: Pose) -> Iterator[PlacedNode]:
    """The nodes of the default scene, parents first.

    Raises:
        SceneFileError: for nodes that are missing, have several parents, or are too many.
    """
    document = file.document
    local = _local_matrices(file, pose)
    origin = np.eye(4)
    waiting = [(index, origin) for index in reversed(_roots(file))]
    seen: set[int] = set()
    while waiting:
        check_places(len(seen) + len(waiting))
        index, scene_from_parent = waiting.pop()
        node = item_at(document.nodes, index, "node")
        if index in seen:
            raise SceneFileError(f"node {index} has several parents; export the scene again")
        seen.add(index)
        scene_from_node = scene_from_parent
        if index in local:
            with np.errstate(over="ignore", invalid="ignore"):
                scene_from_node = scene_from_parent @ local[index]
        yield PlacedNode(index, node, scene_from_node)
        waiting += [(child, scene_from_node) for child in reversed(node.children)]


def _roots(file: GltfFile) -> list[int]:
    document = file.document
    if document.scenes:
        return item_at(document.scenes, document.scene or 0, "scene").nodes
    children = {child for node in document.nodes for child in node.children}
    return [index for index in range(len(document.nodes)) if index not in children]


def _moves(node: Node) -> bool:
    """Whether a node has parts of a matrix; most of a large tree have none."""
    parts = (node.translation, node.rotation, node.scale)
    return parts != (_STILL.translation, _STILL.rotation, _STILL.scale)


def _local_matrices(file: GltfFile, pose: Pose) -> dict[int, Matrix]:
    """Parent from node, of nodes that move: the matrix, or translation times rotation times scale.

    All at once: node by node numpy takes ten times as long.
    """
    found: dict[int, Matrix] = {}
    parts: dict[int, dict[str, tuple[float, ...]]] = {}
    for index, node in enumerate(file.document.nodes):
        if node.matrix is not None:
            found[index] = np.reshape(node.matrix, (4, 4)).T
        elif index in pose.moved or _moves(node):
            parts[index] = pose.parts(index, node)
    if parts:
        names = ("translation", "rotation", "scale")
        arrays = [np.array([part[name] for part in parts.values()]) for name in names]
        found.update(zip(parts, matrices_of(*arrays), strict=True))
    return found


def matrices_of(translation: Matrix, rotation: Matrix, scale: Matrix) -> Matrix:
    """The matrices (n, 4, 4) of translations (n, 3), quaternions (n, 4; x, y, z, w) and scales."""
    with np.errstate(over="ignore", invalid="ignore"):
        length = np.linalg.norm(rotation, axis=1, keepdims=True)
    still = np.array([0.0, 0.0, 0.0, 1.0])
    unit = np.where(length > 0, rotation / np.where(length > 0, length, 1.0), still)
    x, y, z, w = unit.T
    matrices = np.zeros((len(unit), 4, 4))
    matrices[:, :3, :3] = np.moveaxis(
        np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        ),
        -1,
        0,
    )
    matrices[:, :3, :3] *= scale[:, None, :]
    matrices[:, :3, 3] = translation
    matrices[:, 3, 3] = 1.0
    return matrices


def cameras_of(
    file: GltfFile, nodes: Iterable[PlacedNode], notices: Notices
) -> Iterator[SceneCamera]:
    """The perspective cameras in the order of their nodes, under their nodes' or own names."""
    for _, node, scene_from_node in nodes:
        if node.camera is None:
            continue
        camera = item_at(file.document.cameras, node.camera, "camera")
        if camera.perspective is None:
            notices.tell("orthographic camera", "not offered")
            continue
        axes = scene_from_node[:3, :3]
        if not np.all(np.isfinite(scene_from_node)) or np.linalg.matrix_rank(axes) < 3:
            notices.tell("camera without a direction", "not offered")
            continue
        pose = scene_from_node.copy()
        left, _, right = np.linalg.svd(axes)
        pose[:3, :3] = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
        name = " ".join((node.name or camera.name or f"camera {node.camera + 1}").split())
        yield SceneCamera(pose, camera.perspective.yfov, name[:_LONGEST_NAME])

"""Deformation of a mesh instance: morph-target weights and skin."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.gltf_file import GltfFile, item_at
from vrut_lite.scene.gltf_nodes import PlacedNode, Pose
from vrut_lite.scene.gltf_schema import Skin
from vrut_lite.scene.scene_file_error import SceneFileError


class Bend(NamedTuple):
    """Weights of morph targets, none if all are zero, and the number of a skin."""

    weights: tuple[float, ...] = ()
    skin: int | None = None


UNBENT = Bend()


def bend_of(file: GltfFile, placed: PlacedNode, pose: Pose, skins: "Skins") -> Bend:
    """How a node bends its mesh: the pose's weights, else the node's, else the mesh's."""
    node = placed.node
    mesh = item_at(file.document.meshes, node.mesh or 0, "mesh")
    weights = tuple(
        pose.moved.get(placed.number, {}).get("weights") or node.weights or mesh.weights
    )
    if not all(map(np.isfinite, weights)):
        raise SceneFileError("weights of morph targets in it are not finite; export it again")
    has_joints = any("JOINTS_0" in primitive.attributes for primitive in mesh.primitives)
    skin = node.skin if has_joints and node.skin in skins else None
    return Bend(weights if any(weights) else (), skin)


class Skins:
    """The skins that the nodes of a scene wear.

    Raises:
        SceneFileError: one lacks matrices of its joints.
    """

    def __init__(self, file: GltfFile, nodes: Sequence[PlacedNode]) -> None:
        there = {placed.number for placed in nodes}
        numbers = {
            placed.node.skin
            for placed in nodes
            if placed.node.mesh is not None and placed.node.skin is not None
        }
        self._skins: dict[int, tuple[list[int], NDArray[np.float64]]] = {}
        for number in sorted(numbers):
            skin = item_at(file.document.skins, number, "skin")
            if there.issuperset(skin.joints):
                self._skins[number] = (skin.joints, _inverse_bind(file, skin))
            else:
                file.notices.tell("skin whose joints are not in the scene", "unbent")

    def __contains__(self, number: int | None) -> bool:
        return number in self._skins

    def palettes(self, nodes: Sequence[PlacedNode]) -> dict[int, NDArray[np.float64]]:
        """The joints' matrices (J, 4, 4) of each skin, from the mesh's axes to the scene's.

        The node that places a skinned mesh moves nothing (glTF 2.0, section 3.7.3.3).
        """
        if not self._skins:
            return {}
        at = {placed.number: placed.scene_from_node for placed in nodes}
        return {
            number: np.array([at[joint] for joint in joints]) @ inverse_bind
            for number, (joints, inverse_bind) in self._skins.items()
        }


def _inverse_bind(file: GltfFile, skin: Skin) -> NDArray[np.float64]:
    if skin.inverse_bind_matrices is None:
        return np.eye(4)
    budget = file.folder.budget
    budget.ask(file.accessor_bytes(skin.inverse_bind_matrices), "the matrices of a skin")
    stored = file.array(skin.inverse_bind_matrices)
    if stored.shape[1] != 16 or len(stored) < len(skin.joints):
        raise SceneFileError("a skin in it lacks matrices of its joints; export it again")
    matrices = stored[: len(skin.joints)].astype(np.float64).reshape(-1, 4, 4)
    return np.swapaxes(matrices, 1, 2)


def joints_and_weights(
    arrays: Mapping[str, NDArray[Any]], joints: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """All sets of joint numbers and of weights side by side, (V, 4 n) each.

    Raises:
        SceneFileError: a set lacks its partner, or names a joint that is not there.
    """
    numbers = sorted(key for key in arrays if key.startswith("JOINTS_"))
    weights = sorted(key for key in arrays if key.startswith("WEIGHTS_"))
    if not numbers or [key[7:] for key in numbers] != [key[8:] for key in weights]:
        raise SceneFileError("a skinned mesh lacks joints or weights; export it again")
    joined = np.concatenate([arrays[key] for key in numbers], axis=1)
    shares = np.concatenate([arrays[key] for key in weights], axis=1).astype(np.float64)
    if joined.dtype.kind != "u" or joined.max() >= joints or shares.shape != joined.shape:
        raise SceneFileError("a skinned mesh names joints that its skin has not; export it again")
    return joined.astype(np.int64), np.nan_to_num(shares)

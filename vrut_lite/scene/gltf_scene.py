"""The default scene of a glTF file as placed triangle meshes and cameras, at rest and in poses."""

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.gltf_animation import GltfAnimations
from vrut_lite.scene.gltf_file import GltfFile
from vrut_lite.scene.gltf_instances import instances_of
from vrut_lite.scene.gltf_lamps import GltfLamps
from vrut_lite.scene.gltf_meshes import GltfMeshes
from vrut_lite.scene.gltf_nodes import REST, PlacedNode, cameras_of, placed_nodes
from vrut_lite.scene.gltf_notices import tell_unread
from vrut_lite.scene.gltf_points_and_lines import GltfStrokes, Strokes
from vrut_lite.scene.gltf_shapes import Sizes
from vrut_lite.scene.gltf_skinning import UNBENT, Bend, Skins, bend_of
from vrut_lite.scene.gltf_variants import variant_names
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.lamps import PlacedLamp
from vrut_lite.scene.placed import PlacedMesh, SceneCamera


class GltfScene:
    """The default scene of a file, at rest and in the poses of its animations.

    Raises:
        SceneFileError: for references, counts or values that do not hold, or are too many.
    """

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._animations = GltfAnimations(file)
        nodes = list(placed_nodes(file, REST))
        tell_unread(file, [node for _, node, _ in nodes])
        self._cameras = list(cameras_of(file, nodes, file.notices))
        self._lamps = GltfLamps(file)
        self._lamps.tell_unread(nodes)
        self._strokes = GltfStrokes(file)
        self._skins = Skins(file, nodes)
        self._instances = {
            one.number: instances_of(file, one.node.extensions.instancing)
            for one in nodes
            if one.node.extensions.instancing is not None
        }
        self._sizes = Sizes(file)
        self._meshes: GltfMeshes | None = None

    @property
    def variants(self) -> list[str]:
        """The names of its materials' variants."""
        return variant_names(self._file.document)

    @property
    def duration_s(self) -> float:
        """How long its animations last; 0 without any."""
        return self._animations.duration_s

    def posed(self, time_s: float | None) -> list[PlacedMesh]:
        """The meshes, in the scene's axes, at a time of its animations, or at rest.

        A mesh that several nodes place unbent is one object, shared.
        """
        file, pose = self._file, self._animations.pose(time_s)
        nodes = list(placed_nodes(file, pose))
        uses = [
            (one, bend_of(file, one, pose, self._skins))
            for one in nodes
            if one.node.mesh is not None
        ]
        places = [self._places(one) for one, _ in uses]
        numbers: Counter[tuple[int, Bend]] = Counter()
        for (one, bend), matrices in zip(uses, places, strict=True):
            numbers[one.node.mesh or 0, bend] += len(matrices)
        placed: list[PlacedMesh] = []
        if self._meshes is None:
            self._sizes.check(numbers)
            self._meshes = GltfMeshes(file)
            self._meshes.begin(self._skins.palettes(nodes))
        else:
            self._meshes.begin(self._skins.palettes(nodes))
            bent = {key: times for key, times in numbers.items() if key[1] != UNBENT}
            self._sizes.check(Counter(bent))
        for (one, bend), matrices in zip(uses, places, strict=True):
            for name, mesh in self._meshes.get(one.node.mesh or 0, bend):
                for matrix in matrices if bend.skin is None else (np.eye(4),):
                    placed.append(PlacedMesh(one.node.name or name, mesh, matrix))
        return placed

    def strokes(self, time_s: float | None) -> list[Strokes]:
        """Points and lines, in the scene's axes, at a time of its animations, or at rest."""
        placed = []
        self._strokes.begin()
        for one in placed_nodes(self._file, self._animations.pose(time_s)):
            if one.node.mesh is None:
                continue
            for strokes in self._strokes.get(one.node.mesh):
                for matrix in self._places(one):
                    self._strokes.take(strokes)
                    placed.append(strokes.moved(matrix))
        return placed

    def cameras(self, time_s: float | None) -> list[SceneCamera]:
        """The cameras, in the scene's axes, at a time of its animations, or at rest."""
        if time_s is None:
            return self._cameras
        nodes = placed_nodes(self._file, self._animations.pose(time_s))
        return list(cameras_of(self._file, nodes, Notices()))

    def lamps(self, time_s: float | None) -> list[PlacedLamp]:
        """The lamps, in the scene's axes, at a time of its animations, or at rest."""
        return self._lamps.placed(list(placed_nodes(self._file, self._animations.pose(time_s))))

    def _places(self, placed: PlacedNode) -> NDArray[np.float64]:
        """The matrices (n, 4, 4) to the scene's axes of the places of a node's mesh."""
        if placed.number not in self._instances:
            return placed.scene_from_node[None]
        with np.errstate(over="ignore", invalid="ignore"):
            return np.asarray(placed.scene_from_node @ self._instances[placed.number])

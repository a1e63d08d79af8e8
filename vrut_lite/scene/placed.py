"""The parts of a loaded scene: placed meshes and a camera."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.mesh import TriangleMesh
from vrut_lite.scene.scene_file_error import SceneFileError

MAX_TRIANGLES = 20_000_000
MAX_PLACES = 200_000


@dataclass(frozen=True)
class PlacedMesh:
    """A mesh and the 4 x 4 matrix from its axes to world axes, in metres.

    `mesh` may be shared with other places; its colours multiply the base colour.
    Triangles are counter-clockwise seen from outside after the matrix, mirrored or not.
    """

    name: str
    mesh: TriangleMesh
    world_from_model: NDArray[np.float64]

    def world_triangles(self) -> NDArray[np.float64]:
        """The corners (F, 3, 3) of all triangles in world axes."""
        corners = self.mesh.vertices[self.mesh.faces]
        return corners @ self.world_from_model[:3, :3].T + self.world_from_model[:3, 3]


def box_of(points: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The lowest and the highest corner (3,) of points (n, 3).

    Column by column: along the short axis numpy takes five times as long.
    """
    columns = [points[:, axis] for axis in range(3)]
    low, high = [column.min() for column in columns], [column.max() for column in columns]
    return np.array(low, np.float64), np.array(high, np.float64)


def check_triangles(count: int) -> None:
    """Raise SceneFileError for more than `MAX_TRIANGLES`."""
    if count > MAX_TRIANGLES:
        raise SceneFileError(
            f"it has {count} triangles, above the limit of {MAX_TRIANGLES}; simplify it"
        )


def check_places(count: int) -> None:
    """Raise SceneFileError for more than `MAX_PLACES` nodes or placed meshes."""
    if count > MAX_PLACES:
        raise SceneFileError(
            f"it places more than {MAX_PLACES} nodes and meshes; join meshes that belong together"
        )


@dataclass(frozen=True)
class SceneCamera:
    """A camera of a scene file: a rigid 4 x 4 pose, looking along its own -Z with +Y up."""

    world_from_camera: NDArray[np.float64]
    vertical_field_of_view_rad: float
    name: str = ""

    def moved(self, world_from_file: NDArray[np.float64]) -> "SceneCamera":
        """The camera where the file stands; a scale moves it and leaves it rigid."""
        matrix = world_from_file.copy()
        matrix[:3, :3] /= np.cbrt(np.linalg.det(matrix[:3, :3]))
        pose = matrix @ self.world_from_camera
        pose[:3, 3] = (world_from_file @ self.world_from_camera)[:3, 3]
        return replace(self, world_from_camera=pose)

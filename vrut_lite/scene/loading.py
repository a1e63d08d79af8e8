"""Opens a scene file (glTF, GLB or OBJ) as placed meshes in metres, without GL."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from vrut_lite.daylight.lamps import SceneLamps
from vrut_lite.errors import UserError
from vrut_lite.scene.budget import SceneBudget, budget_of_environment
from vrut_lite.scene.file_checks import SceneFolder
from vrut_lite.scene.gltf_file import read_gltf_file
from vrut_lite.scene.gltf_scene import read_gltf_scene
from vrut_lite.scene.mesh import mirrored
from vrut_lite.scene.notices import Notices
from vrut_lite.scene.obj_scene import read_obj_scene
from vrut_lite.scene.placed import PlacedMesh, SceneCamera, check_triangles
from vrut_lite.scene.scene_file_error import SceneFileError

SUFFIXES = (".glb", ".gltf", ".obj")
MAX_REACH_M = 1e7


@dataclass(frozen=True)
class LoadedScene:
    """A scene in world axes: metres, +Y up, east +X, north -Z.

    `lower_m` and `upper_m` (3,) bound all triangles; `triangles` counts those of shared meshes
    once for each place. `notices` are lines on what the files have and the meshes do not.
    """

    path: Path
    meshes: tuple[PlacedMesh, ...]
    lower_m: NDArray[np.float64]
    upper_m: NDArray[np.float64]
    triangles: int
    camera: SceneCamera | None
    lamps: SceneLamps | None = None
    notices: tuple[str, ...] = ()


def load_scene(
    path: str | os.PathLike[str],
    budget: SceneBudget | None = None,
    luminaires: Mapping[str, str] | None = None,
) -> LoadedScene:
    """Read a scene file with its materials, textures, camera and lamps.

    `budget` limits memory; by default it comes from the environment. `luminaires` are paths of IES
    files by the names of lamps.

    Raises:
        UserError: in one sentence, if the file is missing, damaged, too large, empty, or names
            anything outside its own folder.
    """
    file = Path(path)
    try:
        return _load(file, budget or budget_of_environment(), luminaires or {})
    except SceneFileError as fault:
        raise UserError(f"cannot open the scene {file}: {fault}") from fault


def _load(path: Path, budget: SceneBudget, luminaires: Mapping[str, str]) -> LoadedScene:
    _check_path(path)
    real = path.resolve()
    camera: SceneCamera | None = None
    lamps: SceneLamps | None = None
    notices = Notices()
    if real.suffix.lower() == ".obj":
        placed = read_obj_scene(real, budget, notices)
        if luminaires:
            raise SceneFileError("an OBJ file has no lamps that a luminaire could be given to")
    else:
        file = read_gltf_file(real, budget, notices)
        placed, camera, lamps = read_gltf_scene(file, _ies_files(luminaires, budget))
    triangles = sum(len(place.mesh.faces) for place in placed)
    if triangles == 0:
        raise SceneFileError("it has no triangles; export the scene with its meshes")
    check_triangles(triangles)
    lower_m, upper_m = _bounds(placed)
    return LoadedScene(
        path,
        tuple(_wound_outwards(placed, budget)),
        lower_m,
        upper_m,
        triangles,
        camera,
        lamps,
        notices.lines(),
    )


def _ies_files(luminaires: Mapping[str, str], budget: SceneBudget) -> dict[str, bytes]:
    """The bytes of IES files, each in whatever folder it is."""
    return {
        name: SceneFolder(Path(path).parent, budget).read(Path(path))
        for name, path in luminaires.items()
    }


def _check_path(path: Path) -> None:
    try:
        if path.is_dir():
            raise SceneFileError("it is a folder; name the scene file in it")
        if not path.exists():
            raise SceneFileError("there is no such file; check its name")
        if not path.is_file():
            raise SceneFileError("it is not a regular file; name a scene file")
    except (OSError, ValueError) as fault:
        if isinstance(fault, SceneFileError):
            raise
        raise SceneFileError(f"its path cannot be used ({fault}); check its name") from fault
    if path.resolve().suffix.lower() not in SUFFIXES:
        raise SceneFileError(
            f"its name does not end in {', '.join(SUFFIXES)}; export it as one of these"
        )


def _wound_outwards(placed: list[PlacedMesh], budget: SceneBudget) -> list[PlacedMesh]:
    """Reverse the triangles that a mirroring matrix turns inside out (glTF 2.0, section 3.7.4)."""
    turned: dict[int, trimesh.Trimesh] = {}
    result = []
    for place in placed:
        if np.linalg.det(place.world_from_model[:3, :3]) < 0:
            if id(place.mesh) not in turned:
                turned[id(place.mesh)] = mirrored(place.mesh, budget)
            place = replace(place, mesh=turned[id(place.mesh)])
        result.append(place)
    return result


def _bounds(placed: list[PlacedMesh]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    with np.errstate(over="ignore", invalid="ignore"):
        corners = [_corners(place) for place in placed]
    lower_m = np.min([pair[0] for pair in corners], axis=0)
    upper_m = np.max([pair[1] for pair in corners], axis=0)
    reach_m = np.max(np.abs([lower_m, upper_m]))
    if not reach_m <= MAX_REACH_M:
        raise SceneFileError(
            f"it reaches {reach_m:.3g} m from its origin, above the limit of {MAX_REACH_M:.0e} m; "
            "scenes are in metres"
        )
    return lower_m, upper_m


def _corners(place: PlacedMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    vertices = np.asarray(place.mesh.vertices)
    world = vertices @ place.world_from_model[:3, :3].T + place.world_from_model[:3, 3]
    return world.min(axis=0), world.max(axis=0)

"""STL, PLY, OFF, 3MF and COLLADA as placed meshes.

A separate process reads them under the scene's memory limit: PLY and OFF by our readers,
the others by trimesh. Colours of vertices and faces are sRGB, as programs show them; those of
COLLADA's materials are linear, as an MTL's Kd.
"""

from pathlib import Path

import numpy as np

from vrut_lite.messages.placement import (
    LEAST_METRES_PER_UNIT,
    MOST_METRES_PER_UNIT,
    Placement,
    UpAxis,
)
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.file_checks import SceneFolder
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.mesh_parts import placed_parts
from vrut_lite.scene.mesh_process import MeshReader, read_apart
from vrut_lite.scene.placed import PlacedMesh

# Address space of Python, numpy and trimesh before they read (281 MiB measured; with numba, which
# cuts concave polygons, 400).
_LIBRARY_BYTES = 2**29
_OURS, _TRIMESH = "vrut_lite.scene.polygon_process", "vrut_lite.scene.trimesh_process"
_READERS = {
    suffix: MeshReader(module, kind, _LIBRARY_BYTES, "formats")
    for suffix, kind, module in (
        (".stl", "STL", _TRIMESH),
        (".ply", "PLY", _OURS),
        (".off", "OFF", _OURS),
        (".3mf", "3MF", _TRIMESH),
        (".dae", "COLLADA", _TRIMESH),
    )
}
SUFFIXES = tuple(_READERS)


def read_mesh_scene(
    path: Path, budget: SceneBudget, notices: Notices
) -> tuple[list[PlacedMesh], Placement]:
    """Meshes in the file's axes and units, and what it states of these.

    Raises:
        SceneFileError: a package is missing, or the file is damaged or does not fit the budget.
    """
    folder = SceneFolder(path.parent, budget)
    suffix = path.suffix.lower()
    file = read_apart(_READERS[suffix], suffix, folder.read(path), budget)
    placed = placed_parts(file, folder, notices)
    if file.up == "x":
        notices.tell("up axis X", "taken to stand along +Y (else --up z)")
    unit = file.metres_per_unit
    if unit is not None:
        unit = float(np.clip(unit, LEAST_METRES_PER_UNIT, MOST_METRES_PER_UNIT))
    ups: dict[str, UpAxis] = {"x": "y", "y": "y", "z": "z"}
    return placed, Placement(up=ups.get(file.up), metres_per_unit=unit)

"""IFC 2x3, 4 and 4.3 (extra `ifc`) as placed meshes, through ifcopenshell in its own process.

The file's place and true north are read in `ifc_site`, before the scene is opened.
"""

import math
from pathlib import Path

from vrut_lite.messages.placement import Placement
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.file_checks import SceneFolder
from vrut_lite.scene.ifc_site import SUFFIXES, ifc_text, stated_place
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.mesh_parts import placed_parts
from vrut_lite.scene.mesh_process import MeshReader, read_apart
from vrut_lite.scene.placed import PlacedMesh
from vrut_lite.scene.scene_file_error import SceneFileError

__all__ = ["SUFFIXES", "read_ifc_scene"]

# Address space of Python, ifcopenshell, its and its geometry kernels: 440 MiB measured.
_READER = MeshReader("vrut_lite.scene.ifc_process", "IFC", 2**29, "ifc")


def read_ifc_scene(
    path: Path, budget: SceneBudget, notices: Notices
) -> tuple[list[PlacedMesh], Placement]:
    """Meshes, +Z up, in metres unless the file states no unit.

    Raises:
        SceneFileError: ifcopenshell is missing, or the file is damaged or does not fit the budget.
    """
    folder = SceneFolder(path.parent, budget)
    try:
        text = ifc_text(folder.read(path), lambda size: budget.take(size, "the text of the IFC"))
    except SceneFileError:
        raise
    except ValueError as fault:
        raise SceneFileError(f"its IFC is damaged ({fault}); export it again") from fault
    place = stated_place(text)
    if place is None:
        notices.tell(
            "site without latitude and longitude, nor a map in UTM",
            "no place is taken from the file",
        )
    else:
        north_deg = round(math.degrees(place.north_offset_rad), 2) % 360.0
        notices.tell(
            f"site at {place.latitude_deg:.5g}, {place.longitude_deg:.6g}, "
            f"{place.altitude_m:.5g} m, +Y {north_deg:g} degrees clockwise of north",
            "the scene's place, where none is named",
        )
    file = read_apart(_READER, ".ifc", text, budget)
    unit = 1.0 if b".LENGTHUNIT." in text else None
    return placed_parts(file, folder, notices), Placement(up="z", metres_per_unit=unit)

"""Many places of one mesh (glTF extension EXT_mesh_gpu_instancing)."""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.gltf_file import GltfFile, normalised
from vrut_lite.scene.gltf_nodes import matrices_of
from vrut_lite.scene.gltf_schema import Instancing
from vrut_lite.scene.placed import check_places
from vrut_lite.scene.scene_file_error import SceneFileError

_AT_REST = {
    "TRANSLATION": (0.0, 0.0, 0.0),
    "ROTATION": (0.0, 0.0, 0.0, 1.0),
    "SCALE": (1.0, 1.0, 1.0),
}


def instances_of(file: GltfFile, instancing: Instancing) -> NDArray[np.float64]:
    """The matrices (n, 4, 4) to the node's axes of the places of its mesh.

    Raises:
        SceneFileError: their attributes differ in number or width, or are too many.
    """
    numbers = {key: at for key, at in instancing.attributes.items() if key in _AT_REST}
    counts = {file.accessor(number).count for number in numbers.values()}
    if not numbers:
        return np.eye(4)[None]
    if len(counts) != 1:
        raise SceneFileError("instances in it have attributes of different numbers; export again")
    (count,) = counts
    check_places(count)
    parts = []
    for key, still in _AT_REST.items():
        if key not in numbers:
            parts.append(np.broadcast_to(np.array(still), (count, len(still))))
            continue
        number = numbers[key]
        file.folder.budget.ask(file.accessor_bytes(number), f"accessor {number}")
        stored = file.array(number)
        values = normalised(stored) if file.accessor(number).normalized else stored
        if values.shape[1] != len(still):
            raise SceneFileError(f"instances in it have a {key} of {values.shape[1]} numbers")
        parts.append(values.astype(np.float64))
    return matrices_of(*parts)

"""Meshes packed by Draco (glTF extension KHR_draco_mesh_compression)."""

from collections.abc import Mapping
from typing import Any

import DracoPy
import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.file_checks import SceneFileError


def decode_draco(
    packed: bytes, attributes: Mapping[str, int], counts: Mapping[str, int]
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int64]]:
    """Arrays (V, components) by attribute name, and triangles (F, 3), of packed bytes.

    `attributes` gives Draco's id of each attribute, `counts` how many elements the glTF's own
    accessor promises for it.

    Raises:
        SceneFileError: if the bytes cannot be unpacked, or hold something else than promised.
    """
    try:
        mesh = DracoPy.decode(packed)
    except Exception as fault:
        # The decoder raises types of its own for each way in which bytes can be wrong.
        raise SceneFileError(f"its Draco data cannot be unpacked ({fault})") from fault
    if not isinstance(mesh, DracoPy.DracoMesh):
        raise SceneFileError("its Draco data hold no triangles; export it again")
    found = {attribute["unique_id"]: attribute["data"] for attribute in mesh.attributes}
    arrays = {}
    for name, number in attributes.items():
        if name not in counts:
            continue
        if number not in found or len(found[number]) != counts[name]:
            raise SceneFileError(f"its Draco data lack the promised {name}; export it again")
        arrays[name] = np.asarray(found[number])
    return arrays, np.asarray(mesh.faces, np.int64).reshape(-1, 3)

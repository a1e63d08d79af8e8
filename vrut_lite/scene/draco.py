"""Meshes packed by Draco (glTF extension KHR_draco_mesh_compression)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.draco_header import DracoCounts, read_draco_counts
from vrut_lite.scene.scene_file_error import SceneFileError

# The decoder's peak memory beside its result, measured (docs/stability.md).
_FACE_BYTES, _POINT_BYTES = 80, 24
# Regular meshes, which pack best, have some 20 triangles a byte.
_FACES_PER_BYTE, _FACES_BASE = 64, 20_000


def decode_draco(
    packed: bytes,
    attributes: Mapping[str, int],
    counts: Mapping[str, int],
    triangles: int,
    budget: SceneBudget,
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int64]]:
    """Arrays (V, components) by attribute name, and triangles (F, 3), of packed bytes.

    `attributes` gives Draco's id of each attribute; `counts` its number of elements and
    `triangles` the number of triangles, both as the glTF declares them.

    Raises:
        SceneFileError: if the bytes cannot be unpacked, do not match the glTF's declarations, or
            exceed the budget.
    """
    import DracoPy

    _check_counts(read_draco_counts(packed), len(packed), counts, triangles, budget)
    try:
        mesh = DracoPy.decode(packed)
    except Exception as fault:
        # The decoder raises various exceptions for damaged bytes.
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


def _check_counts(
    declared: DracoCounts,
    packed_bytes: int,
    counts: Mapping[str, int],
    triangles: int,
    budget: SceneBudget,
) -> None:
    """Check the declared counts before the decoder takes memory for them."""
    if declared.faces > _FACES_BASE + _FACES_PER_BYTE * packed_bytes:
        raise SceneFileError(
            f"its Draco data declare {declared.faces} triangles in {packed_bytes} bytes, above the "
            f"limit of {_FACES_PER_BYTE} for each; export it again"
        )
    if declared.points > counts["POSITION"] or declared.faces > triangles:
        raise SceneFileError(
            f"its Draco data declare {declared.points} vertices and {declared.faces} triangles "
            f"where {counts['POSITION']} and {triangles} are promised; export it again"
        )
    points_bytes = counts["POSITION"] * len(counts) * _POINT_BYTES
    budget.take(declared.faces * _FACE_BYTES + points_bytes, "its Draco data")

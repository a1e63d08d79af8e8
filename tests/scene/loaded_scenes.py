"""Queries of a loaded scene and edits of a glTF document, for the tests of loading."""

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scene_files import SQUARE, TRIANGLES

from vrut_lite.scene.loading import LoadedScene
from vrut_lite.scene.materials import SurfaceMaterial
from vrut_lite.scene.mesh import TriangleMesh

WriteScene = Callable[..., Path]
SQUARE_BYTES = SQUARE.tobytes() + TRIANGLES.tobytes()
MODELS = Path(__file__).resolve().parents[1] / "data" / "models"


def material_of(scene: LoadedScene) -> SurfaceMaterial:
    """The first mesh's material."""
    material = scene.meshes[0].mesh.material
    assert isinstance(material, SurfaceMaterial)
    return material


def face_normals(scene: LoadedScene) -> np.ndarray:
    """Unit normals of all triangles in world axes, from their winding."""
    triangles = np.concatenate([place.world_triangles() for place in scene.meshes])
    a, b, c = np.moveaxis(triangles, 1, 0)
    normal = np.cross(b - a, c - a)
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def front_cosines(mesh: TriangleMesh) -> np.ndarray:
    """Cosines (F, 3) between vertex normals and their triangles; none of specks below 1e-8."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    cosine = np.einsum("fcx,fx->fc", mesh.normals[mesh.faces], normal)
    return cosine[length > 2e-8] / length[length > 2e-8, None]


def add_array(document: dict[str, Any], values: np.ndarray, **accessor: Any) -> int:
    """Add an accessor with its own buffer, in a data URI; returns its number."""
    kinds = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}
    names = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
    data = values.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    document["buffers"].append({"uri": uri, "byteLength": len(data)})
    document["bufferViews"].append(
        {"buffer": len(document["buffers"]) - 1, "byteLength": len(data)}
    )
    document["accessors"].append(
        {
            "bufferView": len(document["bufferViews"]) - 1,
            "componentType": kinds[values.dtype.char],
            "count": len(values),
            "type": names[values.shape[1] if values.ndim == 2 else 1],
            **accessor,
        }
    )
    return len(document["accessors"]) - 1


def give(document: dict[str, Any], **attributes: int) -> None:
    """Add attributes to the square."""
    document["meshes"][0]["primitives"][0]["attributes"].update(attributes)

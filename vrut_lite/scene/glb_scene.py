"""An opened scene, and its sky, as one GLB file.

Geometry is written as it was opened: animations at their pose, file formats other than glTF with
axes and units resolved. Positions are float32, glTF's only type for them.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.messages.camera import MoveCamera, look_at
from vrut_lite.messages.lamps import ALL_AROUND, NONE, SceneLamps
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.scene_content import Mesh
from vrut_lite.scene.glb_document import GlbDocument
from vrut_lite.scene.glb_materials import GlbMaterials
from vrut_lite.scene.glb_sky import GlbSky, add_sky, turned_towards

# Largest cosine between the axes of a matrix that a node's translation, rotation and scale can be.
_MOST_SHEAR = 1e-7


class SceneGlb(NamedTuple):
    """The file's bytes, and a sentence on each kind of content that it lacks."""

    data: bytes
    left_out: list[str]


def scene_glb(scene: SceneOpened, sky: GlbSky) -> SceneGlb:
    """The GLB of a scene under its sky."""
    document = GlbDocument()
    materials = GlbMaterials(document)
    numbers = [materials.add(material) for material in scene.materials.all()]
    _add_parts(document, scene, numbers)
    left_out = [] if scene.lamps is None else _add_lamps(document, scene.lamps)
    if scene.points_and_lines is not None:
        left_out.append("points and lines are left out")
    if scene.animation_s > 0.0:
        left_out.append("animations are left out: the scene stands as it was opened")
    if scene.camera is not None:
        _add_camera(document, scene.camera)
    add_sky(document, sky)
    return SceneGlb(document.as_glb(), left_out)


def _add_parts(document: GlbDocument, scene: SceneOpened, materials: list[int]) -> None:
    """A node for each part; parts of one mesh share it."""
    geometry = scene.geometry
    made: dict[int, int] = {}
    for number, matrix in zip(
        geometry.part_mesh.values, geometry.world_from_part.values, strict=True
    ):
        mesh = geometry.mesh(int(number))
        if not _is_rigid_and_scaled(matrix):
            # A sheared or mirrored part gets a separate mesh, in world axes.
            document.root({"mesh": _add_mesh(document, _placed(mesh, matrix), materials)})
            continue
        if number not in made:
            made[number] = _add_mesh(document, mesh, materials)
        node: dict[str, object] = {"mesh": made[number]}
        if not np.array_equal(matrix, np.eye(4)):
            node["matrix"] = matrix.T.reshape(-1).tolist()
        document.root(node)


def _is_rigid_and_scaled(matrix: NDArray[np.float64]) -> bool:
    axes = matrix[:3, :3]
    lengths = np.linalg.norm(axes, axis=0)
    if not (lengths > 0.0).all() or np.linalg.det(axes) <= 0.0:
        return False
    units = axes / lengths
    return bool(np.abs(units.T @ units - np.eye(3)).max() < _MOST_SHEAR)


def _placed(mesh: Mesh, matrix: NDArray[np.float64]) -> Mesh:
    """The mesh in world axes."""
    normals = mesh.normals @ np.linalg.pinv(matrix[:3, :3])
    length = np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return mesh._replace(
        positions_m=mesh.positions_m @ matrix[:3, :3].T + matrix[:3, 3], normals=normals / length
    )


def _add_mesh(document: GlbDocument, mesh: Mesh, materials: list[int]) -> int:
    normals = np.asarray(mesh.normals, np.float32)
    attributes = {"POSITION": document.vertices(mesh.positions_m, bounds=True)}
    # A vertex that no triangle uses may have no normal, which glTF does not allow.
    if (np.abs(np.linalg.norm(normals, axis=1) - 1.0) < 1e-3).all():
        attributes["NORMAL"] = document.vertices(normals)
    for name, uv in (("TEXCOORD_0", mesh.uv), ("TEXCOORD_1", mesh.second_uv)):
        if uv is not None:
            # glTF counts v downwards.
            attributes[name] = document.vertices(np.stack([uv[:, 0], 1.0 - uv[:, 1]], axis=1))
    if mesh.colours_rgba is not None:
        attributes["COLOR_0"] = document.vertices(mesh.colours_rgba)
    primitive = {
        "attributes": attributes,
        "indices": document.indices(mesh.triangles),
        "material": materials[mesh.material],
    }
    return document.add("meshes", {"primitives": [primitive]})


def _add_lamps(document: GlbDocument, lamps: SceneLamps) -> list[str]:
    """Points and spots; a sentence on luminaires, whose tables KHR_lights_punctual lacks."""
    names = bytes(lamps.names.values).decode(errors="replace").split("\n")
    shaped = 0
    for number in range(lamps.count):
        if lamps.table.values[number] != NONE:
            shaped += 1
            continue
        intensity = lamps.intensity_rgb.values[number]
        strongest = float(intensity.max())
        light: dict[str, object] = {
            "type": "point",
            "name": names[number],
            "intensity": LUMENS_PER_WATT * strongest,
            "color": (intensity / strongest).tolist(),
        }
        inner, outer = lamps.cone_cos.values[number]
        if (inner, outer) != ALL_AROUND:
            angles = (float(np.arccos(cosine)) for cosine in (inner, outer))
            cone = dict(zip(("innerConeAngle", "outerConeAngle"), angles, strict=True))
            light |= {"type": "spot", "spot": cone}
        document.root(
            {
                "name": names[number],
                "translation": lamps.position_m.values[number].tolist(),
                "rotation": turned_towards(lamps.axes.values[number][0]),
                "extensions": document.light(light),
            }
        )
    return [f"{shaped} lamps with a luminaire's photometry are left out"] if shaped else []


def _add_camera(document: GlbDocument, camera: MoveCamera) -> None:
    perspective = {"yfov": camera.vertical_field_of_view_rad, "znear": 0.05}
    number = document.add("cameras", {"type": "perspective", "perspective": perspective})
    world_from_camera = np.linalg.inv(look_at(camera.eye_m, camera.target_m))
    document.root({"camera": number, "matrix": world_from_camera.T.reshape(-1).tolist()})

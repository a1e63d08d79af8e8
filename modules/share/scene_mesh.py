"""A scene's triangles as a page draws them: in world axes, a group for each material.

Vertices are those of the light map's charts: a surface that the map cuts up has a vertex for each
side of a cut. Parts without a chart take their light from probes. Each part with an image of its
surroundings has a separate group.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.ground_disc import triangulate
from vrut_lite.messages.light_map import NOT_MAPPED, LightMapLaid
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import Float32Array, FloatArray

GROUND = -1


@dataclass(frozen=True, eq=False)
class MeshGroup:
    """Triangles (F, 3) over vertices (V): positions in m and unit normals, world axes.

    `uv` and `second_uv` (V, 2), v upwards; `light_px` (V, 2), places in the light map in texels,
    or None for light from probes and for the ground; `colours` (V, 4), linear, or None. `material`
    is a number, or `GROUND`. `mirror` is the number of the cube map of its surroundings, or None.
    """

    material: int
    positions_m: Float32Array
    normals: Float32Array
    uv: Float32Array | None
    second_uv: Float32Array | None
    light_px: Float32Array | None
    colours: Float32Array | None
    triangles: NDArray[np.uint32]
    mirror: int | None = None


def groups_of(
    scene: SceneOpened, laid: LightMapLaid, mirror_of: Mapping[int, int]
) -> list[MeshGroup]:
    """The groups of a scene, the ground's last; `mirror_of` parts have cube maps."""
    parts: dict[tuple[int, int | None, bool, bool, bool, bool], list[MeshGroup]] = {}
    for part, number in enumerate(laid.part_shape.values.tolist()):
        made = replace(_part(scene, laid, part, number), mirror=mirror_of.get(part))
        key = (
            made.material,
            made.mirror,
            made.uv is not None,
            made.second_uv is not None,
            made.light_px is not None,
            made.colours is not None,
        )
        parts.setdefault(key, []).append(made)
    found = [_joined(group) for group in parts.values()]
    if scene.ground is not None:
        vertices, triangles = triangulate(scene.ground)
        x, z = scene.ground.centre_xz_m
        places = vertices + np.array([x, scene.ground.height_m, z], np.float32)
        normals = np.broadcast_to(np.array([0.0, 1.0, 0.0], np.float32), places.shape)
        found.append(MeshGroup(GROUND, places, normals, None, None, None, None, triangles))
    return found


def _part(scene: SceneOpened, laid: LightMapLaid, part: int, number: int) -> MeshGroup:
    geometry = scene.geometry
    mesh = geometry.mesh(int(geometry.part_mesh.values[part]))
    matrix = geometry.world_from_part.values[part]
    light_px: Float32Array | None = None
    if number == NOT_MAPPED:
        source: NDArray[np.integer] = np.arange(len(mesh.positions_m))
        triangles: NDArray[np.integer] = mesh.triangles
    else:
        shape = laid.shape(number)
        source, triangles = shape.source_vertex, shape.triangles
        light_px = (shape.uv + laid.part_corner_px.values[part]).astype(np.float32)
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        triangles = triangles[:, ::-1]

    def taken(values: FloatArray | Float32Array | None) -> Float32Array | None:
        return None if values is None else np.asarray(values[source], np.float32)

    places = mesh.positions_m @ matrix[:3, :3].T + matrix[:3, 3]
    normals = mesh.normals @ np.linalg.inv(matrix[:3, :3])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return MeshGroup(
        mesh.material,
        places[source].astype(np.float32),
        normals[source].astype(np.float32),
        taken(mesh.uv),
        taken(mesh.second_uv),
        light_px,
        taken(mesh.colours_rgba),
        triangles.astype(np.uint32),
    )


def _joined(groups: list[MeshGroup]) -> MeshGroup:
    first = groups[0]
    starts = np.cumsum([0, *(len(group.positions_m) for group in groups[:-1])])

    def all_of(name: str) -> Float32Array | None:
        if getattr(first, name) is None:
            return None
        return np.concatenate([getattr(group, name) for group in groups])

    positions, normals = all_of("positions_m"), all_of("normals")
    assert positions is not None
    assert normals is not None
    return MeshGroup(
        first.material,
        positions,
        normals,
        all_of("uv"),
        all_of("second_uv"),
        all_of("light_px"),
        all_of("colours"),
        np.concatenate(
            [
                group.triangles + np.uint32(start)
                for group, start in zip(groups, starts, strict=True)
            ]
        ),
        first.mirror,
    )

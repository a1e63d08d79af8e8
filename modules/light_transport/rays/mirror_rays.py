"""The surroundings of glossy parts: cube maps whose texels remember the rows that their rays met.

The smoothest parts get a cube map. Its rays are traced once a scene, from the middle of a part
through the part itself; each hour lights the rows that they met (mirror_light.py).
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.giving_up import CancelCheck, always
from light_transport.kernels import hot
from light_transport.rays.groups import NO_GROUP
from light_transport.rays.map_texels import NOBODY, MapGeometry
from light_transport.rays.ray_starts import Receivers, scratch
from light_transport.rays.ray_table import met_row
from light_transport.rays.trace import MISS, first_hits, nearest_along
from light_transport.rays.tree import Tree
from light_transport.surfaces.surfaces import Surfaces
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import FACE_NORMALS, FACE_S_AXES, FACE_T_AXES, texel_centres
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.scene_content import Material
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

SKY = -1
# Edges of cubes; the largest that need no more rays than these.
_EDGES = (128, 96, 64, 48, 32)
_MOST_RAYS = 450_000
# Rays of a texel, along each of its edges.
_ACROSS = 2
# A ray that passes more back sides than this counts as lost inside a body.
_MOST_PASSED = 32
_STEP = 2e-5
# Number of random rays from a part, least share of them whose hit the cube shows, and the most by
# which the hit may lie elsewhere, as a share of its distance.
_TRIED, _SERVED, _SAME_PLACE = 256, 0.6, 0.05
_Traced = Callable[[int, Float32Array], tuple[NDArray[np.int32], Float32Array]]
# Largest roughness of surfaces that show images.
ROUGHEST = 0.4
MOST = 16
# Reflectance of a coat, the mean over the visible half of a ball.
_COAT = 0.1
# Distance before flat parts from which they are seen, in halves of their diagonal.
_BEFORE = 0.1
_FLAT = 1e-3


class MirrorParts(NamedTuple):
    """The parts (N) that get a cube map, in order of their gloss times area.

    Attributes:
        part: (N,) int32.
        centre: (N, 3) float64, from where the cube is seen, counted from the scene's middle.
        radius: (N,) float64, of the part around its own middle; both in radii of the scene.
        hollow: (N,) bool, whether the part is seen from within: it then mirrors itself.
        facing: (N, 3) float64, the unit normal of a part that is flat; else 0.
    """

    part: NDArray[np.int32]
    centre: FloatArray
    radius: FloatArray
    hollow: BoolArray
    facing: FloatArray


def mirror_parts(scene: SceneOpened, surfaces: Surfaces) -> MirrorParts:
    """The glossy parts with the most surface, weighed by reflectance and sharpness."""
    geometry, materials = scene.geometry, scene.materials.all()
    gloss = np.array([_gloss(material) for material in materials])
    mesh_gloss = [gloss[geometry.mesh(mesh).material] for mesh in range(geometry.mesh_count)]
    found: list[tuple[float, int]] = []
    for part, mesh in enumerate(geometry.part_mesh.values.tolist()):
        if mesh_gloss[mesh] > 0.0:
            area = float(np.linalg.norm(_areas(_corners(surfaces, part)), axis=1).sum())
            found.append((mesh_gloss[mesh] * area, part))
    found.sort(key=lambda entry: (-entry[0], entry[1]))
    parts = [part for worth, part in found[:MOST] if worth > 0.0]
    views = [
        _view(_corners(surfaces, part), surfaces.normals[_of(surfaces, part)]) for part in parts
    ]
    return MirrorParts(
        np.array(parts, np.int32),
        np.array([view.centre for view in views]).reshape(-1, 3),
        np.array([view.radius for view in views]),
        np.array([view.hollow for view in views], bool),
        np.array([view.facing for view in views]).reshape(-1, 3),
    )


class _View(NamedTuple):
    centre: FloatArray
    radius: float
    hollow: bool
    facing: FloatArray


def _gloss(material: Material) -> float:
    """Weight of a surface's reflections: 0 for none, 1 for a white mirror."""
    roughness = material.roughness
    both = material.maps.get("metallic_roughness")
    metallic = material.metallic
    if both is not None:
        roughness *= float(both.texels[..., 1].mean()) / 255.0
        metallic *= float(both.texels[..., 2].mean()) / 255.0
    if roughness >= ROUGHEST or material.alpha_mode == "BLEND":
        return 0.0
    colour = float(luminance(np.asarray(material.base_colour_rgba[:3], float)))
    return (1.0 - roughness / ROUGHEST) * (metallic * colour + (1.0 - metallic) * _COAT)


def _of(surfaces: Surfaces, part: int) -> slice:
    # The ground's triangles come last, after the parts in order.
    own = surfaces.part[: np.count_nonzero(surfaces.part >= 0)]
    return slice(*np.searchsorted(own, [part, part + 1]))


def _corners(surfaces: Surfaces, part: int) -> FloatArray:
    return surfaces.corners_m[_of(surfaces, part)] / surfaces.radius_m


def _areas(corners: FloatArray) -> FloatArray:
    """Area times normal (F, 3) of triangles (F, 3, 3)."""
    edges = corners[:, 1:] - corners[:, :1]
    return np.asarray(0.5 * np.cross(edges[:, 0], edges[:, 1]))


def _view(corners: FloatArray, normals: NDArray[np.float32]) -> _View:
    """The point and the direction from which a part's surroundings are seen."""
    lower, upper = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    centre, radius = 0.5 * (lower + upper), 0.5 * float(np.linalg.norm(upper - lower))
    area = _areas(corners)
    # On the side of the shading normals, as the frame has it.
    area[np.einsum("fi,fi->f", area, normals.sum(axis=1, dtype=np.float64)) < 0.0] *= -1.0
    volume = np.einsum("fi,fi->", corners.mean(axis=1) - centre, area) / 3.0
    least = _FLAT * radius * float(np.linalg.norm(area, axis=1).sum())
    facing = np.zeros(3)
    if abs(volume) <= least:
        facing = area.sum(axis=0)
        facing /= max(float(np.linalg.norm(facing)), 1e-30)
    return _View(centre + _BEFORE * radius * facing, radius, bool(volume < -least), facing)


class MirrorRays(NamedTuple):
    """Cubes (N) of the surroundings of parts, from the middle of each.

    Attributes:
        parts: the parts of the cubes.
        row: (U,) int32, rows of the table of rays that are seen, in order.
        target: (N, 6, e, e, S) int32, which of these each ray met; SKY for sky and open ground.
        nearness: (N, 6, e, e) float32, 1 / distance in 1 / radius, the mean of rays that met it; of
            the sky that of surfaces around it on the cube's face, 0 without any.
    """

    parts: MirrorParts
    row: NDArray[np.int32]
    target: NDArray[np.int32]
    nearness: Float32Array


def mirror_rays(
    parts: MirrorParts,
    part_of: NDArray[np.int32],
    tree: Tree,
    receivers: Receivers,
    threads: int,
    go_on: CancelCheck = always,
) -> MirrorRays | None:
    """Trace the cubes of parts, `part_of` (F,) being each triangle's.

    None where one point serves none of them.

    Raises:
        GivenUp: by `go_on`, which is asked before each cube.
    """
    if len(parts.part) == 0:
        return None

    geometry = receivers.geometry

    def trace(n: int, directions: Float32Array) -> tuple[NDArray[np.int32], Float32Array]:
        target = np.empty(len(directions), np.int32)
        near = np.empty(len(directions), np.float32)
        own, hollow = int(parts.part[n]), bool(parts.hollow[n])
        view = parts.centre[n], parts.facing[n], directions
        _trace(tree, receivers, part_of, own, hollow, view, scratch(), target, near)
        return target, near

    def serves(n: int) -> bool:
        go_on()
        return _share_from_middle(parts, n, part_of, geometry, tree, trace) >= _SERVED

    with ThreadPoolExecutor(threads) as pool:
        fits = np.array(list(pool.map(serves, range(len(parts.part)))))
        if not fits.any():
            return None
        edge = _edge(int(fits.sum()))
        directions = _directions(edge)
        cubes = list(pool.map(lambda n: trace(n, directions), np.flatnonzero(fits).tolist()))
    shape = (len(cubes), 6, edge, edge, _ACROSS**2)
    target = np.array([target for target, _ in cubes]).reshape(shape)
    met = (target != SKY).sum(axis=-1)
    near = np.array([near for _, near in cubes]).reshape(shape).sum(axis=-1)
    near /= np.maximum(met, np.float32(1.0))
    served = MirrorParts(
        parts.part[fits],
        parts.centre[fits],
        parts.radius[fits],
        parts.hollow[fits],
        parts.facing[fits],
    )
    seen = np.zeros(int(target.max()) + 1, bool)
    seen[target[target != SKY]] = True
    # The last entry is SKY's.
    number = np.append(np.cumsum(seen) - 1, SKY).astype(np.int32)
    return MirrorRays(
        served,
        np.flatnonzero(seen).astype(np.int32),
        number[target],
        _behind_openings(near, met == 0),
    )


def _edge(count: int) -> int:
    rays = 6 * _ACROSS**2 * count
    return next((e for e in _EDGES if e * e * rays <= _MOST_RAYS), _EDGES[-1])


def _share_from_middle(
    parts: MirrorParts,
    n: int,
    part_of: NDArray[np.int32],
    geometry: MapGeometry,
    tree: Tree,
    trace: _Traced,
) -> float:
    """Share of a part's surroundings in view from the middle of its cube; 0 without any.

    Random rays begin anywhere on the part; `trace` finds the nearest surfaces from the middle.
    """
    own = part_of == parts.part[n]
    corner, edge, other_edge = np.split(geometry.triangle[geometry.leaf[own]], 3, axis=1)
    area = np.linalg.norm(np.cross(edge, other_edge), axis=1)
    random = np.random.default_rng(0)
    chosen = random.choice(len(area), _TRIED, p=area / area.sum(dtype=float))
    across, along = random.random((2, _TRIED, 1))
    folded = across + along > 1.0
    across, along = np.where(folded, 1.0 - across, across), np.where(folded, 1.0 - along, along)
    normal = geometry.faces[own][chosen]
    place = corner[chosen] + across * edge[chosen] + along * other_edge[chosen] + _STEP * normal
    spread = random.normal(size=(_TRIED, 3))
    ray = normal + spread / np.linalg.norm(spread, axis=1, keepdims=True)
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    hit, distance = first_hits(tree, place, ray)
    met = hit != MISS
    if not met.any():
        return 0.0
    away = (place + distance[:, None] * ray)[met] - parts.centre[n]
    metres = np.linalg.norm(away, axis=1)
    _, near = trace(n, (away / metres[:, None]).astype(np.float32))
    return float(np.mean(np.abs(near * metres - 1.0) < _SAME_PLACE))


def _behind_openings(near: Float32Array, sky: NDArray[np.bool_]) -> Float32Array:
    """Nearness (..., e, e) in which openings to the sky are as near as their frames.

    A mirrored ray that leaves by a door must be seen to cross the door, not to end at infinity.
    Pull and push (Gortler et al. 1996, "The Lumigraph"): means of ever larger squares.
    """
    edge = near.shape[-1]
    if edge == 1:
        return near
    half = -(-edge // 2)
    size = (*near.shape[:-2], 2 * half, 2 * half)
    total, weight = np.zeros(size, np.float32), np.zeros(size, np.float32)
    total[..., :edge, :edge] = np.where(sky, 0.0, near)
    weight[..., :edge, :edge] = ~sky
    pieces = (*near.shape[:-2], half, 2, half, 2)
    sums = total.reshape(pieces).sum(axis=(-3, -1))
    known = weight.reshape(pieces).sum(axis=(-3, -1))
    coarse = _behind_openings(sums / np.maximum(known, 1.0), known == 0.0)
    fine = coarse.repeat(2, axis=-2).repeat(2, axis=-1)[..., :edge, :edge]
    return np.where(sky, fine, near).astype(np.float32)


def _directions(edge: int) -> Float32Array:
    """Unit directions (6 e e S, 3) of the rays, texel by texel."""
    fine = edge * _ACROSS
    c = texel_centres(fine)
    d = (
        FACE_NORMALS[:, None, None]
        + c[None, None, :, None] * FACE_S_AXES[:, None, None]
        + c[None, :, None, None] * FACE_T_AXES[:, None, None]
    )
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    pieces = d.reshape(6, edge, _ACROSS, edge, _ACROSS, 3).swapaxes(2, 3)
    return np.ascontiguousarray(pieces.reshape(-1, 3), np.float32)


@hot
def _trace(tree, receivers, part_of, own, hollow, view, scratch, target, near):  # type: ignore[no-untyped-def]
    """Fill in the row that each ray met, and its nearness.

    Backs of bodies are passed, and the part itself where it is not hollow. Rays behind a flat part
    are mirrored by it, so that its blurred images do not contain surfaces behind it.
    """
    centre, facing, directions = view
    geometry, texels, probes, groups = receivers
    stack, far_stack, _, _, place, _, _, ray = scratch
    first_group = len(texels.pixel) + len(probes.place)
    faces = geometry.faces
    for i in range(len(directions)):
        target[i], near[i] = SKY, 0.0
        travelled = np.float32(0.0)
        for k in range(3):
            place[k], ray[k] = centre[k], directions[i, k]
        behind_by = ray[0] * facing[0] + ray[1] * facing[1] + ray[2] * facing[2]
        if behind_by < 0.0:
            for k in range(3):
                ray[k] -= 2.0 * behind_by * facing[k]
        for _ in range(_MOST_PASSED):
            distance, hit, u, v = nearest_along(tree, place, ray, i, stack, far_stack)
            if hit == MISS:
                break
            t = tree.order[hit]
            behind = faces[t, 0] * ray[0] + faces[t, 1] * ray[1] + faces[t, 2] * ray[2] > 0.0
            passed = behind and groups.back[t] == NO_GROUP
            passed = passed or (part_of[t] == own and (behind or not hollow))
            ahead = distance + np.float32(_STEP) if passed else distance
            travelled += ahead
            for k in range(3):
                place[k] += ahead * ray[k]
            if passed:
                continue
            row = met_row(geometry, texels, groups, first_group, t, u, v, place, ray)
            if row != NOBODY:
                target[i], near[i] = row, np.float32(1.0) / max(travelled, np.float32(1e-6))
            break

"""Chooses the parts of a scene that get a cube map of their surroundings, and its centre."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.surfaces.surfaces import Surfaces
from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.scene_content import Material
from vrut_lite.numeric_types import BoolArray, FloatArray

# Rougher surfaces show no images.
ROUGHEST = 0.4
MOST = 16
# Reflectance of a coat, the mean over the visible half of a ball.
_COAT = 0.1
# Flat things are seen from so far before them, in halves of their diagonal.
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

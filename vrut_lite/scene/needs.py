"""Computes what a view requires: visible sky cube faces and air range."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.polarisation import UNPOLARISED_ROUGHNESS
from vrut_lite.messages.camera import MoveCamera, look_at, rays_through
from vrut_lite.messages.scene_content import MAP_NAMES, SceneMaterials
from vrut_lite.messages.scene_content import NONE as NO_IMAGE
from vrut_lite.messages.surface_terms import from_row

# Coarse directions represent whole texels, so the view is widened by a texel.
_PROBE_SIZE = 16
_MARGIN = 1.5 / _PROBE_SIZE
# Rays across the picture in each direction.
_BORDER_STEPS = 17
_WIDENED = 1.02


def visible_faces(camera: MoveCamera, aspect: float) -> tuple[tuple[int, ...], bool]:
    """Indices of the cube faces in view, and whether sky above the horizon is in view.

    Occlusion by the scene is ignored, so that the answer is conservative.
    """
    view = look_at(camera.eye_m, camera.target_m)
    directions = texel_directions(_PROBE_SIZE) @ view[:3, :3].T
    forward = -directions[..., 2]
    tangent = np.tan(0.5 * camera.vertical_field_of_view_rad)
    inside = (
        (forward > 0.0)
        & (np.abs(directions[..., 0]) <= forward * tangent * aspect + _MARGIN)
        & (np.abs(directions[..., 1]) <= forward * tangent + _MARGIN)
    )
    above = texel_directions(_PROBE_SIZE)[..., 1] > 0.0
    faces = tuple(int(face) for face in np.flatnonzero(inside.any(axis=(1, 2))))
    return faces, bool((inside & above).any())


def polarises(materials: SceneMaterials) -> bool:
    """Whether any material is a dielectric so smooth that its reflections of the sky are polarised.

    A map of roughness or metal counts as smooth and dielectric somewhere.
    """
    row = MAP_NAMES.index("metallic_roughness")
    mapped = materials.map_image.values[:, row] != NO_IMAGE
    smooth = materials.roughness.values < UNPOLARISED_ROUGHNESS
    coated = np.array([from_row(terms).clearcoat > 0.0 for terms in materials.terms.values])
    return bool(np.any(mapped | coated | (smooth & (materials.metallic.values < 1.0))))


def air_reach_m(
    camera: MoveCamera,
    aspect: float,
    lower_m: ArrayLike,
    upper_m: ArrayLike,
    ground_level_m: float,
) -> float:
    """Upper bound of the distance from the eye to anything in view, in m; 0 if nothing is.

    It covers the scene's bounds (3,), if their sphere reaches into the view, and the ground at
    `ground_level_m`: to the horizon if in view, else to where the highest ray meets it.
    """
    height_m = max(camera.eye_m[1] - ground_level_m, 0.0)
    scene_m = _scene_reach_m(camera, aspect, np.asarray(lower_m), np.asarray(upper_m))
    return max(scene_m, _ground_reach_m(height_m, *_heights_in_view(camera, aspect)))


def _scene_reach_m(camera: MoveCamera, aspect: float, lower_m: NDArray, upper_m: NDArray) -> float:
    """Distance to the scene's farthest corner, or 0 if its sphere is outside the view's cone."""
    to_centre = 0.5 * (lower_m + upper_m) - np.asarray(camera.eye_m)
    radius_m = 0.5 * float(np.linalg.norm(upper_m - lower_m))
    distance_m = float(np.linalg.norm(to_centre))
    if distance_m > radius_m:
        forward = np.asarray(camera.target_m) - np.asarray(camera.eye_m)
        cosine = forward @ to_centre / (np.linalg.norm(forward) * distance_m)
        tangent = np.tan(0.5 * camera.vertical_field_of_view_rad) * np.hypot(1.0, aspect)
        apart = np.arccos(np.clip(cosine, -1.0, 1.0)) - np.arcsin(radius_m / distance_m)
        if apart > np.arctan(_WIDENED * tangent):
            return 0.0
    farthest = np.maximum(np.abs(lower_m - camera.eye_m), np.abs(upper_m - camera.eye_m))
    return float(np.linalg.norm(farthest))


def _heights_in_view(camera: MoveCamera, aspect: float) -> tuple[float, float]:
    """The least and the greatest sine of elevation in the view."""
    steps = _WIDENED * np.linspace(-1.0, 1.0, _BORDER_STEPS)
    heights = rays_through(camera, aspect, *np.meshgrid(steps, steps))[..., 1]
    return float(heights.min()), float(heights.max())


def _ground_reach_m(height_m: float, lowest: float, highest: float) -> float:
    """Distance to the farthest ground between two sines of elevation, from a height; 0 if none."""
    radius_m = GROUND_RADIUS_M + height_m
    tangent_m2 = height_m * (GROUND_RADIUS_M + radius_m)
    horizon = -np.sqrt(tangent_m2) / radius_m
    if lowest >= horizon:
        return 0.0
    down_m = -radius_m * min(highest, horizon)
    root_m = np.sqrt(max(down_m * down_m - tangent_m2, 0.0))
    return float(tangent_m2 / max(down_m + root_m, 1e-300))

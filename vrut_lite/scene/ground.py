"""Test whether a scene contains a ground that reaches (nearly) to the horizon."""

import numpy as np

from vrut_lite.numeric_types import BoolArray, FloatArray
from vrut_lite.scene.loading import LoadedScene
from vrut_lite.scene.placed import PlacedMesh

# From an eye at 1.7 m an edge at 500 m lies 0.2 degrees below the horizon: a few pixels.
FAR_M = 500.0
# Width (m) from which a scene is a planet, whose sides a level ground would cut.
PLANETARY_M = 2e5
# Height (m) above which a scene floats, as a satellite does, and has no ground.
FLOATING_M = 1e4
_LEAST_COVER = 0.5
_LEAST_UP = np.cos(np.radians(45.0))


def has_own_ground(scene: LoadedScene) -> bool:
    """Whether the scene needs no added ground.

    The rule: in plan the scene reaches at least `FAR_M` from its middle to the east and west,
    north and south, and its triangles that face up (within 45 degrees) cover at least half of
    that rectangle, seen from above. Roofs count, which errs only for a city without streets. A
    scene that reaches `PLANETARY_M`, or that lies above `FLOATING_M`, needs none either.
    """
    if scene.lower_m[1] > FLOATING_M:
        return True
    half_m = (scene.upper_m - scene.lower_m)[[0, 2]] / 2.0
    if np.any(half_m < FAR_M):
        return False
    if np.all(half_m > PLANETARY_M):
        return True
    covered_m2 = sum(area[up].sum() for area, up in map(areas_from_above, scene.meshes))
    return bool(covered_m2 >= _LEAST_COVER * 4.0 * half_m[0] * half_m[1])


def areas_from_above(place: PlacedMesh) -> tuple[FloatArray, BoolArray]:
    """Area (F,) of each triangle seen from above, m^2, and whether it faces up (within 45 deg)."""
    a, b, c = np.moveaxis(place.world_triangles(), 1, 0)
    normal = np.cross(b - a, c - a)
    faces_up = normal[:, 1] > _LEAST_UP * np.linalg.norm(normal, axis=1)
    return np.abs(normal[:, 1]) / 2.0, faces_up

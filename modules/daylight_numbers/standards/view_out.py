"""The view out of a room by EN 17037:2018, clause 5.2 and annex C.

Rays from an eye over each sensor, seated, 1.2 m above the floor, that leave the room by its
openings: what they meet is the view. The width of the view is the angle around the eye in which
some ray leaves; its distance is the median one, from the opening's inner surface, of level rays
that leave. The layers are sky, landscape (upright things outside, and the horizon) and ground
(level surfaces outside).
"""

from typing import NamedTuple

import numpy as np
from light_transport.public import MISS, Tree, first_hits

from daylight_numbers.rooms import DaylitRoom
from daylight_numbers.work import DaylightWork
from vrut_lite.numeric_types import BoolArray, FloatArray, IntArray

LEVELS = ("none", "minimum", "medium", "high")
# EN 17037, table A.5: width (degrees), distance (m) and number of layers for each level.
WIDTH_DEG, DISTANCE_M, LAYERS = (14.0, 28.0, 54.0), (6.0, 20.0, 50.0), (1, 2, 3)
# Share of the utilised area that must have the view.
AREA = 0.75
_SEATED_M = 1.2
# Rays: so many around, and so many between the elevations (degrees) between which one looks.
_AROUND, _RISING, _UP_DEG = 180, 63, 62.0
# Elevation within which rays are level, and within which far ground and low sky are the horizon.
_LEVEL_DEG, _HORIZON_DEG = 6.0, 4.0
# Reveals, sills and frames: nearer things than this behind the inner surface are no view.
_REVEAL_M = 0.7
_GROUND_COSINE = 0.7
_MOST_EYES = 200


class ViewOut(NamedTuple):
    """View from eyes (N): width in degrees (N,), distance in m (N,), inf where nothing stands in
    the way, and which layers, sky, landscape and ground, are seen (N, 3)."""

    width_deg: FloatArray
    distance_m: FloatArray
    layers: BoolArray

    @property
    def levels(self) -> IntArray:
        """Place in LEVELS (N,) of each eye: the least by width, distance and layers."""
        sees_landscape = self.layers[:, 1]
        count = np.where(sees_landscape, self.layers.sum(axis=1), 0)
        each = [
            np.searchsorted(WIDTH_DEG, self.width_deg, side="right"),
            np.searchsorted(DISTANCE_M, self.distance_m, side="right"),
            np.searchsorted(LAYERS, count, side="right"),
        ]
        return np.asarray(np.min(each, axis=0))

    @property
    def level(self) -> str:
        """Level of LEVELS that three quarters of the area reach."""
        levels = self.levels
        reached = [n for n in range(len(LEVELS)) if (levels >= n).mean() >= AREA]
        return LEVELS[reached[-1]]


def view_out(work: DaylightWork, plane: int, room: DaylitRoom) -> ViewOut:
    """The view from eyes over the sensors of a room."""
    places = work.sensors.places_m[work.sensors.plane == plane]
    places = places[:: -(-len(places) // _MOST_EYES)].copy()
    places[:, 1] = room.box.lower_m[1] + _SEATED_M
    tree = work.transport.tree
    opacity = np.where(work.glass.clear[tree.order], np.float32(0.0), tree.opacity)
    tree = tree._replace(opacity=opacity)
    found = [_seen(work, tree, room, place) for place in places]
    width, distance, layers = (np.array(part) for part in zip(*found, strict=True))
    return ViewOut(width, distance, layers)


def _seen(
    work: DaylightWork, tree: Tree, room: DaylitRoom, place_m: FloatArray
) -> tuple[float, float, tuple[bool, bool, bool]]:
    elevation, towards = _looks()
    surfaces = work.transport.surfaces
    places = np.broadcast_to(place_m, towards.shape)
    hit, distance = first_hits(tree, (places - surfaces.centre_m) / surfaces.radius_m, towards)
    wall_m = room.box.exit_m(places, towards)
    beyond_m = np.where(hit == MISS, np.inf, distance.astype(float) * surfaces.radius_m) - wall_m
    leaves = beyond_m > _REVEAL_M
    if not leaves.any():
        return 0.0, 0.0, (False, False, False)
    columns = leaves.reshape(_AROUND, _RISING).any(axis=1)
    is_level = leaves & (np.abs(elevation) <= _LEVEL_DEG)
    away = beyond_m[is_level if is_level.any() else leaves]
    miss = hit == MISS
    up = work.transport.receivers.geometry.faces[np.where(miss, 0, hit), 1]
    below = np.where(
        miss, elevation < -_HORIZON_DEG, (np.abs(up) > _GROUND_COSINE) & (elevation < 0)
    )
    sky = miss & (elevation > _HORIZON_DEG)
    seen = [bool((leaves & kind).any()) for kind in (sky, ~sky & ~below, below)]
    width_deg = 360.0 / _AROUND * float(columns.sum())
    return width_deg, float(np.median(away)), (seen[0], seen[1], seen[2])


def _looks() -> tuple[FloatArray, FloatArray]:
    """Elevations (R,) in degrees and unit vectors (R, 3), _RISING of them in each azimuth."""
    azimuth = 2.0 * np.pi * (np.arange(_AROUND) + 0.5) / _AROUND
    elevation = np.linspace(-_UP_DEG, _UP_DEG, _RISING)
    turn, rise = np.meshgrid(azimuth, np.radians(elevation), indexing="ij")
    level = np.cos(rise)
    towards = np.stack([level * np.sin(turn), np.sin(rise), -level * np.cos(turn)], axis=-1)
    return np.tile(elevation, _AROUND), towards.reshape(-1, 3)

"""The box of a room, and through which of its sides light comes in: its window groups.

Blinds hang in groups, a group a side. Where a scene has openings without panes, walls alone tell
where they are: what reaches a room from beyond a side came through the openings of that side.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.ray_scene import RayScene
from light_transport.rays.trace import MISS, first_hits
from vrut_lite.numeric_types import FloatArray

SIDES = ("-x (west)", "+x (east)", "below", "roof", "-z (north)", "+z (south)")
ROOF = 3
# A room's side lies where at least this share of the level rays to it ends, or nearer: the others
# leave by openings.
_WALL_SHARE = 0.25
_SAME_PLANE, _OFF = 0.95, 1e-5
_FAR = 1e6
# A place on a wall counts as within the room, in metres.
_ON_WALL_M = 0.02


class RoomBox(NamedTuple):
    """Lower and upper corner (3,) of a room, in metres, world axes; `is_open` (6,): which of SIDES
    have openings, as far as that is known."""

    lower_m: FloatArray
    upper_m: FloatArray
    is_open: NDArray[np.bool_] = np.ones(len(SIDES), bool)

    def holds(self, places_m: FloatArray) -> NDArray[np.bool_]:
        """Which places (N, 3) lie within, or on its walls."""
        inside = (places_m > self.lower_m - _ON_WALL_M) & (places_m < self.upper_m + _ON_WALL_M)
        return np.asarray(inside.all(axis=-1))

    def exit_m(self, places_m: FloatArray, towards: FloatArray) -> FloatArray:
        """How far (N,) it is from places (N, 3) within along unit vectors (N, 3) to a side."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.where(towards > 0.0, self.upper_m, self.lower_m)
            ahead = np.where(towards == 0.0, np.inf, (ends - places_m) / towards)
        return np.asarray(np.maximum(ahead.min(axis=-1), 0.0))

    def side_of(self, places_m: FloatArray, towards: FloatArray) -> NDArray[np.int8]:
        """The open side (N,) by which straight ways from places (N, 3) towards directions leave."""
        place = np.clip(places_m, self.lower_m, self.upper_m)
        up = towards > 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            ahead = np.where(up, self.upper_m - place, self.lower_m - place) / towards
        # Places and directions are means, which may miss an opening beside a shut side.
        shut = ~self.is_open[2 * np.arange(3) + up]
        ahead = np.where(towards == 0.0, np.inf, np.where(shut, _FAR * (1.0 + ahead), ahead))
        axis = np.argmin(ahead, axis=-1)
        return np.asarray(
            2 * axis + np.take_along_axis(up, axis[..., None], axis=-1)[..., 0], np.int8
        )


def room_box(scene: RayScene, places_m: FloatArray, step_m: float) -> RoomBox | None:
    """The box around sensors (P, 3), half a cell of `step_m` beyond those where no wall is met.

    None where most have no roof above them.
    """
    radius, centre = scene.surfaces.radius_m, scene.surfaces.centre_m
    faces = scene.receivers.geometry.faces
    lower, upper = places_m.min(axis=0), places_m.max(axis=0)
    sides = lower.copy(), upper.copy()
    for axis in (1, 0, 2):
        for up in (False, True):
            direction = np.zeros(3)
            direction[axis] = 1.0 if up else -1.0
            towards = np.tile(direction, (len(places_m), 1))
            hit, distance = first_hits(
                scene.tree, (places_m - centre) / radius + _OFF * towards, towards
            )
            met = (hit != MISS) & (np.abs(faces[np.where(hit == MISS, 0, hit), axis]) > _SAME_PLANE)
            away = distance.astype(float) * radius * direction[axis]
            at = np.where(met, places_m[:, axis] + away, np.inf * direction[axis])
            edge = (upper if up else lower)[axis]
            beyond = at[at >= edge] if up else at[at <= edge]
            share = _WALL_SHARE if up else 1.0 - _WALL_SHARE
            found = np.quantile(beyond, share, method="nearest") if len(beyond) else np.inf
            if not np.isfinite(found):
                if axis == 1:
                    return None
                found = edge + 0.5 * step_m * direction[axis]
            sides[up][axis] = found
    return RoomBox(*sides)

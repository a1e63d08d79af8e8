"""Bearing and length ratio of a shadow from clicked points, in the scene or in a picture."""

from typing import NamedTuple

import numpy as np

from vrut_lite.errors import UserError
from vrut_lite.geometry.frames import angles_from_direction, enu_from_world
from vrut_lite.numeric_types import Vector

# Shorter shadows have no direction: metres, pixels.
_SHORTEST_M, _SHORTEST_PX = 1e-3, 2.0


class ClickedShadow(NamedTuple):
    """A shadow's bearing, degrees clockwise from true north, and its ratio if it is known."""

    bearing_deg: float
    length_ratio: float | None


def shadow_in_scene(
    foot_m: Vector, tip_m: Vector, top_m: Vector | None, north_offset_rad: float
) -> ClickedShadow:
    """The shadow of a vertical object by points in world axes.

    The ratio is that of the ray from the object's top to the tip: the ground need not be level.

    Raises:
        UserError: foot and tip are one point, or the top is not above the tip.
    """
    along = enu_from_world(np.subtract(tip_m, foot_m), north_offset_rad)
    length_m = float(np.hypot(along[0], along[1]))
    if length_m < _SHORTEST_M:
        raise UserError("foot and tip of the shadow are one point: click them apart")
    bearing_deg = float(np.degrees(angles_from_direction(along)[0]))
    if top_m is None:
        return ClickedShadow(bearing_deg, None)
    east, north, up = enu_from_world(np.subtract(top_m, tip_m), north_offset_rad)
    if up < _SHORTEST_M:
        raise UserError("the top of the object is not above the tip of its shadow: click it again")
    return ClickedShadow(bearing_deg, float(np.hypot(east, north) / up))


def shadow_in_picture(
    foot_px: tuple[float, float],
    tip_px: tuple[float, float],
    up_bearing_deg: float,
    height_px: float | None,
) -> ClickedShadow:
    """The shadow by points (x, y), y down, of a picture that looks straight down.

    Args:
        foot_px, tip_px: foot and tip of the shadow.
        up_bearing_deg: the bearing of the picture's upward direction; 0 for north up.
        height_px: the object's height in the picture's own scale; None if it is not known.

    Raises:
        UserError: foot and tip are one point.
    """
    right, down = np.subtract(tip_px, foot_px)
    length_px = float(np.hypot(right, down))
    if length_px < _SHORTEST_PX:
        raise UserError("foot and tip of the shadow are one point: click them apart")
    bearing_deg = float(np.degrees(np.arctan2(right, -down)) + up_bearing_deg) % 360.0
    return ClickedShadow(bearing_deg, length_px / height_px if height_px else None)

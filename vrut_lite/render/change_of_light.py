"""Whether a picture may reuse pixels of the previous one, and their change of light."""

import math

import numpy as np

from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.installed_parts import may_reuse_surfaces
from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.scene_state import SceneState

# Parts of a state that must be identical for reprojection.
_KEPT = ("scene", "section", "shows", "tolerance", "polariser_deg")
# Parts that change with the hour.
_LIGHT = ("key_light", "background", "ambient", "sky_light", "polarisation")
# Limits of reprojection: move of the sun, and ratio of the light.
_LARGEST_MOVE_RAD, _LARGEST_RATIO = 0.026, 1.1
_UP = (0.0, 1.0, 0.0)


def change_of_light(before: SceneState, now: SceneState) -> FloatArray | None:
    """Ratio (3,) of the light to that before, None if the previous picture cannot be reused.

    While time plays both suns are close together; any other change of light is shown at once.
    """
    if any(getattr(before, name) is not getattr(now, name) for name in _KEPT):
        return None
    is_same = all(getattr(before, name) is getattr(now, name) for name in _LIGHT)
    if not may_reuse_surfaces(before.parts, now.parts, hour_moved=not is_same):
        return None
    if is_same:
        return np.ones(3)
    old, new = before.key_light, now.key_light
    assert old is not None
    assert new is not None
    moved = math.dist(new.direction, old.direction)
    if not 0.0 < moved < _LARGEST_MOVE_RAD:
        return None
    ratio = _level(now) / np.maximum(_level(before), 1e-20)
    bounded = np.all((ratio < _LARGEST_RATIO) & (ratio > 1.0 / _LARGEST_RATIO))
    return ratio if bounded else None


def _level(state: SceneState) -> FloatArray:
    """Irradiance (3,) of the sky on level, unobstructed ground."""
    assert state.sky_light is not None
    return np.asarray(evaluate_irradiance(state.sky_light.ambient.irradiance_sh_rgb.values, _UP))

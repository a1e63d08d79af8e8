"""Selection of the shadow maps that a mesh samples in sun_shadow.glsl.

A mesh entirely inside or outside the near map's rim needs one map only: a software renderer spends
as much on the other's look-ups whether their result is used or not.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.light import Shadow, Shadows, StillShadow
from vrut_lite.render.passes.view import View, translation
from vrut_lite.render.pyrender_scene import PlacedPrimitive
from vrut_lite.render.shader_files import Defines

SHADOW_UNIT, _NEAR_SHADOW_UNIT, _GLASS_SHADOW_UNIT = 9, 15, 23
_RANGES_UNIT, _NEAR_RANGES_UNIT = 29, 30
_STILL_UNIT, _STILL_RANGES_UNIT = 34, 35
# Blend width of the near map as a fraction of its half width, as in sun_shadow.glsl.
NEAR_RIM = 0.25
# Of a hole's radius, for the sides of its polygon and the ground's curvature.
_SURELY_IN_HOLE = 0.99


def bind_shadows(shadows: Shadows) -> None:
    """Bind the textures for all meshes."""
    if shadows.still is not None:
        shadows.still.texture.use(location=_STILL_UNIT)
        shadows.still.ranges.use(location=_STILL_RANGES_UNIT)
        if shadows.still.tint is not None:
            shadows.still.tint.use(location=_GLASS_SHADOW_UNIT)
        return
    assert shadows.scene is not None
    shadows.scene.texture.use(location=SHADOW_UNIT)
    shadows.scene.ranges.use(location=_RANGES_UNIT)
    if shadows.near is not None:
        shadows.near.texture.use(location=_NEAR_SHADOW_UNIT)
        shadows.near.ranges.use(location=_NEAR_RANGES_UNIT)
    nearest = shadows.near or shadows.scene
    if nearest.tint is not None:
        nearest.tint.use(location=_GLASS_SHADOW_UNIT)


OnMesh = tuple[Defines, dict[str, Any]]


def shadows_on(
    placed: PlacedPrimitive, shadows: Shadows, view: View, known: dict[str, OnMesh]
) -> OnMesh:
    """Defines and uniforms of a mesh's program.

    `known` caches the results of the picture's other meshes: a program need not compare the values
    of an identical object.
    """
    kind, make = _maps_of(placed, shadows, view)
    if kind not in known:
        known[kind] = make()
    return known[kind]


def _maps_of(
    placed: PlacedPrimitive, shadows: Shadows, view: View
) -> tuple[str, Callable[[], OnMesh]]:
    """Name of the maps that a mesh needs, and the maker of their defines and uniforms."""
    still = shadows.still
    if still is not None:
        return "still", lambda: _squares(still)
    near, scene = shadows.near, shadows.scene
    assert scene is not None
    if scene.tint is not None:
        return "all", lambda: _all_maps(scene, near, view)
    if near is not None:
        off = near.matrix[:2, :3] @ (placed.centre_m - near.centre_m)
        radius = placed.radius_m * float(np.linalg.norm(near.matrix[0, :3]))
        # The receiver is offset from its surface by a few texels.
        radius += 5.0 * near.texel_m * float(np.linalg.norm(near.matrix[0, :3]))
        if np.max(np.abs(off)) + radius <= 1.0 - NEAR_RIM:
            units = _NEAR_SHADOW_UNIT, _NEAR_RANGES_UNIT
            return "near", lambda: ((), _uniforms("shadow", near, view, *units))
        if np.max(np.abs(off)) - radius <= 1.0:
            return "all", lambda: _all_maps(scene, near, view)
    elif placed.is_ground and lies_in_hole(scene, placed):
        return "none", lambda: (("NO_SHADOW",), {})
    return "scene", lambda: ((), _uniforms("shadow", scene, view, SHADOW_UNIT, _RANGES_UNIT))


def lies_in_hole(shadow: Shadow, ground: PlacedPrimitive) -> bool:
    """Whether all of the ground in a shadow map lies in the hole of a part of the ground disc."""
    world_from_map = np.linalg.inv(shadow.matrix[:3, :3])
    along = world_from_map[:, 2]
    if along[1] == 0.0:
        return False
    corners = np.array([(x, y, 0.0) for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    place_m = shadow.centre_m - ground.centre_m + corners @ world_from_map.T
    place_m -= place_m[:, 1:2] / along[1] * along
    return bool(np.linalg.norm(place_m[:, ::2], axis=1).max() < _SURELY_IN_HOLE * ground.hole_m)


def _all_maps(scene: Shadow, near: Shadow | None, view: View) -> OnMesh:
    defines: Defines = ("GLASS_SHADOW",) if scene.tint is not None else ()
    uniforms = _uniforms("shadow", scene, view, SHADOW_UNIT, _RANGES_UNIT)
    if near is None:
        return defines, uniforms
    of_near = _uniforms("near_shadow", near, view, _NEAR_SHADOW_UNIT, _NEAR_RANGES_UNIT)
    return (*defines, "NEAR_SHADOW"), uniforms | of_near


def _squares(still: StillShadow) -> OnMesh:
    glass: Defines = ("GLASS_SHADOW",) if still.tint is not None else ()
    uniforms = {
        "shadow_axes": still.axes,
        "shadow_squares": still.squares,
        "shadow_depths": still.depths,
        "shadow_spread": float(still.spread),
    }
    return (*glass, "STILL_SHADOW"), uniforms


def _uniforms(name: str, shadow: Shadow, view: View, unit: int, ranges_unit: int) -> dict[str, Any]:
    return {
        f"{name}_matrix": shadow_from_eye(shadow, view),
        f"{name}_texel_m": float(shadow.texel_m),
        f"{name}_map": unit,
        f"{name}_ranges": ranges_unit,
        f"{name}_spread": float(shadow.spread),
        f"{name}_aspect": float(shadow.aspect),
    }


def shadow_from_eye(shadow: Shadow, view: View) -> NDArray[np.float64]:
    """Matrix (4, 4) of positions relative to the eye into the shadow map's clip space."""
    return np.asarray(shadow.matrix @ translation(view.eye_m - shadow.centre_m))

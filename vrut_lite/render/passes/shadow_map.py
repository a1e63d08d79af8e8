"""The sun's shadow maps: orthographic depth from the sun, of the scene, and finer of a part of it.

Each holds all the scene's depth, so that penumbras are as wide as their casters are far away.

In a scene of kilometres a texel of one map is metres wide, too wide for shadows of a person's size.
A second map then covers the eye's surroundings. In smaller ones it covers what a finished still
shows, if that is less than half of the scene. Each is drawn when scene, sun or place have changed,
in quick pictures with a quarter of the texels, and when the sun has moved by its own width.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.kernel.ledger import Ledger
from vrut_lite.render.light import Light, Shadow, Shadows
from vrut_lite.render.passes.mesh_renderer import MeshRenderer
from vrut_lite.render.passes.shadow_ranges import ShadowRanges
from vrut_lite.render.passes.shadows_on_mesh import NEAR_RIM
from vrut_lite.render.passes.view import View
from vrut_lite.render.pyrender_scene import PyrenderScene

SHADOW_SIZE, QUICK_SIZE = 4096, 2048
# Half the width of the near map: its texels are then a hand's breadth.
NEAR_RADIUS_M = 400.0
# One map is enough for a scene that is not many times larger.
_LARGE_RADII = 4.0
# The near map follows the eye in steps of this share of its radius. Its rim fades over more.
_STEP = 1.0 / 64.0
# What a still shows has a map of its own up to this share of the scene.
_SHOWN_SHARE = 0.5
_GRID = 9


class ShadowMap:
    """A depth texture; made and used on the GL thread only.

    The ledger counts its name as done, and as skipped without sun or where scene, sun and place are
    unchanged.
    """

    def __init__(
        self, context: Any, ledger: Ledger, name: str = "shadow map", size: int = SHADOW_SIZE
    ):
        self._ledger = ledger
        self._name = name
        self._size = size
        self._texture = context.depth_texture((size, size))
        self._texture.compare_func = "<="
        self._texture.filter = (context.LINEAR, context.LINEAR)
        self._buffer = context.framebuffer(depth_attachment=self._texture)
        self._ranges = ShadowRanges(context, size)
        self._context = context
        self._tint: Any = None
        self._tint_buffer: Any = None
        self._tint_alone: Any = None
        self._drawn: tuple[Any, ...] = ()

    def update(
        self,
        meshes: MeshRenderer,
        scene: PyrenderScene,
        light: Light,
        centre_m: NDArray[np.float64],
        radius_m: float,
        always: bool,
    ) -> Shadow:
        """The shadows in a sphere of the scene; `always` draws them also when nothing changed."""
        depth_m = scene.radius_m + float(np.linalg.norm(centre_m - scene.centre_m))
        texel_m = 2.0 * radius_m / self._size
        shadow = Shadow(
            texture=self._texture,
            matrix=light_matrix(light.sun_direction, radius_m, depth_m),
            texel_m=texel_m,
            centre_m=centre_m,
            tint=self._tint_of(scene),
            ranges=self._ranges.texture,
            spread=math.tan(light.sun_radius_rad) * 2.0 * depth_m / texel_m,
            aspect=radius_m / depth_m,
        )
        now = _content(scene, light, centre_m, radius_m)
        if not always and not any(light.sun_irradiance):
            self._ledger.skip(f"{self._name}: no sun to cast one")
        elif not always and self._drawn == now:
            self._ledger.skip(f"{self._name}: same scene, same sun")
        else:
            self._buffer.use()
            self._buffer.clear()
            meshes.draw_depth(scene, shadow)
            if shadow.tint is not None:
                self._tint_alone.clear(1.0, 1.0, 1.0, 1.0)
                # With the depth: what is behind solid things tints nothing.
                self._tint_buffer.use()
                meshes.draw_tint(scene, shadow, self._size)
            self._ranges.update(self._texture)
            self._drawn = now
            self._ledger.did(self._name)
        return shadow

    def shows(
        self, scene: PyrenderScene, light: Light, centre_m: NDArray[np.float64], radius_m: float
    ) -> bool:
        """Whether it was drawn for this scene, sun and place."""
        return self._drawn == _content(scene, light, centre_m, radius_m)

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        for thing in (self._tint_buffer, self._tint_alone, self._tint, self._buffer, self._texture,
                      self._ranges):  # fmt: skip
            if thing is not None:
                thing.release()

    def _tint_of(self, scene: PyrenderScene) -> Any:
        """The texture of what glass leaves, made when a scene first has some."""
        if not scene.dims_sun:
            return None
        if self._tint is None:
            size = (self._size, self._size)
            self._tint = self._context.texture(size, 4, dtype="f2")
            self._tint.repeat_x = self._tint.repeat_y = False
            self._tint_buffer = self._context.framebuffer([self._tint], self._texture)
            self._tint_alone = self._context.framebuffer([self._tint])
        return self._tint


class ShadowMaps:
    """The scene's map, and one around the eye, each made when it is first needed.

    A quick picture draws maps of fewer texels, unless the fine ones are of its sun, or shows those
    of a sun that stood less than its diameter away: shadows then lie within half of their penumbra.
    """

    def __init__(self, context: Any, ledger: Ledger):
        self._context = context
        self._ledger = ledger
        self._maps: dict[tuple[str, int], ShadowMap] = {}
        # Of the sun whose maps were drawn last.
        self._direction = (0.0, 0.0, 0.0)

    def update(
        self,
        meshes: MeshRenderer,
        scene: PyrenderScene,
        light: Light,
        view: View,
        always: bool,
        quick: bool = False,
        finished: bool = False,
    ) -> Shadows:
        """The shadows that a view shows; `always` draws them also when nothing changed."""
        moved = math.dist(light.sun_direction, self._direction)
        if quick and moved < 2.0 * light.sun_radius_rad:
            light = replace(light, sun_direction=self._direction)
        self._direction = light.sun_direction

        def shadow(name: str, centre_m: NDArray[np.float64], radius_m: float) -> Shadow:
            # A fine map is not made only to be asked: the first picture would wait for it.
            fine = self._maps.get((name, SHADOW_SIZE))
            is_fine = not quick or (
                fine is not None and fine.shows(scene, light, centre_m, radius_m)
            )
            size = SHADOW_SIZE if is_fine else QUICK_SIZE
            return self._map(name, size).update(meshes, scene, light, centre_m, radius_m, always)

        bounds = scene.centre_m, scene.radius_m
        whole = shadow("shadow map", *bounds)
        centre_m, radius_m = near_centre_m(view.eye_m, light.sun_direction, *bounds), NEAR_RADIUS_M
        if centre_m is None and finished:
            centre_m, radius_m = shown_cylinder_m(
                view, light.sun_direction, scene.centre_m, scene.half_extent_m
            )
            if radius_m > _SHOWN_SHARE * scene.radius_m:
                centre_m = None
        if centre_m is None:
            return Shadows(whole, None)
        return Shadows(whole, shadow("near shadow map", centre_m, radius_m))

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        for each in self._maps.values():
            each.release()

    def _map(self, name: str, size: int) -> ShadowMap:
        if (name, size) not in self._maps:
            self._maps[name, size] = ShadowMap(self._context, self._ledger, name, size)
        return self._maps[name, size]


def _content(
    scene: PyrenderScene, light: Light, centre_m: NDArray[np.float64], radius_m: float
) -> tuple[PyrenderScene, Any, tuple[float, ...]]:
    """What a map is drawn of."""
    return scene, light.sun_direction, (*centre_m, radius_m)


def light_matrix(direction: ArrayLike, radius_m: float, depth_m: float) -> NDArray[np.float64]:
    """Clip matrix (4, 4), a cylinder to [-1, 1]^3, of a sun in world `direction` (3,).

    Positions count from the cylinder's centre, in world axes; it reaches `depth_m` towards the sun
    and away. Shadows fall along the view direction, so what lies outside is covered in x and y by
    whatever casts on it; only its depth exceeds 1, which the look-up clamps.
    """
    view = np.eye(4)
    view[:3, :3] = _light_axes(direction)
    return np.diag([1.0 / radius_m, 1.0 / radius_m, -1.0 / depth_m, 1.0]) @ view


def near_centre_m(
    eye_m: ArrayLike, direction: ArrayLike, scene_centre_m: ArrayLike, scene_radius_m: float
) -> NDArray[np.float64] | None:
    """Centre (3,) of the near map's sphere, None where the scene's own map is enough.

    It lies on a grid in the sun's axes, so that a step of the eye moves no texel to half its
    place, and most steps move none at all.
    """
    away_m = np.asarray(eye_m, dtype=float) - scene_centre_m
    large = scene_radius_m > _LARGE_RADII * NEAR_RADIUS_M
    if not large or np.linalg.norm(away_m) > scene_radius_m + NEAR_RADIUS_M:
        return None
    axes, step_m = _light_axes(direction), _STEP * NEAR_RADIUS_M
    return np.add(scene_centre_m, step_m * np.round(axes @ away_m / step_m) @ axes)


def shown_cylinder_m(
    view: View, direction: ArrayLike, centre_m: NDArray[np.float64], half_m: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Centre (3,) and radius, along the sun, of what a view shows of a box, with the rim.

    Of an even grid of rays, so a little less at corners; infinite where nothing is shown.
    """
    across, up, _, depth = view.clip_from_eye[:, :3]
    a, b = np.meshgrid(np.linspace(-1.0, 1.0, _GRID), np.linspace(-1.0, 1.0, _GRID))
    rays = np.cross(across - a[..., None] * depth, up - b[..., None] * depth).reshape(-1, 3)
    rays *= np.sign(rays @ depth)[:, None]
    from_eye = centre_m - view.eye_m
    with np.errstate(divide="ignore", invalid="ignore"):
        sides = np.sort([(from_eye - half_m) / rays, (from_eye + half_m) / rays], axis=0)
    first, last = np.maximum(np.nanmax(sides[0], axis=1), 0.0), np.nanmin(sides[1], axis=1)
    met = first < last
    if not met.any():
        return centre_m, math.inf
    ends = [rays[met] * reach[met, None] for reach in (first, last)]
    axes = _light_axes(direction)
    seen = np.concatenate(ends) @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    radius_m = 0.5 * float(np.max(high - low, where=[True, True, False], initial=0.0))
    return view.eye_m + 0.5 * (low + high) @ axes, radius_m / (1.0 - NEAR_RIM)


def _light_axes(direction: ArrayLike) -> NDArray[np.float64]:
    """Rows right, up and towards the sun (3, 3)."""
    towards_sun = np.asarray(direction, dtype=float)
    towards_sun = towards_sun / np.linalg.norm(towards_sun)
    return np.array([*_perpendicular(towards_sun), towards_sun])


def _perpendicular(axis: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors that make a right-handed frame with a unit vector, without a bad case."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    right = np.cross(helper, axis)
    right /= np.linalg.norm(right)
    return right, np.cross(axis, right)

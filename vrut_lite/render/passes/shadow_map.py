"""The sun's shadow maps: orthographic depth of the whole scene and, finer, around the eye.

Each spans the whole scene's depth, so that penumbra widths follow the casters' distances.

In a scene of kilometres a texel of one map is metres wide, too wide for shadows of a person's size.
A second map then covers the eye's surroundings. Maps are redrawn when scene, sun or place change,
in quick pictures with fewer texels and when the sun has moved by its diameter. Finished stills use
`StillShadowMap`.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.render.light import Light, Shadow, Shadows
from vrut_lite.render.passes.light_axes import light_axes, light_matrix
from vrut_lite.render.passes.mesh_renderer import MeshRenderer
from vrut_lite.render.passes.shadow_textures import ShadowTextures
from vrut_lite.render.passes.still_shadow import StillShadowMap
from vrut_lite.render.passes.view import View
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene

# Texels along an edge for stills, quick pictures, and quick pictures up to _FEW_PX wide.
_SIZES, _FEW_PX = (4096, 2048, 1024), 512
SHADOW_SIZE = _SIZES[0]
# Half the width of the near map; a texel of a still's map is 0.2 m wide.
NEAR_RADIUS_M = 400.0
# Scene radius from which a near map is drawn, in units of its radius.
_LARGE_RADII = 4.0
# Step of the near map's centre, as a fraction of its radius; its rim fades over more.
_STEP = 1.0 / 64.0


class ShadowMap:
    """A depth texture; made and used on the GL thread only.

    The counters count its name as done, and as skipped without sun or where scene, sun and place
    are unchanged.
    """

    def __init__(
        self,
        context: Any,
        counters: WorkCounters,
        name: str = "shadow map",
        size: int = SHADOW_SIZE,
    ):
        self._counters = counters
        self._name = name
        self._size = size
        self._textures = ShadowTextures(context, size)
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
        """The shadows in a sphere of the scene; `always` draws them without a change too."""
        depth_m = scene.radius_m + float(np.linalg.norm(centre_m - scene.centre_m))
        texel_m = 2.0 * radius_m / self._size
        shadow = Shadow(
            texture=self._textures.depth,
            matrix=light_matrix(light.sun_direction, radius_m, depth_m),
            texel_m=texel_m,
            centre_m=centre_m,
            tint=self._textures.tint_of(scene),
            ranges=self._textures.ranges,
            spread=math.tan(light.sun_radius_rad) * 2.0 * depth_m / texel_m,
            aspect=radius_m / depth_m,
        )
        now = _content(scene, light, centre_m, radius_m)
        if not always and not any(light.sun_irradiance):
            self._counters.skip(f"{self._name}: no sun to cast one")
        elif not always and self._drawn == now:
            self._counters.skip(f"{self._name}: same scene, same sun")
        else:
            self._textures.draw(meshes, scene, [(shadow, (0, 0))], self._size)
            self._drawn = now
            self._counters.did(self._name)
        return shadow

    def shows(
        self, scene: PyrenderScene, light: Light, centre_m: NDArray[np.float64], radius_m: float
    ) -> bool:
        """Whether it was drawn for this scene, sun and place."""
        return self._drawn == _content(scene, light, centre_m, radius_m)

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        self._textures.release()


class ShadowMaps:
    """The scene's map, one around the eye and that of stills, each created on first use.

    A quick picture draws maps of fewer texels, unless finer ones show its sun. It reuses the maps
    of a sun less than a diameter away: shadows are then displaced by less than a penumbra's width.
    """

    def __init__(self, context: Any, counters: WorkCounters):
        self._context = context
        self._counters = counters
        self._maps: dict[tuple[str, int], ShadowMap] = {}
        # Direction of the sun whose maps were drawn last.
        self._direction = (0.0, 0.0, 0.0)
        self._still: StillShadowMap | None = None

    def update(
        self,
        meshes: MeshRenderer,
        scene: PyrenderScene,
        light: Light,
        view: View,
        always: bool,
        size: int = SHADOW_SIZE,
    ) -> Shadows:
        """The shadows of a view; `always` draws them without a change too."""
        moved = math.dist(light.sun_direction, self._direction)
        if size < SHADOW_SIZE and moved < 2.0 * light.sun_radius_rad:
            light = replace(light, sun_direction=self._direction)
        self._direction = light.sun_direction

        def shadow(name: str, centre_m: NDArray[np.float64], radius_m: float) -> Shadow:
            # Only existing finer maps count: creating one here would delay the first picture.
            finer = [self._maps.get((name, other)) for other in _SIZES if other > size]
            of_sun = (m for m in finer if m and m.shows(scene, light, centre_m, radius_m))
            shown = next(of_sun, None) or self._map(name, size)
            return shown.update(meshes, scene, light, centre_m, radius_m, always)

        bounds = scene.centre_m, scene.radius_m
        whole = shadow("shadow map", *bounds)
        centre_m, radius_m = near_centre_m(view.eye_m, light.sun_direction, *bounds), NEAR_RADIUS_M
        if centre_m is None:
            return Shadows(whole, None)
        return Shadows(whole, shadow("near shadow map", centre_m, radius_m))

    def of_still(
        self,
        meshes: MeshRenderer,
        scene: PyrenderScene,
        seen: list[PlacedPrimitive],
        light: Light,
        view: View,
        size_px: tuple[int, int],
        always: bool,
        in_air: bool,
    ) -> Shadows:
        """The shadows of a finished still; the scene's map too if they are visible `in_air`."""
        if self._still is None:
            self._still = StillShadowMap(self._context, self._counters)
        still = self._still.update(meshes, scene, seen, light, view, size_px, always)
        whole = None
        if in_air:
            whole = self._map("shadow map", SHADOW_SIZE).update(
                meshes, scene, light, scene.centre_m, scene.radius_m, always
            )
        return Shadows(whole, None, still)

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        for each in self._maps.values():
            each.release()
        if self._still is not None:
            self._still.release()

    def _map(self, name: str, size: int) -> ShadowMap:
        if (name, size) not in self._maps:
            self._maps[name, size] = ShadowMap(self._context, self._counters, name, size)
        return self._maps[name, size]


def quick_size(width_px: int) -> int:
    """Texels along an edge of a quick picture's map."""
    return _SIZES[1 if width_px > _FEW_PX else 2]


def _content(
    scene: PyrenderScene, light: Light, centre_m: NDArray[np.float64], radius_m: float
) -> tuple[PyrenderScene, Any, tuple[float, ...]]:
    """Inputs of a map, to compare."""
    return scene, light.sun_direction, (*centre_m, radius_m)


def near_centre_m(
    eye_m: ArrayLike, direction: ArrayLike, scene_centre_m: ArrayLike, scene_radius_m: float
) -> NDArray[np.float64] | None:
    """Centre (3,) of the near map's sphere, None where the scene's own map is enough.

    It is snapped to a grid in the sun's axes: a step of the eye moves texels by whole texels, and
    most steps move none.
    """
    away_m = np.asarray(eye_m, dtype=float) - scene_centre_m
    large = scene_radius_m > _LARGE_RADII * NEAR_RADIUS_M
    if not large or np.linalg.norm(away_m) > scene_radius_m + NEAR_RADIUS_M:
        return None
    axes, step_m = light_axes(direction), _STEP * NEAR_RADIUS_M
    return np.add(scene_centre_m, step_m * np.round(axes @ away_m / step_m) @ axes)

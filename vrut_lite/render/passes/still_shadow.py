"""The sun's shadow map of a finished still: four squares, the finer ones nearer to the eye.

They are fitted to the visible points (Lauritzen et al. 2010, "Sample distribution shadow maps"), so
that texels have a similar size in pixels near and far: a penumbra too narrow for the map is too
narrow for the picture. Each spans the depth of its casters only, which resolves centimetres in a
landscape too.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.numeric_types import FloatArray
from vrut_lite.render.light import Light, Shadow, StillShadow
from vrut_lite.render.passes.light_axes import light_axes, light_matrix
from vrut_lite.render.passes.mesh_renderer import MeshRenderer
from vrut_lite.render.passes.seen_points import SeenGrid, SeenPoints
from vrut_lite.render.passes.shadow_textures import ShadowTextures
from vrut_lite.render.passes.view import View
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene

# As in sun_shadow.glsl: squares, two in a row, texels along a side, and the fraction of their half
# width inside which the widest filter stays in a square.
SQUARES, SQUARE_TEXELS, INSIDE = 4, 2048, 1.0 - 2.0 * 132.0 / 2048.0
# Largest penumbra radius (texels).
MOST_RADIUS = 128.0
# Finest and coarsest texel (pixels): a quarter would do, but a low sun stretches it on the ground.
_FINEST_PX, _COARSEST_PX = 1.0 / 16.0, 1e6
# Margins of width and depth for visible points between those of the grid.
_ROOM, _DEEPER = 1.03, 1.1
_HALVINGS = 24
# Relative rounding error of depths and of vertices, whose triangles may be as large as the scene.
_ROUNDING = 2e-7


class Square(NamedTuple):
    """Centre (3,) of a square, right, up and towards the sun from the eye; half width and depth."""

    centre_m: FloatArray
    half_m: float
    half_depth_m: float


class StillShadowMap:
    """One texture of squares; made and used on the GL thread only.

    The counters count "still shadow map" as done, and as skipped without sun or where nothing has
    changed.
    """

    def __init__(self, context: Any, counters: WorkCounters):
        self._counters = counters
        self._textures = ShadowTextures(context, 2 * SQUARE_TEXELS)
        # The shader compares each texel with another depth.
        self._textures.depth.compare_func = ""
        self._grid = SeenGrid()
        self._drawn: tuple[Any, ...] = ()
        self._shadow: StillShadow | None = None

    def update(
        self,
        meshes: MeshRenderer,
        scene: PyrenderScene,
        seen: list[PlacedPrimitive],
        light: Light,
        view: View,
        size_px: tuple[int, int],
        always: bool,
    ) -> StillShadow:
        """The shadows of a view; `always` draws them without a change too."""
        eye = (view.eye_m.tobytes(), view.clip_from_eye.tobytes(), meshes.section)
        now = (scene, light.sun_direction, light.sun_radius_rad, size_px, *eye)
        if not always and self._shadow is not None and self._drawn == now:
            self._counters.skip("still shadow map: same scene, same sun, same view")
            return self._shadow
        if not always and not any(light.sun_irradiance):
            self._counters.skip("still shadow map: no sun to cast one")
            return self._shadow_of(scene, light, [])
        points = self._grid.points(meshes, seen, view, size_px)
        middle_m = scene.centre_m - view.eye_m
        squares = fitted(
            points,
            light.sun_direction,
            math.tan(light.sun_radius_rad),
            middle_m,
            scene.half_extent_m,
        )
        axes = light_axes(light.sun_direction)
        places: list[tuple[Shadow, tuple[int, int]]] = []
        for number, square in enumerate(squares):
            matrix = light_matrix(light.sun_direction, square.half_m, square.half_depth_m)
            shadow = Shadow(
                texture=self._textures.depth,
                matrix=matrix,
                texel_m=2.0 * square.half_m / SQUARE_TEXELS,
                centre_m=view.eye_m + square.centre_m @ axes,
                aspect=square.half_m / square.half_depth_m,
            )
            corner = (SQUARE_TEXELS * (number % 2), SQUARE_TEXELS * (number // 2))
            places.append((shadow, corner))
        self._textures.draw(meshes, scene, places, SQUARE_TEXELS)
        self._shadow = self._shadow_of(scene, light, squares)
        self._drawn = now
        self._counters.did("still shadow map")
        return self._shadow

    def _shadow_of(self, scene: PyrenderScene, light: Light, squares: list[Square]) -> StillShadow:
        rounding = [_ROUNDING * (1.0 + scene.radius_m / each.half_depth_m) for each in squares]
        return StillShadow(
            texture=self._textures.depth,
            ranges=self._textures.ranges,
            tint=self._textures.tint_of(scene),
            axes=light_axes(light.sun_direction),
            squares=_numbers([(*each.centre_m[:2], 1.0 / each.half_m) for each in squares]),
            depths=_numbers(
                [
                    (each.centre_m[2], 0.5 / each.half_depth_m, rounded)
                    for each, rounded in zip(squares, rounding, strict=True)
                ]
            ),
            spread=math.tan(light.sun_radius_rad),
        )

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        self._textures.release()
        self._grid.release()


def fitted(
    points: SeenPoints,
    direction: ArrayLike,
    spread: float,
    middle_m: NDArray[np.float64],
    half_extent_m: NDArray[np.float64],
) -> list[Square]:
    """At most four squares, from the widest, that contain points under a sun in `direction`.

    Casters lie in a box around `middle_m` (3,) from the eye that extends by `half_extent_m` (3,)
    each way. The first square contains all points within the box's bounding sphere, in the sun's
    view, and is wide enough for the widest penumbra; `spread` is the tangent of the sun's radius.
    Each further square contains the points for which the previous texels are too wide. The texel
    width (pixels) is the least for which four squares suffice.
    """
    axes, radius_m = light_axes(direction), float(np.linalg.norm(half_extent_m))
    at = points.from_eye_m @ axes.T
    order = np.argsort(points.pixel_m, kind="stable")
    order = order[np.linalg.norm((at[order] - axes @ middle_m)[:, :2], axis=1) < radius_m]
    if not len(order):
        return [Square(axes @ middle_m, radius_m, radius_m)]
    at, pixel_m = at[order], points.pixel_m[order]
    low, high = np.minimum.accumulate(at), np.maximum.accumulate(at)
    halves_m = _ROOM / INSIDE * 0.5 * np.max((high - low)[:, :2], axis=1)
    halves_m = np.maximum(halves_m, 0.5 * SQUARE_TEXELS * _FINEST_PX * pixel_m[0])
    nearest_m = _nearest_to_sun(
        0.5 * (low[-1] + high[-1]), halves_m[-1], axes, middle_m, half_extent_m
    )
    widest_m = spread * _DEEPER * (nearest_m - low[-1, 2])
    halves_m[-1] = max(halves_m[-1], 0.5 * SQUARE_TEXELS * widest_m / MOST_RADIUS)

    def counts(most_px: float) -> tuple[list[int], bool]:
        """Number of points in each square, and whether the last is fine enough."""
        found = [len(at)]
        while True:
            texel_m = 2.0 * halves_m[found[-1] - 1] / SQUARE_TEXELS
            left = int(np.searchsorted(pixel_m, texel_m / most_px))
            if left == 0 or left >= found[-1] or len(found) == SQUARES:
                return found, left == 0
            found.append(left)

    low_px, high_px = _FINEST_PX, _COARSEST_PX
    if counts(low_px)[1]:
        high_px = low_px
    for _ in range(_HALVINGS):
        middle_px = math.sqrt(low_px * high_px)
        if counts(middle_px)[1]:
            high_px = middle_px
        else:
            low_px = middle_px
    squares = []
    for count in counts(high_px)[0]:
        centre_m, half_m = 0.5 * (low[count - 1] + high[count - 1]), float(halves_m[count - 1])
        nearest_m = _nearest_to_sun(centre_m, half_m, axes, middle_m, half_extent_m)
        deepest_m = float(low[count - 1, 2])
        half_depth_m = max(_DEEPER * 0.5 * (nearest_m - deepest_m), half_m)
        squares.append(Square(np.array([*centre_m[:2], nearest_m - half_depth_m]), half_m,
                              half_depth_m))  # fmt: skip
    return squares


def _nearest_to_sun(
    centre_m: FloatArray,
    half_m: float,
    axes: FloatArray,
    middle_m: NDArray[np.float64],
    half_extent_m: NDArray[np.float64],
) -> float:
    """Largest coordinate towards the sun (m) of a box above a square."""
    across = half_extent_m + half_m * np.abs(axes[:2]).sum(axis=0)
    away, along = middle_m - centre_m[:2] @ axes[:2], axes[2]
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = (away + np.sign(along) * across) / along
    return float(np.min(ends, where=along != 0.0, initial=np.inf))


def _numbers(rows: list[tuple[float, float, float]]) -> NDArray[np.float32]:
    """Numbers of all squares (4, 3); missing squares contain no point."""
    return np.array([*rows, *[(1e18, 1e18, 1e18)] * (SQUARES - len(rows))], np.float32)

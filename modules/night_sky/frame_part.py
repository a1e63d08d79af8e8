"""Stars and the moon's disc, added to the sky that no surface covers.

Stars are points: each gives its light to the pixels around it, computed once a pixel however many
samples it has, so that sum of radiance times solid angle is its irradiance.
"""

from pathlib import Path
from typing import Any

import numpy as np

from vrut_lite.frame_part import FramePart, Heard, PartGl, PartView, Screen, latest
from vrut_lite.messages.night import (
    EDGE_OVER_MIDDLE,
    THROUGH_PLACES,
    MoonDiscChanged,
    StarsChanged,
)

_SHADERS = Path(__file__).parent / "shaders"
# Margin around the disc, for the pixels that it touches.
_MARGIN_PX = 3.0
# Least number of samples across the disc.
_SAMPLES_ACROSS = 24


class NightPart(FramePart):
    """Draws the stars and the moon of the night."""

    hears = (StarsChanged, MoonDiscChanged)

    def __init__(self, gl: PartGl):
        super().__init__(gl)
        self._context, self._counters = gl.context, gl.counters
        self._program: Any = None
        self._stars: StarsChanged | None = None
        self._points: Any = None
        self._buffer: Any = None
        self._count = 0
        self._moon: MoonDiscChanged | None = None
        self._screen: Screen | None = None
        self._albedo: Any = None

    def show(self, heard: Heard) -> None:
        """Draw this night from the next picture on."""
        stars, moon = latest(heard, StarsChanged), latest(heard, MoonDiscChanged)
        if stars is not self._stars:
            self._stars = stars
            self._show_stars(stars)
        self._show_moon(moon)

    @property
    def is_seen(self) -> bool:
        """Whether there are stars, or a moon."""
        return self._count > 0 or self._moon is not None

    def _show_stars(self, stars: StarsChanged | None) -> None:
        self._release_points()
        if stars is None or stars.direction.shape[0] == 0:
            return
        if self._program is None:
            self._program = self.gl.program(_SHADERS / "star.vert", _SHADERS / "star.frag")
        points = np.concatenate([stars.direction.values, stars.irradiance_rgb.values], axis=1)
        self._buffer = self._context.buffer(np.ascontiguousarray(points, np.float32).tobytes())
        layout = (self._buffer, "3f 3f", "direction", "irradiance")
        self._points = self._context.vertex_array(self._program, [layout])
        self._count = len(points)

    def _show_moon(self, moon: MoonDiscChanged | None) -> None:
        before, self._moon = self._moon, moon
        if moon is None or (before is not None and before.albedo is moon.albedo):
            return
        if self._albedo is not None:
            self._albedo.release()
        rows, columns = moon.albedo.shape
        texels = np.ascontiguousarray(moon.albedo.values)
        self._albedo = self._context.texture((columns, rows), 1, texels.tobytes(), dtype="f4")
        self._albedo.filter = (self._context.LINEAR, self._context.LINEAR)
        self._albedo.repeat_y = False

    def draw_over_sky(self, size_px: tuple[int, int], view: PartView) -> None:
        """Add stars and moon where nothing was drawn but the sky."""
        if self._count:
            self._draw_stars(size_px, view)
        if self._moon is not None:
            self._draw_moon(self._moon, size_px, view)

    def _draw_stars(self, size: tuple[int, int], view: PartView) -> None:
        program = self._program
        program["clip_from_eye"].write(view.clip_from_eye.T.astype(np.float32).tobytes())
        program["size_px"].value = size
        program["pixels_per_sr"].value = float(np.prod(_focal_px(size, view)))
        self._context.enable(self._context.PROGRAM_POINT_SIZE)
        self._points.render(self._context.POINTS)
        self._context.disable(self._context.PROGRAM_POINT_SIZE)
        self._counters.did("star", self._count)

    def _draw_moon(self, moon: MoonDiscChanged, size: tuple[int, int], view: PartView) -> None:
        box = _box(moon, size, view)
        if box is None:
            self._counters.skip("moon: not in view")
            return
        if self._screen is None:
            self._screen = self.gl.screen(_SHADERS / "moon.frag")
        screen = self._screen
        middle = np.array(moon.direction)
        right = np.cross(middle, [0.0, 1.0, 0.0])
        right /= max(float(np.linalg.norm(right)), 1e-9)
        screen.set("moon_direction", middle)
        screen.set("moon_right", right)
        screen.set("moon_upper", np.cross(right, middle))
        screen.set("sine_of_radius", float(np.sin(moon.angular_radius_rad)))
        screen.set("flattening", moon.flattening)
        screen.set("horizon_sine", float(np.sin(moon.horizon_rad)))
        screen.set("to_sun", moon.to_sun)
        screen.set("moon_axes", np.reshape(moon.axes, (3, 3)).T.ravel())
        screen.set("lit_radiance", moon.lit_rgb)
        screen.set("dark_radiance", moon.dark_rgb)
        through = np.array(moon.through_rgb or (1.0,) * (3 * THROUGH_PLACES), np.float32)
        screen.program["through"].write(through.tobytes())
        shadow = moon.shadow
        screen.set("umbra", 0.0 if shadow is None else shadow.umbra_rad)
        if shadow is not None:
            screen.set("shadow_direction", shadow.direction)
            screen.set("penumbra", shadow.penumbra_rad)
            screen.set("umbra_share", shadow.umbra_rgb)
            screen.set("edge_over_middle", EDGE_OVER_MIDDLE)
        self._albedo.use(location=0)
        screen.program["albedo"].value = 0
        wide_px = 2.0 * max(_focal_px(size, view)) * moon.angular_radius_rad
        screen.program["steps"].value = int(np.clip(_SAMPLES_ACROSS / wide_px, 2, _SAMPLES_ACROSS))
        screen.draw(view, box)
        self._counters.did("moon")

    def release(self) -> None:
        """Free the GL objects."""
        self._release_points()
        if self._albedo is not None:
            self._albedo.release()

    def _release_points(self) -> None:
        for thing in (self._points, self._buffer):
            if thing is not None:
                thing.release()
        self._points = self._buffer = None
        self._count = 0


def _focal_px(size: tuple[int, int], view: PartView) -> tuple[float, float]:
    """Pixels per unit of slope, right and up."""
    return (
        0.5 * size[0] * float(view.projection[0, 0]),
        0.5 * size[1] * float(view.projection[1, 1]),
    )


def _box(
    moon: MoonDiscChanged, size: tuple[int, int], view: PartView
) -> tuple[int, int, int, int] | None:
    """Left, lower, width and height of the pixels around the disc; None where it is not seen."""
    x, y, _, w = view.clip_from_eye @ np.append(moon.direction, 0.0)
    if w <= 0.05:
        return None
    middle = (np.array([x, y]) / w * 0.5 + 0.5) * size
    half = max(_focal_px(size, view)) * np.tan(moon.angular_radius_rad) / w**2 + _MARGIN_PX
    low = np.maximum(np.floor(middle - half), 0.0).astype(int)
    high = np.minimum(np.ceil(middle + half), size).astype(int)
    if (high <= low).any():
        return None
    width, height = (high - low).tolist()
    return int(low[0]), int(low[1]), width, height

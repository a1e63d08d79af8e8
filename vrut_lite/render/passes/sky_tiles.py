"""Where in a picture the sky is seen, tile by tile.

A software renderer with several samples a pixel shades also the samples that the depth test then
refuses: the sky is drawn in those tiles alone in which some of it is seen.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL

from vrut_lite.render.passes.full_screen import FullScreen
from vrut_lite.render.passes.view import View

# A multiple of a software renderer's own tiles, so that none is drawn twice.
_EDGE_PX = 64
# Sine of the altitude from where on the horizon is surely below: it dips, but never rises.
_OVER_HORIZON = 0.01


class Tile(NamedTuple):
    """A rectangle of pixels, from the left and from below; whether it is all over the horizon."""

    left: int
    lower: int
    width: int
    height: int
    over_horizon: bool


class SkyTiles:
    """Counts uncovered samples with a program that draws nothing."""

    def __init__(self, context: Any):
        self._screen = FullScreen(context, "depth_alone.frag")
        self._queries: list[int] = []

    def uncovered(self, size: tuple[int, int], view: View) -> tuple[list[Tile], int]:
        """Tiles in which the sky passes the depth test, neighbours joined, and its samples."""
        tiles = _tiles(size, view)
        if len(self._queries) < len(tiles):
            more = GL.glGenQueries(len(tiles) - len(self._queries))
            self._queries += [int(name) for name in np.atleast_1d(more)]
        GL.glColorMask(*4 * [GL.GL_FALSE])
        GL.glEnable(GL.GL_SCISSOR_TEST)
        for name, tile in zip(self._queries, tiles, strict=False):
            GL.glScissor(*tile[:4])
            GL.glBeginQuery(GL.GL_SAMPLES_PASSED, name)
            self._screen.draw()
            GL.glEndQuery(GL.GL_SAMPLES_PASSED)
        GL.glDisable(GL.GL_SCISSOR_TEST)
        GL.glColorMask(*4 * [GL.GL_TRUE])
        seen = [
            (tile, int(GL.glGetQueryObjectuiv(name, GL.GL_QUERY_RESULT)))
            for name, tile in zip(self._queries, tiles, strict=False)
        ]
        return _joined([tile for tile, count in seen if count]), sum(count for _, count in seen)

    def release(self) -> None:
        """Free the GL objects."""
        self._screen.release()
        if self._queries:
            GL.glDeleteQueries(len(self._queries), self._queries)


def whole(size: tuple[int, int]) -> list[Tile]:
    """All of a picture as one tile."""
    return [Tile(0, 0, *size, over_horizon=False)]


def _tiles(size: tuple[int, int], view: View) -> list[Tile]:
    lefts, lowers = (range(0, side, _EDGE_PX) for side in size)
    over = _over_horizon(size, view)
    return [
        Tile(
            left,
            lower,
            min(_EDGE_PX, size[0] - left),
            min(_EDGE_PX, size[1] - lower),
            bool(over[row : row + 2, column : column + 2].all()),
        )
        for row, lower in enumerate(lowers)
        for column, left in enumerate(lefts)
    ]


def _over_horizon(size: tuple[int, int], view: View) -> NDArray[np.bool_]:
    """Whether the rays through the tiles' corners (rows + 1, columns + 1) look up.

    Directions over a level form a cone: where all corners of a tile are in it, all of the tile is.
    """
    places = [
        np.minimum(np.arange(-(-side // _EDGE_PX) + 1) * _EDGE_PX / side, 1.0) * 2.0 - 1.0
        for side in size
    ]
    x, y = np.meshgrid(*places)
    clip = np.stack([x, y, np.ones_like(x), np.ones_like(x)], axis=-1)
    ray = clip @ np.linalg.inv(view.clip_from_eye).T
    ray = ray[..., :3] / ray[..., 3:]
    up: NDArray[np.bool_] = ray[..., 1] > _OVER_HORIZON * np.linalg.norm(ray, axis=-1)
    return up


def _joined(tiles: list[Tile]) -> list[Tile]:
    """Tiles of a row that touch and are alike, as one."""
    joined: list[Tile] = []
    for tile in tiles:
        last = joined[-1] if joined else None
        if (
            last is not None
            and last.lower == tile.lower
            and last.left + last.width == tile.left
            and last.over_horizon == tile.over_horizon
        ):
            joined[-1] = last._replace(width=last.width + tile.width)
        else:
            joined.append(tile)
    return joined

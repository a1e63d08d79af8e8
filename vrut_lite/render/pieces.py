"""A pass drawn piece by piece, so that a picture can be given up while it is being drawn.

A software renderer takes seconds for a finished picture. Whoever moves on meanwhile is not to wait
for it: after each piece it is asked whether anybody still does.
"""

from collections.abc import Callable
from time import perf_counter
from typing import NamedTuple

from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.patience import Patience

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)

# Pixels: pieces begin where a software renderer's tiles do, and no 2 x 2 pixels, of which
# derivatives are taken, are parted. Its threads take a tile each.
TILE, _LEAST_TILES = 64, 2
# What a piece may take, unless most of that is spent before its first pixel.
_PIECE_S = 0.15


class Piece(NamedTuple):
    """A rectangle of pixels, counted from the left and from below."""

    left: int
    lower: int
    right: int
    upper: int

    @property
    def tiles(self) -> float:
        """How large it is."""
        return (self.right - self.left) * (self.upper - self.lower) / TILE**2


class Pieces:
    """Pieces of one pass, as large as can be drawn in a sixth of a second; on the GL thread only.

    Pixels are those of a pass that is drawn whole. Sizes are learned from piece to piece, and have
    `most_tiles` where the next may take many times longer than the last.
    """

    def __init__(self, patience: Patience, most_tiles: int | None = None):
        self._patience = patience
        self._most_tiles = most_tiles
        self._tiles = _LEAST_TILES

    def draw(self, size: tuple[int, int], draw: Callable[[Piece], None]) -> None:
        """Draw all of a picture of this size, piece after piece, what is around each cut off.

        A picture that is finished in any case is one piece.

        Raises:
            GivenUp: nobody waits any more.
        """
        if self._patience.is_given_up is None:
            draw(Piece(0, 0, *size))
            return
        left = lower = 0
        GL.glEnable(GL.GL_SCISSOR_TEST)
        try:
            while lower < size[1]:
                piece = piece_at(left, lower, size, self._tiles)
                GL.glScissor(left, lower, piece.right - left, piece.upper - lower)
                self._draw_one(draw, piece)
                self._patience.check()
                left = piece.right % size[0]
                lower = lower if left else piece.upper
        finally:
            GL.glDisable(GL.GL_SCISSOR_TEST)

    def _draw_one(self, draw: Callable[[Piece], None], piece: Piece) -> None:
        start_s = perf_counter()
        draw(piece)
        # A software renderer places triangles at once, and shades pixels when it is waited for.
        placed_s = perf_counter() - start_s
        GL.glFinish()
        shaded_s = perf_counter() - start_s - placed_s
        tiles = next_tiles(self._tiles, piece.tiles, placed_s, shaded_s)
        self._tiles = tiles if self._most_tiles is None else min(tiles, self._most_tiles)


def piece_at(left: int, lower: int, size: tuple[int, int], tiles: int) -> Piece:
    """So many tiles from a corner on: whole rows of them, or what is left of one row."""
    width, height = size
    rows = 1 if left else max(1, tiles // -(-width // TILE))
    right = width if rows > 1 else min(left + tiles * TILE, width)
    return Piece(left, lower, right, min(lower + rows * TILE, height))


def next_tiles(asked: int, drawn: float, placed_s: float, shaded_s: float) -> int:
    """How large the next piece is to be, after one for which placing and shading took so long.

    Every piece places triangles anew: no more time is to go into that than into pixels. A piece
    of bare sky says little of the next, which is at most twice as large as was `asked` for: of
    that the picture's edge may have left little to be `drawn`.
    """
    wished_s = max(_PIECE_S - placed_s, placed_s)
    wished = min(2.0 * max(asked, drawn), wished_s / max(shaded_s, 1e-6) * drawn)
    return max(_LEAST_TILES, int(wished))

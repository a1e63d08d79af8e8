"""A pass drawn in pieces, so that a picture can be given up while it is being drawn.

A software renderer takes seconds for a finished picture. After each piece the caller may give the
picture up, so that a user need not wait for it.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter, thread_time
from typing import NamedTuple

from vrut_lite.errors import GivenUp
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.scene.backend import IsGivenUp

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)

# Pixels: pieces are aligned to a software renderer's tiles, of which each thread draws one, and do
# not split the 2 x 2 pixels of derivatives.
TILE, _LEAST_TILES = 64, 2
# Time of a piece, longer if triangle setup dominates or a picture would have more than _MANY.
_PIECE_S, _MANY = 0.15, 6


class Piece(NamedTuple):
    """A rectangle of pixels, counted from the left and from below."""

    left: int
    lower: int
    right: int
    upper: int

    @property
    def tiles(self) -> float:
        """Its area, in tiles."""
        return (self.right - self.left) * (self.upper - self.lower) / TILE**2

    def within(self, other: "Piece") -> "Piece":
        """Its part within another, perhaps without pixels."""
        left, right = (min(max(x, other.left), other.right) for x in self[::2])
        lower, upper = (min(max(y, other.lower), other.upper) for y in self[1::2])
        return Piece(left, lower, right, upper)


class Patience:
    """Ends a picture that its caller has given up.

    `is_given_up` is None for a picture that is finished in any case. The counters count, as
    skipped, pictures that were given up.
    """

    def __init__(self, counters: WorkCounters):
        self._counters = counters
        self.is_given_up: IsGivenUp | None = None

    def check(self) -> None:
        """Return if the picture is still wanted.

        Raises:
            GivenUp: it is not.
        """
        if self.is_given_up is not None and self.is_given_up():
            self._counters.skip("picture: given up")
            raise GivenUp


class TiledPass:
    """Draws one pass in pieces as large as can be drawn in a sixth of a second, on the GL thread.

    The pixels equal those of a pass that is drawn whole. The time of a piece sets the size of the
    next, up to `most_tiles` where the next may take many times longer.
    """

    def __init__(self, patience: Patience, most_tiles: int | None = None):
        self._patience = patience
        self._most_tiles = most_tiles
        self._tiles = _LEAST_TILES
        self._piece_s = _PIECE_S

    def draw(self, size: tuple[int, int], draw: Callable[[Piece], None]) -> None:
        """Draw all of a picture of this size, piece after piece, each clipped to its rectangle.

        A picture that is finished in any case is one piece.

        Raises:
            GivenUp: the picture is no longer wanted.
        """
        if self._patience.is_given_up is None:
            draw(Piece(0, 0, *size))
            return
        left = lower = 0
        times_s = []
        GL.glEnable(GL.GL_SCISSOR_TEST)
        try:
            while lower < size[1]:
                piece = piece_at(left, lower, size, self._tiles)
                set_scissor(piece)
                times_s.append(_timed(draw, piece))
                self._adapt(piece, *times_s[-1])
                self._patience.check()
                left = piece.right % size[0]
                lower = lower if left else piece.upper
        finally:
            GL.glDisable(GL.GL_SCISSOR_TEST)
        # The next picture begins with the mean: the last pieces are sky, and quick.
        placed_s, shaded_s = map(sum, zip(*times_s, strict=True))
        self._piece_s = max(_PIECE_S, (placed_s + shaded_s) / _MANY)
        self._adapt(Piece(0, 0, *size), placed_s / len(times_s), shaded_s)

    def _adapt(self, drawn: Piece, placed_s: float, shaded_s: float) -> None:
        tiles = next_tiles(self._tiles, drawn.tiles, placed_s, shaded_s, self._piece_s)
        self._tiles = tiles if self._most_tiles is None else min(tiles, self._most_tiles)


def set_scissor(piece: Piece) -> None:
    """Set GL's scissor box."""
    GL.glScissor(piece.left, piece.lower, piece.right - piece.left, piece.upper - piece.lower)


@contextmanager
def smaller_boxes(piece: Piece) -> Iterator[None]:
    """Let GL's scissor box be smaller than the piece that is being drawn."""
    was_enabled = GL.glIsEnabled(GL.GL_SCISSOR_TEST)
    GL.glEnable(GL.GL_SCISSOR_TEST)
    try:
        yield
    finally:
        set_scissor(piece)
        if not was_enabled:
            GL.glDisable(GL.GL_SCISSOR_TEST)


def _timed(draw: Callable[[Piece], None], piece: Piece) -> tuple[float, float]:
    """Draw a piece; seconds of triangle setup, and of shading.

    A software renderer sets up triangles on this thread and shades pixels on others, for which this
    one may wait: at an occlusion query, or at the end.
    """
    start_s, start_cpu_s = perf_counter(), thread_time()
    draw(piece)
    placed_s = thread_time() - start_cpu_s
    GL.glFinish()
    return placed_s, perf_counter() - start_s - placed_s


def piece_at(left: int, lower: int, size: tuple[int, int], tiles: int) -> Piece:
    """A piece of a number of tiles from a corner: whole rows, or the remainder of one row."""
    width, height = size
    rows = 1 if left else max(1, tiles // -(-width // TILE))
    right = width if rows > 1 else min(left + tiles * TILE, width)
    return Piece(left, lower, right, min(lower + rows * TILE, height))


def next_tiles(
    asked: int, drawn: float, placed_s: float, shaded_s: float, piece_s: float = _PIECE_S
) -> int:
    """Tiles of the next piece, from the seconds of triangle setup and shading of the last one.

    Every piece repeats the triangle setup, which must take no longer than shading its pixels. The
    next piece has at most twice the tiles that were `asked` for, since a piece of bare sky says
    little about the next; `drawn` are fewer at the picture's edge.
    """
    wished_s = max(piece_s - placed_s, placed_s)
    wished = min(2.0 * max(asked, drawn), wished_s / max(shaded_s, 1e-6) * drawn)
    return max(_LEAST_TILES, int(wished))

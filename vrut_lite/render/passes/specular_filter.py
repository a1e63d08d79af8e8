"""The sky as glossy surfaces reflect it, filtered on the GPU a slice at a time.

Compute shaders: on real GPUs the same arithmetic is much faster there than in fragments.
"""

from collections import deque
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.tolerance import budget
from vrut_lite.render.light import SkyTexture
from vrut_lite.render.shader_files import shader_source
from vrut_lite.render.unlocked import average_down_for_compute, run_compute
from vrut_lite.sky.relight_scale import age_factor

# Roughness of the filtered map's mip levels; a mirror looks up the sky itself.
LEVEL_ROUGHNESS = (0.2, 0.35, 0.6, 1.0)
# Edge of the filtered map, no larger than needed for the sky's own, and of the copy it is made of.
_SMALLEST, _LARGEST, _SOURCE_SIZE = 32, 64, 128
# Wider lobes take more samples, and have fewer texels.
_SAMPLES = 64
# No coarse cell of the sky may be off by more than this share of it (or of 1 % of the
# brightest cell, if that is more), unless a tolerance says otherwise: half a step of 8 bits at
# the display's white.
CHANGE_SEEN = 0.005
# Ratio of two skies' levels from which the earlier one's pattern says nothing of the later one's.
_LEAP = 2.0
_CELLS = 8
_DARKEST_CELL = 0.01
_GROUP = 8
_FACES = 6


def reflection_change(tolerance: float) -> float:
    """Largest relative difference of a coarse cell between the sky and its reflected copy.

    The one knob of the frame that follows the tolerance; it bounds the change itself, so that no
    front has to be measured. Sizes and samples of the filtered map do not follow: they err by 1 %
    of the brightest at most.
    """
    return budget(tolerance, CHANGE_SEEN, 0.5)


class SpecularFilter:
    """Filters the latest sky; used on the GL thread only.

    Work is done on a copy and shown when it is whole, so that a sky that changes in every
    frame neither tears a reflection nor starves it. The counters count each "reflection slice",
    and skips where the sky is the same or differs by `change_seen` at most.
    """

    def __init__(self, context: Any, counters: WorkCounters):
        self.change_seen = CHANGE_SEEN
        self._context = context
        self._counters = counters
        self._programs = {
            name: context.compute_shader(shader_source(f"{name}.comp"))
            for name in ("specular_filter", "cube_copy", "cube_summary")
        }
        self._summary = context.buffer(reserve=_FACES * _CELLS * _CELLS * 16)
        # The map, its factor to radiance, and the level of its sky.
        self._shown: tuple[Any, float, float] | None = None
        self._level = self._source_level = 1.0
        self._next: Any = None
        self._source: Any = None
        self._source_scale = 1.0
        self._slices: deque[tuple[int, int]] = deque()
        # The sky that was compared last, and the cells of the one that was filtered last.
        self._measured: Any = None
        self._cells: NDArray[np.float64] | None = None

    @property
    def texture(self) -> Any:
        """The filtered cube map, one mip level for each of `LEVEL_ROUGHNESS`; None at first."""
        return None if self._shown is None else self._shown[0]

    @property
    def scale(self) -> float:
        """The factor from the texture's values to radiance, as bright as the present sky."""
        if self._shown is None:
            return 1.0
        return self._shown[1] * age_factor(self._level, self._shown[2])

    def update(
        self, sky: SkyTexture, slices: int | None, always: bool = False, level: float = 1.0
    ) -> None:
        """Follow the sky by so many slices of work, or without a number until it is done.

        The first sky is done at once, and so is one after a leap into another light. `always`
        filters an unchanged sky too. A map of an earlier sky is shown as bright as this one,
        by its `level`.
        """
        self._level = level
        if self._shown is None or _is_leap(level, self._shown[2]):
            slices = None
        if slices is None and self._slices and self._measured is not sky.owner:
            # A half-filtered map is never shown.
            self._slices.clear()
            self._cells = None
        if not self._slices:
            self._begin(sky, always)
        count = len(self._slices) if slices is None else min(slices, len(self._slices))
        for _ in range(count):
            self._filter(*self._slices.popleft())
        if count and not self._slices:
            self._show()

    def release(self) -> None:
        """Free everything."""
        textures = (self.texture, self._next, self._source)
        for thing in (*textures, self._summary, *self._programs.values()):
            if thing is not None:
                thing.release()

    def _begin(self, sky: SkyTexture, always: bool) -> None:
        """Copy the sky and queue its slices, if its change is visible."""
        if sky.owner is self._measured and not always:
            self._counters.skip("reflection: the same sky")
            return
        self._measured = sky.owner
        average_down_for_compute(sky.texture)
        sky.texture.filter = (self._context.LINEAR_MIPMAP_LINEAR, self._context.LINEAR)
        sky.texture.use(location=0)
        cells = self._coarse_cells() * sky.scale
        if not always and self._looks_like(cells):
            self._counters.skip("reflection: no change to be seen")
            return
        self._cells, self._source_scale, self._source_level = cells, sky.scale, self._level
        size = sky.texture.size[0]
        self._source = self._cube(self._source, min(size, _SOURCE_SIZE))
        self._next = self._cube(self._next, min(max(size, _SMALLEST), _LARGEST))
        self._copy()
        # The quick ones first: the next picture is waited for.
        self._slices.extend(
            (level, face) for level in range(len(LEVEL_ROUGHNESS))[::-1] for face in range(_FACES)
        )

    def _looks_like(self, cells: NDArray[np.float64]) -> bool:
        """Whether these cells differ invisibly from those of the sky that was filtered."""
        return self._cells is not None and change(self._cells, cells) <= self.change_seen

    def _coarse_cells(self) -> NDArray[np.float64]:
        """Means (cells, 3) over coarse cells of the cube map in texture unit 0."""
        self._summary.bind_to_storage_buffer(0)
        run_compute(self._programs["cube_summary"], 1, 1, _FACES)
        self._context.memory_barrier()
        values = np.frombuffer(self._summary.read(), np.float32).reshape(-1, 4)
        return values[:, :3].astype(np.float64)

    def _copy(self) -> None:
        """Keep the cube map in texture unit 0, averaged down."""
        self._source.bind_to_image(0, read=False, write=True)
        groups = -(-self._source.size[0] // _GROUP)
        run_compute(self._programs["cube_copy"], groups, groups, _FACES)
        self._context.memory_barrier()
        average_down_for_compute(self._source)

    def _filter(self, level: int, face: int) -> None:
        program = self._programs["specular_filter"]
        program["face"].value = face
        program["alpha"].value = LEVEL_ROUGHNESS[level] ** 2
        program["samples"].value = _SAMPLES << level
        self._source.filter = (self._context.LINEAR_MIPMAP_NEAREST, self._context.LINEAR)
        self._source.use(location=0)
        self._next.bind_to_image(0, read=False, write=True, level=level)
        groups = -(-(self._next.size[0] >> level) // _GROUP)
        run_compute(program, groups, groups, 1)
        self._counters.did("reflection slice")

    def _show(self) -> None:
        """Show what was filtered; the map that was shown so far becomes the next to fill."""
        self._context.memory_barrier()
        self._next, shown = self.texture, self._next
        self._shown = (shown, self._source_scale, self._source_level)

    def _cube(self, old: Any, size: int) -> Any:
        """A cube map of this size in half precision with all its mip levels; the old one if it
        fits."""
        if old is not None and old.size[0] == size:
            return old
        if old is not None:
            old.release()
        cube = self._context.texture_cube((size, size), 4, dtype="f2")
        cube.build_mipmaps()
        cube.filter = (self._context.LINEAR_MIPMAP_LINEAR, self._context.LINEAR)
        return cube


def _is_leap(now: float, then: float) -> bool:
    return max(now, then) > _LEAP * min(now, then)


def change(before: NDArray[np.float64], after: NDArray[np.float64]) -> float:
    """The largest relative change of any value, dark ones counted by 1 % of the brightest."""
    larger = np.maximum(before, after)
    floor = max(_DARKEST_CELL * float(larger.max()), np.finfo(np.float64).tiny)
    return float(np.max(np.abs(after - before) / np.maximum(larger, floor)))

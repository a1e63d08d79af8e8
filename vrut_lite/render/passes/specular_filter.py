"""The sky prefiltered for glossy reflections, on the GPU, a slice at a time.

On graphics cards compute shaders are much faster at this than fragment shaders.
"""

from collections import deque
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.tolerance import budget
from vrut_lite.render.light import SkyTexture
from vrut_lite.render.shader_files import shader_source
from vrut_lite.render.unlocked import average_down_for_compute, build_mipmaps, run_compute
from vrut_lite.sky.relight_scale import age_factor

# Roughness of the filtered map's mip levels; a mirror samples the sky itself.
LEVEL_ROUGHNESS = (0.2, 0.35, 0.6, 1.0)
# Texels: least and largest edge of the filtered map, largest edge of its source.
_SMALLEST, _LARGEST, _SOURCE_SIZE = 32, 64, 128
# Samples of the first level, doubled for each wider lobe, which has fewer texels.
_SAMPLES = 64
# Largest relative error of a coarse cell of the sky (relative to 1 % of the brightest cell, if that
# is more) without a tolerance: half a step of 8 bits at the display's white.
CHANGE_SEEN = 0.005
# Ratio of two skies' levels from which the earlier map is not scaled to the later sky.
_LEAP = 2.0
_CELLS = 8
_DARKEST_CELL = 0.01
_GROUP = 8
_FACES = 6
_CUBE_MAP = 0x8513


def reflection_change(tolerance: float) -> float:
    """Largest relative difference of a coarse cell between the sky and its reflected copy.

    The only parameter of the frame that follows the tolerance; it bounds the change itself and
    needs no error-cost table. Size and samples of the filtered map are fixed, with an error of at
    most 1 % of the brightest value.
    """
    return budget(tolerance, CHANGE_SEEN, 0.5)


class SpecularFilter:
    """Filters the latest sky; used on the GL thread only.

    A map is filtered from a copy and shown when it is complete, so that a sky that changes in
    every frame neither tears reflections nor stops their updates. The counters count each
    "reflection slice", and skips where the sky is the same or differs by `change_seen` at most.

    Without `compares` every new sky is filtered: a graphics card does that in less time than it
    takes to read back the cells of the comparison.
    """

    def __init__(self, context: Any, counters: WorkCounters, compares: bool = True):
        self._compares = compares
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
        """The factor from the texture's values to radiance, scaled to the present sky's level."""
        if self._shown is None:
            return 1.0
        return self._shown[1] * age_factor(self._level, self._shown[2])

    def update(
        self, sky: SkyTexture, slices: int | None, always: bool = False, level: float = 1.0
    ) -> None:
        """Filter the next slices of the sky, or with None all that remain.

        The first sky is filtered at once, as is one after a large change of `level`. `always`
        filters an unchanged sky too. A map of an earlier sky is scaled to the level of this one.
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
        self._average_down(sky.texture)
        sky.texture.filter = (self._context.LINEAR_MIPMAP_LINEAR, self._context.LINEAR)
        sky.texture.use(location=0)
        if self._compares:
            cells = self._coarse_cells() * sky.scale
            if not always and self._looks_like(cells):
                self._counters.skip("reflection: no change to be seen")
                return
            self._cells = cells
        self._source_scale, self._source_level = sky.scale, self._level
        size = sky.texture.size[0]
        self._source = self._cube(self._source, min(size, _SOURCE_SIZE))
        self._next = self._cube(self._next, min(max(size, _SMALLEST), _LARGEST))
        self._copy()
        # Quick slices first, so that the next picture is not delayed.
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
        """Copy the cube map in texture unit 0, averaged down."""
        self._source.bind_to_image(0, read=False, write=True)
        groups = -(-self._source.size[0] // _GROUP)
        run_compute(self._programs["cube_copy"], groups, groups, _FACES)
        self._context.memory_barrier()
        self._average_down(self._source)

    def _average_down(self, cube: Any) -> None:
        """Generate a cube's mipmaps; a software renderer is waited for."""
        if self._compares:
            average_down_for_compute(cube)
        else:
            build_mipmaps(_CUBE_MAP, cube)

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
        """Show the filtered map; the map shown before becomes the next target."""
        self._context.memory_barrier()
        self._next, shown = self.texture, self._next
        self._shown = (shown, self._source_scale, self._source_level)

    def _cube(self, old: Any, size: int) -> Any:
        """A half-precision cube map of this size with all mip levels; the old one if it fits."""
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
    """The largest relative change; values below 1 % of the brightest are relative to that."""
    larger = np.maximum(before, after)
    floor = max(_DARKEST_CELL * float(larger.max()), np.finfo(np.float64).tiny)
    return float(np.max(np.abs(after - before) / np.maximum(larger, floor)))

"""Textures for the results of GPU jobs, reused once their handles are released."""

import weakref
from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.render.graphics_memory import allocated

NUMPY_TYPES = {"rgba16f": "f2", "rgba32f": "f4"}
Kind = tuple[str, int | tuple[int, int, int], str]


class _Lent(NamedTuple):
    kind: Kind
    job: GpuJob
    texture: Any
    handle: "weakref.ref[GpuTexture]"


class TexturePool:
    """Lends textures, on the GL thread only.

    A shown texture must not be written while the next is made: two of a kind alternate, and a third
    is used while a consumer lags behind. Free ones of another kind are released.
    """

    def __init__(self) -> None:
        self._lent: list[_Lent] = []

    def take(self, context: Any, job: GpuJob) -> GpuTexture:
        """The handle of a texture of the job's size and format that has no other handle."""
        kind = (job.output, job.size, job.format)
        texture = self._free_one(kind) or _make(context, job)
        handle = GpuTexture(size=job.size, format=job.format, recipe=job.recipe).holding(texture)
        self._lent.append(_Lent(kind, job, texture, weakref.ref(handle)))
        return handle

    def remade(self, context: Any) -> Iterator[tuple[GpuJob, Any]]:
        """New textures for all handles that are kept, with their jobs; the old ones are gone."""
        before, self._lent = self._lent, []
        for lent in before:
            if (handle := lent.handle()) is not None:
                texture = _make(context, lent.job)
                handle.holding(texture)
                self._lent.append(lent._replace(texture=texture))
                yield lent.job, texture

    def _free_one(self, kind: Kind) -> Any:
        """A texture of this kind whose handles are released, or None."""
        # Read once: another thread may release its handle at any moment.
        held = [lent.handle() is not None for lent in self._lent]
        free = [lent for lent, is_held in zip(self._lent, held, strict=True) if not is_held]
        self._lent = [lent for lent, is_held in zip(self._lent, held, strict=True) if is_held]
        fitting = [lent.texture for lent in free if lent.kind == kind]
        for lent in free:
            if lent.texture not in fitting[:1]:
                lent.texture.release()
        return fitting[0] if fitting else None


def _make(context: Any, job: GpuJob) -> Any:
    kinds = {"3d": context.texture3d, "cube": context.texture_cube, "2d": context.texture}
    size = job.size if isinstance(job.size, tuple) else (job.size, job.size)
    make = partial(kinds[job.output], size, 4, dtype=NUMPY_TYPES[job.format])
    return allocated(context, f"a texture of {size[0]} x {size[1]}", make)[0]

"""Algorithm 1 on the GPU: runs the passes and reads the tables back."""

from collections.abc import Callable, Generator
from typing import Any, Self

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.published.gpu_pipeline.air_buffer import LANES, buffers_of_air
from bruneton_sky.published.gpu_pipeline.passes import Pass, Workspace, passes
from bruneton_sky.published.gpu_pipeline.programs import check_sizes, compile_programs
from bruneton_sky.published.gpu_pipeline.tables import GpuTables, read_flat, read_scattering
from bruneton_sky.tables.sizes import TableSizes, refuse_untabled
from bruneton_sky.tables.tables import Tables
from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray
from vrut_lite.operating_system import has_egl

Progress = Callable[[float], None]
Observe = Callable[[Pass], None]


class GpuPipeline:
    """The precomputation for tables of fixed sizes, on the thread of its context.

    Shaders are compiled once, for all atmospheres and numbers of orders.

    Args:
        context: a moderngl context of OpenGL 4.3 or newer; without one, a new context is made
            current.
        sizes: sizes of the tables.

    Raises:
        UserError: no context is given and no OpenGL is there.
        ValueError: tables of these sizes do not fit the GPU.
    """

    def __init__(self, context: Any = None, sizes: TableSizes | None = None):
        self.sizes = sizes or TableSizes()
        check_sizes(self.sizes)
        self._own_context = context is None
        self.context = _standalone_context() if context is None else context
        self.programs = compile_programs(self.context, self.sizes)
        self._work = Workspace.empty(self.context, self.sizes)

    def run(
        self, atmosphere: Atmosphere, orders: int = 4, progress: Progress | None = None
    ) -> Tables:
        """The tables of an atmosphere, read back.

        Args:
            orders: highest order of scattering and reflection, 1 or more.
            progress: called with the share done, from 0 to 1.

        Raises:
            ValueError: orders is below 1, or there is fog.
        """
        made = self.run_on_gpu(atmosphere, orders, progress)
        try:
            return self._read(atmosphere, orders, made)
        finally:
            for tables in made:
                tables.release()

    def run_on_gpu(
        self,
        atmosphere: Atmosphere,
        orders: int = 4,
        progress: Progress | None = None,
        observe: Observe | None = None,
    ) -> tuple[GpuTables, ...]:
        """The tables as textures, of four wavelengths each; the caller releases them.

        Args:
            observe: called with every pass when its textures are complete.
        """
        slices = self.slices(atmosphere, orders, observe)
        while True:
            try:
                share = next(slices)
            except StopIteration as end:
                return tuple(end.value)
            if progress is not None:
                self.context.finish()
                progress(share)

    def slices(
        self, atmosphere: Atmosphere, orders: int = 4, observe: Observe | None = None
    ) -> Generator[float, None, tuple[GpuTables, ...]]:
        """`run_on_gpu` in slices of a few milliseconds, for a thread that has frames to draw.

        Yields the share done after each slice; its return value are the tables.
        """
        if orders < 1:
            raise ValueError(f"orders must be 1 or more, not {orders}")
        refuse_untabled(atmosphere)
        airs = list(buffers_of_air(atmosphere))
        made: list[GpuTables] = []
        try:
            for index, content in enumerate(airs):
                made.append(GpuTables.empty(self.context, self.sizes))
                for share in self._make(content, made[-1], orders, observe):
                    yield (index + share) / len(airs)
        except BaseException:
            for tables in made:
                tables.release()
            raise
        return tuple(made)

    def release(self) -> None:
        """Free the GPU's memory, and the context if it is the pipeline's own."""
        for part in (*self._work, *self.programs.values()):
            part.release()
        if self._own_context:
            self.context.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def _make(
        self, content: bytes, made: GpuTables, orders: int, observe: Observe | None
    ) -> Generator[float, None, None]:
        air = self.context.buffer(content)
        try:
            todo = list(passes(self.sizes, made, self._work, orders))
            for done, step in enumerate(todo, start=1):
                for _ in step.dispatches(self.programs[step.shader], air):
                    yield (done - 1) / len(todo)
                self.context.memory_barrier()
                if observe is not None:
                    observe(step)
            yield 1.0
        finally:
            air.release()

    def _read(self, atmosphere: Atmosphere, orders: int, made: tuple[GpuTables, ...]) -> Tables:
        total = len(atmosphere.wavelength_nm)
        counts = [min(LANES, total - LANES * k) for k in range(len(made))]

        def flat(name: str) -> FloatArray:
            pairs = zip(made, counts, strict=True)
            return np.concatenate([read_flat(getattr(t, name), n) for t, n in pairs], axis=-1)

        def deep(name: str) -> FloatArray:
            pairs = zip(made, counts, strict=True)
            parts = [read_scattering(getattr(t, name), self.sizes, n) for t, n in pairs]
            return np.concatenate(parts, axis=-1)

        return Tables(
            atmosphere=atmosphere,
            sizes=self.sizes,
            orders=orders,
            parametrisation="2017",
            transmittance=np.exp(-flat("optical_depth")),
            irradiance=flat("irradiance"),
            scattering=deep("scattering"),
            single_mie=deep("single_mie"),
        )


def _standalone_context() -> Any:
    import moderngl

    try:
        if not has_egl():
            return moderngl.create_context(standalone=True, require=430)
        # moderngl's annotation of `backend` is wrong: its own documentation passes a text.
        return moderngl.create_context(standalone=True, require=430, backend="egl")  # type: ignore[arg-type]
    except Exception as reason:
        raise UserError(
            f"no OpenGL 4.3 here ({reason}): precompute on the CPU, or install a driver (on Debian "
            "the packages libegl1 and libgl1)"
        ) from None

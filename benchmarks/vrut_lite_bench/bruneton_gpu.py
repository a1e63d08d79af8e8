"""Bruneton's sky on the GPU, timed on whatever OpenGL there is, beside what others published.

The precomputation's shaders one by one, cube maps from a sky-view table, volumes of the air before
things, and cube maps of single scattering without any table.

python -m vrut_lite_bench.bruneton_gpu
"""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.air_volume import AirSizes
from bruneton_sky.air_volume.gpu import air_volume_job
from bruneton_sky.reference.gpu_pipeline.air_buffer import buffers_of_air
from bruneton_sky.reference.gpu_pipeline.passes import Pass, Workspace, passes
from bruneton_sky.reference.gpu_pipeline.programs import compile_programs
from bruneton_sky.reference.gpu_pipeline.tables import GpuTables
from bruneton_sky.reference.gpu_single_scattering import single_scattering_cube_job
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.single_scattering import Rule
from bruneton_sky.sky_view import SkyView, sky_view
from bruneton_sky.sky_view.gpu import sky_view_job
from bruneton_sky.solver import solve
from bruneton_sky.solver_job import solve_air
from bruneton_sky.tables.sizes import TableSizes

from vrut_lite.gpu_job import GpuJob
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.texture_pool import TexturePool
from vrut_lite_bench.gpu_clock import clock_name, has_timer, least_s

ORDERS = 4
FULL = TableSizes()
# What a renderer without a GPU does in seconds; its times tell nothing of full sizes.
SMALL = TableSizes(
    transmittance_altitude=16, transmittance_mu=64, irradiance_altitude=8, irradiance_mu_s=16,
    altitude=8, mu=32, nu=4, mu_s=8,
)  # fmt: skip
CUBES, SMALL_CUBES = (256, 512, 1024, 2048), (256, 512)
# Nodes a segment; intervals along the view and from there to the sun.
RULES: dict[Rule, int | tuple[int, int]] = {
    "gauss-legendre": 12,
    "midpoint": (32, 8),
    "trapezoid": (32, 8),
    "simpson": (32, 8),
}
RULE_CUBE, SMALL_RULE_CUBE = 1024, 128
PLACES = {"ground": 0.0, "2 km": 2000.0, "1000 km": 1e6}
# Visibility in fog, m; haze is that of turbidity 3.
AIRS: dict[str, float | None] = {"haze": None, "haze and fog": 1000.0}
REACH_M = 1e5
# Thesis (Hvezda 2020), section 5.2 and table 5.2, GTX 1060: milliseconds.
THESIS_PRECOMPUTATION_MS = 1138.03
THESIS_CUBE_MS = {256: 0.89, 512: 2.87, 1024: 4.48, 2048: 10.58, 4096: 30.05}
# Hillaire 2020, GTX 1080: a 1280x720 frame with all its small tables made anew.
HILLAIRE_FRAME_MS = 0.31


class GpuTimes(NamedTuple):
    """Seconds; `passes` by shader and order, `cubes` by place and size, `volumes` by air and place,
    `rules` by name."""

    renderer: str
    clock: str
    sizes: TableSizes
    whole: float
    passes: dict[tuple[str, int], float]
    cubes: dict[tuple[str, int], float]
    volumes: dict[tuple[str, str], float]
    rule_size: int
    rules: dict[Rule, float]


def measure() -> GpuTimes:
    """Everything, once; without the transfer of any result."""
    owner = GlOwner()
    real = has_timer(owner.renderer)
    sizes, rule_size = (FULL, RULE_CUBE) if real else (SMALL, SMALL_RULE_CUBE)
    whole, by_pass = owner.call(partial(_precomputation, sizes=sizes))
    times = GpuTimes(
        renderer=owner.renderer.split(" (")[0],
        clock=clock_name(owner.renderer),
        sizes=sizes,
        whole=whole,
        passes=by_pass,
        cubes=owner.call(partial(_cubes, sizes=CUBES if real else SMALL_CUBES)),
        volumes=owner.call(_volumes),
        rule_size=rule_size,
        rules=owner.call(partial(_rules, size=rule_size)),
    )
    owner.close()
    return times


def _precomputation(context: Any, sizes: TableSizes) -> tuple[float, dict[tuple[str, int], float]]:
    programs = compile_programs(context, sizes)
    made, work = GpuTables.empty(context, sizes), Workspace.empty(context, sizes)
    (content,) = buffers_of_air(Atmosphere.earth())
    air, steps = context.buffer(content), list(passes(sizes, made, work, ORDERS))

    def run(step: Pass) -> None:
        for _ in step.dispatches(programs[step.shader], air):
            pass
        context.memory_barrier()

    def run_all() -> None:
        for step in steps:
            run(step)

    whole = least_s(context, run_all)
    by_pass = {(s.shader, s.order): least_s(context, partial(run, s)) for s in steps}
    for part in (air, *made, *work, *programs.values()):
        part.release()
    return whole, by_pass


def _sun() -> Any:
    elevation = np.radians(20.0)
    return np.array([np.cos(elevation), np.sin(elevation), 0.0])


def _cubes(context: Any, sizes: tuple[int, ...]) -> dict[tuple[str, int], float]:
    field = solve(Atmosphere.earth(), ORDERS)
    views: dict[str, SkyView] = {
        place: sky_view(field, altitude_m, _sun()) for place, altitude_m in PLACES.items()
    }
    jobs = {
        (place, size): sky_view_job(view, size, (0.1, 0.1, 0.1), "bench", "cube")[0]
        for place, view in views.items()
        for size in sizes
    }
    return {key: _job_time(context, job) for key, job in jobs.items()}


def _volumes(context: Any) -> dict[tuple[str, str], float]:
    fields = {
        name: solve_air(atmosphere_of(BrunetonSkySettings(fog_visibility_m=visibility_m)))
        for name, visibility_m in AIRS.items()
    }
    jobs = {
        (name, place): air_volume_job(field, altitude_m, _sun(), REACH_M, "bench", "air")[0]
        for name, field in fields.items()
        for place, altitude_m in PLACES.items()
    }
    return {key: _job_time(context, job) for key, job in jobs.items()}


def _rules(context: Any, size: int) -> dict[Rule, float]:
    air = Atmosphere.earth()
    jobs = {
        rule: single_scattering_cube_job(
            "bench", "cube", air, 0.0, _sun(), size, rule=rule, samples=samples
        )
        for rule, samples in RULES.items()
    }
    return {rule: _job_time(context, job) for rule, job in jobs.items()}


def _job_time(context: Any, job: GpuJob) -> float:
    """The shader into a texture that is kept."""
    program = context.compute_shader(job.compute_shader)
    for name, value in job.uniforms.items():
        if name in program:
            program[name].value = value
    buffers = {binding: context.buffer(array.values.tobytes()) for binding, array in job.buffers}
    for binding, buffer in buffers.items():
        buffer.bind_to_storage_buffer(binding)
    texture = TexturePool().take(context, job).opaque
    texture.bind_to_image(0, read=False, write=True)
    work: Callable[[], None] = partial(program.run, *job.groups)
    spent = least_s(context, work)
    for part in (texture, program, *buffers.values()):
        part.release()
    return spent


def report(times: GpuTimes) -> Iterator[str]:
    """Markdown tables, beside the thesis's GTX 1060 and Hillaire's GTX 1080."""
    yield f"{times.renderer}, {times.clock}; milliseconds"
    yield ""
    yield from _report_precomputation(times)
    yield ""
    yield from _report_cubes(times)
    yield ""
    yield from _report_volumes(times)
    yield ""
    yield f"single scattering without tables, cube map {times.rule_size}², from the ground"
    yield "| rule | samples | ms |"
    yield "|---|---:|---:|"
    for rule, seconds in times.rules.items():
        yield f"| {rule} | {RULES[rule]} | {seconds * 1e3:.3g} |"


def _report_precomputation(times: GpuTimes) -> Iterator[str]:
    size = times.sizes
    what = "full sizes" if size == FULL else "SMALL sizes, not to be compared with"
    shape = "x".join(str(n) for n in size.scattering_shape)
    yield (
        f"precomputation, {ORDERS} orders, 3 wavelengths, {what} (scattering {shape}): "
        f"**{times.whole * 1e3:.3g} ms**; thesis {THESIS_PRECOMPUTATION_MS:g} ms"
    )
    orders = sorted({order for _, order in times.passes})
    yield "| shader | " + " | ".join(f"order {order}" for order in orders) + " |"
    yield "|---|" + "---:|" * len(orders)
    for shader in dict.fromkeys(name for name, _ in times.passes):
        cells = [times.passes.get((shader, order)) for order in orders]
        row = " | ".join("" if cell is None else f"{cell * 1e3:.3g}" for cell in cells)
        yield f"| {shader} | {row} |"


def _report_cubes(times: GpuTimes) -> Iterator[str]:
    yield f"cube map from the sky-view table; Hillaire's whole frame: {HILLAIRE_FRAME_MS} ms"
    yield "| map | " + " | ".join(PLACES) + " | thesis |"
    yield "|---:|" + "---:|" * (len(PLACES) + 1)
    for size in sorted({size for _, size in times.cubes}):
        row = " | ".join(f"{times.cubes[place, size] * 1e3:.3g}" for place in PLACES)
        yield f"| {size}² | {row} | {THESIS_CUBE_MS[size]} |"


def _report_volumes(times: GpuTimes) -> Iterator[str]:
    size = AirSizes()
    rows = size.rows_above + size.rows_below
    yield f"light of the air before things, {size.slices} x {rows} x {size.columns} nodes"
    yield "| air | " + " | ".join(PLACES) + " |"
    yield "|---|" + "---:|" * len(PLACES)
    for name in AIRS:
        row = " | ".join(f"{times.volumes[name, place] * 1e3:.3g}" for place in PLACES)
        yield f"| {name} | {row} |"


if __name__ == "__main__":
    for text in report(measure()):
        print(text, flush=True)

"""The GPU's cube map, timed on whatever OpenGL there is, beside what its memory could write.

python -m vrut_lite_bench.hosek_wilkie_gpu
"""

from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from dynamic_skylight.hosek_wilkie.gpu_cube import gpu_cube_job
from dynamic_skylight.hosek_wilkie.sky import half_scale

from vrut_lite.gpu_job import GpuJob
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite_bench.errors import relative_errors
from vrut_lite_bench.gpu_clock import Bandwidth, bandwidth, clock_name, least_s
from vrut_lite_bench.hosek_wilkie_formats import AZIMUTH_RAD, SKY, exact_radiance, judged
from vrut_lite_bench.hosek_wilkie_published import THESIS_MS

SIZES = (256, 512, 1024, 2048, 4096)
GROUND = (0.0, 0.0, 0.0)
_TEXEL_BYTES = 8
# As many stores, to the same texels, of what costs nothing to compute.
_STORE_ONLY = """#version 430
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform imageCube sky;
void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    imageStore(sky, at, vec4(at & 1023, 1.0));
}
"""


class GpuTimes(NamedTuple):
    """The renderer, how it was timed, seconds by size of map and of mere stores, and the error.

    The error is that of 256 texels; bandwidth is that of a buffer as large as the largest map.
    """

    renderer: str
    clock: str
    seconds: dict[int, float]
    stores: dict[int, float]
    error: float
    bandwidth: Bandwidth


def measure(sizes: tuple[int, ...] = SIZES) -> GpuTimes:
    """The job's shader into a texture that is kept; without the transfer of anything."""
    owner = GlOwner()
    pairs = {size: owner.call(partial(_map_and_stores, size=size)) for size in sizes}
    largest = _bytes_of(max(sizes))
    times = GpuTimes(
        renderer=owner.renderer.split(" (")[0],
        clock=clock_name(owner.renderer),
        seconds={size: pair[0] for size, pair in pairs.items()},
        stores={size: pair[1] for size, pair in pairs.items()},
        error=owner.call(_error),
        bandwidth=owner.call(partial(bandwidth, size_bytes=largest)),
    )
    owner.close()
    return times


def _bytes_of(size: int) -> int:
    return 6 * size * size * _TEXEL_BYTES


def _prepared(context: Any, size: int) -> tuple[Any, Any, GpuJob]:
    scale = half_scale(SKY.brightest)
    job = gpu_cube_job("bench", "cube", SKY, AZIMUTH_RAD, GROUND, size, scale)
    program = context.compute_shader(job.compute_shader)
    for name, value in job.uniforms.items():
        program[name].value = value
    texture = context.texture_cube((size, size), 4, dtype="f2")
    texture.bind_to_image(0, read=False, write=True)
    return program, texture, job


def _map_and_stores(context: Any, size: int) -> tuple[float, float]:
    program, texture, job = _prepared(context, size)
    stores = context.compute_shader(_STORE_ONLY)
    spent = [least_s(context, partial(run, *job.groups)) for run in (program.run, stores.run)]
    texture.release()
    return spent[0], spent[1]


def _error(context: Any) -> float:
    program, texture, job = _prepared(context, 256)
    program.run(*job.groups)
    context.memory_barrier()
    faces = [np.frombuffer(texture.read(face), np.float16) for face in range(6)]
    cube = np.stack(faces).reshape(6, 256, 256, 4)[..., :3]
    texture.release()
    texels = judged(256)
    found = texels.of(cube) * half_scale(SKY.brightest)
    return relative_errors(found, exact_radiance(SKY, texels.directions)).largest


def report(times: GpuTimes) -> Iterator[str]:
    """A Markdown table of the maps beside what the memory could write and the thesis's GPU."""
    fill, copy = times.bandwidth
    yield f"{times.renderer}, {times.clock}; largest error {times.error:.1e}"
    yield f"bandwidth: fill {fill / 1e9:.4g} GB/s, copy {copy / 1e9:.4g} GB/s read and written"
    yield "| map | MB written | ms | GB/s | of the fill's rate | of mere stores' | thesis, ms |"
    yield "|---:|---:|---:|---:|---:|---:|---:|"
    for size, seconds in times.seconds.items():
        rate = _bytes_of(size) / seconds
        yield (
            f"| {size}² | {_bytes_of(size) / 1e6:.3g} | {seconds * 1e3:.3g} | {rate / 1e9:.3g} "
            f"| {rate / fill:.0%} | {times.stores[size] / seconds:.0%} "
            f"| {THESIS_MS['thesis, GPU'].get(size, '')} |"
        )


if __name__ == "__main__":
    for text in report(measure()):
        print(text, flush=True)

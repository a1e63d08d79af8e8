"""Hosek-Wilkie cube maps by format and size, and the error that looking them up adds."""

from collections.abc import Callable
from functools import lru_cache, partial
from importlib.util import find_spec
from typing import Any

import msgspec
import numpy as np
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.gpu_cube import gpu_cube_job
from dynamic_skylight.hosek_wilkie.sky import half_scale
from numpy.typing import NDArray

from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite_lab.bench.bench_path import (
    PICTURE_NORM,
    BenchPath,
    Errors,
    Group,
    Work,
    relative_errors,
)
from vrut_lite_lab.bench.gl import GlTexture, GlWork, gl_clock, has_timer, missing_gl, renderer
from vrut_lite_lab.bench.own_process import measured_path
from vrut_lite_lab.bench.paths import hosek_wilkie_mitsuba
from vrut_lite_lab.bench.paths.hosek_wilkie_formats import (
    AZIMUTH_RAD,
    FORMATS,
    SKY,
    Format,
    exact_radiance,
    fast_float16,
    fast_float32,
    judged,
    of_half,
)
from vrut_lite_lab.bench.skies import random_directions

SIZES = (64, 256, 512, 1024, 2048, 4096)
QUICK_SIZES = (64, 256)
LOOK_UP_SIZES = (16, 32, 64, 128, 256, 512, 1024)
GPU_SIZES, CARD_SIZES = (64, 256, 1024), (64, 256, 512, 1024, 2048, 4096)
MITSUBA_SIZES = (64, 256, 1024)
# Other hours than the one that is timed at all sizes: turbidity, albedo, elevation in degrees.
HOURS = ((1.0, 0.0, 2.0), (10.0, 1.0, 2.0), (5.0, 0.1, 10.0), (10.0, 0.5, 88.0))
# Larger maps are made for one hour only.
_MANY_HOURS_TO = 256
_LOOK_UPS = 20_000
_TEXEL_BYTES = 8
# As many stores as a map takes, of values that cost nothing to compute.
_STORES = """#version 430
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform imageCube sky;
void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    imageStore(sky, at, vec4(at & 1023, 1.0));
}
"""
_FILL_GROUPS = 16384
_FILL = """#version 430
layout(local_size_x = 256) in;
layout(std430, binding = 0) writeonly buffer Words { uvec4 words[]; };
void main() {
    // No two alike, lest the memory compress them.
    uint step = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint i = gl_GlobalInvocationID.x; i < uint(words.length()); i += step) {
        words[i] = uvec4(i, i * 3u, i * 7u, ~i);
    }
}
"""


def groups(quick: bool) -> list[Group]:
    """Cube maps by format, and pictures looked up in them."""
    return [_formats(quick), _look_ups(quick)]


def _formats(quick: bool) -> Group:
    sizes = QUICK_SIZES if quick else SIZES
    paths = [_path(kind, size) for size in sizes for kind in FORMATS if size <= kind.largest]
    left_out = {}
    if find_spec("mitsuba") is None:
        left_out["mitsuba's sunsky"] = "mitsuba is not installed (the extra `ref`)"
    elif not hosek_wilkie_mitsuba.llvm_library():
        left_out["mitsuba's sunsky"] = "mitsuba finds no LLVM 19"
    else:
        paths += _mitsuba_paths(QUICK_SIZES if quick else MITSUBA_SIZES)
    if missing_gl():
        left_out["Hosek-Wilkie on the GPU"] = missing_gl()
    else:
        gpu_sizes = CARD_SIZES if has_timer(renderer()) else GPU_SIZES
        paths += [_gpu_path(size) for size in gpu_sizes if not quick or size in sizes]
        if not quick:
            paths += [_stores_path(size) for size in gpu_sizes]
            paths += [_buffer_path(name, gpu_sizes[-1]) for name in ("filled", "copied")]
    return Group(
        name="hosek-wilkie",
        title="Hosek-Wilkie cube map",
        unit="a map",
        norm=f"{PICTURE_NORM} (of texels)",
        truth="the formula in extended precision",
        front_of="256²",
        paths=tuple(paths),
        left_out=left_out,
    )


@lru_cache
def skies(many: bool) -> dict[str, HosekWilkieSky]:
    """The hours by name, the one that is timed at all sizes first."""
    hours = {"turbidity 3, albedo 0.1, sun 45°": SKY}
    for turbidity, albedo, elevation_deg in HOURS if many else ():
        name = f"turbidity {turbidity:g}, albedo {albedo:g}, sun {elevation_deg:g}°"
        hours[name] = HosekWilkieSky(turbidity, albedo, np.radians(elevation_deg))
    return hours


def _path(kind: Format, size: int) -> BenchPath:
    many = size <= _MANY_HOURS_TO
    return BenchPath(
        name=f"{kind.name}, {size}²",
        family=kind.name,
        parameters={"size": size},
        prepare=partial(_prepare, kind, size, many),
        error=partial(_error, kind, size, many),
        units=len(skies(many)),
        batch=str(size),
    )


def _prepare(kind: Format, size: int, many: bool) -> Work:
    works = [kind.make(sky, size) for sky in skies(many).values()]
    return lambda: [work() for work in works]


def _error(kind: Format, size: int, many: bool, cubes: list[NDArray[Any]]) -> dict[str, Errors]:
    return {
        name: _texel_errors(sky, kind.decode(sky, judged(size).of(cube)), size)
        for (name, sky), cube in zip(skies(many).items(), cubes, strict=True)
    }


def _texel_errors(sky: HosekWilkieSky, found: NDArray[np.float64], size: int) -> Errors:
    return relative_errors(found, _exact(sky, size))


@lru_cache
def _exact(sky: HosekWilkieSky, size: int) -> NDArray[np.float64]:
    return exact_radiance(sky, judged(size).directions)


def _gpu_path(size: int) -> BenchPath:
    return BenchPath(
        name=f"GPU shader, float16, {size}²",
        family="GPU shader, float16",
        parameters={"size": size},
        prepare=partial(_prepare_gpu, size),
        error=partial(_gpu_error, size),
        batch=f"GPU {size}",
        clock=gl_clock(),
        device="GPU",
    )


def _prepare_gpu(size: int) -> GlTexture:
    return GlTexture(_gpu_job(size))


def _gpu_job(size: int) -> GpuJob:
    scale = half_scale(SKY.brightest)
    return gpu_cube_job("bench", "cube", SKY, AZIMUTH_RAD, (0.0, 0.0, 0.0), size, scale)


def _stores_path(size: int) -> BenchPath:
    """The memory's share of a map's time: the same texels stored, nothing computed."""
    name = "GPU, stores alone"

    def prepare() -> Work:
        job = msgspec.structs.replace(_gpu_job(size), compute_shader=_STORES, uniforms={})
        return GlTexture(job)

    return _memory_path(f"{name}, {size}²", name, size, prepare)


def _buffer_path(done: str, size: int) -> BenchPath:
    """A buffer as large as a map, filled or copied, for the memory's bandwidth."""
    name = f"GPU, buffer {done}"
    return _memory_path(f"{name}, {size}²", name, size, partial(_prepare_buffer, done, size))


def _prepare_buffer(done: str, size: int) -> Work:
    def prepare(context: Any) -> Callable[[], None]:
        count = 6 * size * size * _TEXEL_BYTES
        first, second = (context.buffer(reserve=count) for _ in range(2))
        if done == "copied":
            return lambda: context.copy_buffer(second, first)
        program = context.compute_shader(_FILL)

        def fill() -> None:
            first.bind_to_storage_buffer(0)
            program.run(_FILL_GROUPS)

        return fill

    return GlWork(prepare)


def _memory_path(name: str, family: str, size: int, prepare: Callable[[], Work]) -> BenchPath:
    return BenchPath(
        name=name,
        family=family,
        parameters={"size": size, "bytes": 6 * size * size * _TEXEL_BYTES},
        prepare=prepare,
        error=None,
        batch=f"GPU {size}",
        clock=gl_clock(),
        device="GPU",
    )


def _gpu_error(size: int, cube: GlTexture) -> dict[str, Errors]:
    (name,) = skies(False)
    return {name: _texel_errors(SKY, of_half(SKY, judged(size).of(cube.read())), size)}


def _mitsuba_paths(sizes: tuple[int, ...]) -> list[BenchPath]:
    return [_mitsuba_path(texels, size, sizes) for texels in ("sky", "all") for size in sizes]


def _mitsuba_path(texels: str, size: int, sizes: tuple[int, ...]) -> BenchPath:
    family = f"mitsuba's sunsky, {texels} texels"
    return measured_path(
        f"{family}, {size}²",
        family,
        "mitsuba",
        "CPU time of one thread of its own process",
        lambda: float(_live_mitsuba(sizes)[texels][str(size)]),
        lambda _: {next(iter(skies(False))): Errors(*_live_mitsuba(sizes)["errors"])},
        {"size": size},
    )


@lru_cache(maxsize=1)
def _live_mitsuba(sizes: tuple[int, ...]) -> dict[str, Any]:
    return hosek_wilkie_mitsuba.measure(sizes)


def _look_ups(quick: bool) -> Group:
    kinds = (Format("float32", fast_float32), Format("float16", fast_float16, of_half))
    sizes = QUICK_SIZES if quick else LOOK_UP_SIZES
    return Group(
        name="cube-look-up",
        title="Sky looked up in a Hosek-Wilkie cube map",
        unit="a map",
        norm=f"{PICTURE_NORM} (of {_LOOK_UPS} directions, linear look-up between texels)",
        truth="the formula in extended precision, in those directions",
        paths=tuple(_look_up_path(kind, size) for kind in kinds for size in sizes),
    )


def _look_up_path(kind: Format, size: int) -> BenchPath:
    return BenchPath(
        name=f"{kind.name}, {size}²",
        family=kind.name,
        parameters={"size": size},
        prepare=partial(_prepare, kind, size, True),
        error=partial(_look_up_error, kind),
        units=len(skies(True)),
    )


def _look_up_error(kind: Format, cubes: list[NDArray[Any]]) -> dict[str, Errors]:
    towards = random_directions(_LOOK_UPS)
    return {
        name: relative_errors(kind.decode(sky, sample_sky(cube, towards)), _exact_looked_up(sky))
        for (name, sky), cube in zip(skies(True).items(), cubes, strict=True)
    }


@lru_cache
def _exact_looked_up(sky: HosekWilkieSky) -> NDArray[np.float64]:
    return exact_radiance(sky, random_directions(_LOOK_UPS))

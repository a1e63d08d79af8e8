"""Light scattered once, by rule and samples: in numpy, compiled, by bins, and as a shader."""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np
from bruneton_sky import Atmosphere, preset, single_scattering
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.published.gpu_single_scattering import single_scattering_cube_job
from bruneton_sky.published.single_scattering import Rule
from bruneton_sky.single_scattering_kernels import fast_scattered_without_phase
from bruneton_sky.solver import SourceField, single_scattering_fast, solve
from numpy.typing import NDArray

from vrut_lite.geometry.colour import three_sample_scale
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.bench.bench_path import BenchPath, Errors, Group, Work, relative_errors
from vrut_lite_lab.bench.gl import GlTexture, GlTextures, gl_clock, missing_gl
from vrut_lite_lab.bench.skies import ONE_LOBE, air, sun_at

Samples = int | tuple[int, int]
NODES, QUICK_NODES = (3, 4, 6, 8, 12, 16, 24), (4, 12)
INTERVALS, QUICK_INTERVALS = ((8, 4), (16, 8), (32, 8), (32, 16), (64, 16)), ((16, 8),)
CLASSICAL: tuple[Rule, ...] = ("midpoint", "trapezoid", "simpson")
# Steps along a ray and the bins that they are merged into.
BINS, QUICK_BINS = ((24, 12), (48, 24), (96, 48), (192, 96)), ((48, 24),)
SUNS_DEG = (60.0, 10.0, 0.5, -4.0)
HEIGHTS_M = (0.0, 5000.0)
AIRS = ("clear air", ONE_LOBE)
_TRUE_NODES = 96
# Edge of the cube whose texels are the rays, of all directions; and that of the shader's.
_RAYS, _GPU_SIZE = 6, 32


def groups(quick: bool) -> list[Group]:
    """A group for each air."""
    return [_group(name, quick) for name in (AIRS[:1] if quick else AIRS)]


def _group(name: str, quick: bool) -> Group:
    paths = [_by_rule(name, "gauss-legendre", n) for n in (QUICK_NODES if quick else NODES)]
    paths += [_compiled(name, n) for n in (QUICK_NODES if quick else NODES)]
    paths += [_by_bins(name, n) for n in (QUICK_BINS if quick else BINS)]
    intervals = QUICK_INTERVALS if quick else INTERVALS
    paths += [_by_rule(name, rule, n) for rule in CLASSICAL for n in intervals]
    left_out = {}
    if missing_gl():
        left_out["single scattering on the GPU"] = missing_gl()
    elif name == AIRS[0]:
        shaders: list[tuple[Rule, Samples]]
        shaders = [("gauss-legendre", 12), *((rule, (32, 8)) for rule in CLASSICAL)]
        paths += [_as_shader(rule, n) for rule, n in shaders[: 1 if quick else None]]
    return Group(
        name=f"single-scattering-{name.replace(' ', '-')}",
        title=f"Light scattered once, {name}",
        unit="a ray",
        norm="difference over the larger of the value and a thousandth of the brightest ray's, "
        "each wavelength; 99th percentile over rays in all directions",
        truth=f"Gauss and Legendre's rule with {_TRUE_NODES} nodes a segment, float64",
        paths=tuple(paths),
        left_out=left_out,
    )


class ObserverRays:
    """Rays (n,) of one observer and one sun, in one air."""

    def __init__(self, atmosphere: Atmosphere, height_m: float, elevation_deg: float):
        self.name = f"sun {elevation_deg:g}°, {height_m:g} m up"
        self.atmosphere, self.height_m = atmosphere, height_m
        sun = sun_at(elevation_deg)
        directions = texel_directions(_RAYS).reshape(-1, 3)
        directions = directions[np.argsort(directions[:, 1], kind="stable")]
        self.mu_s = float(sun[1])
        self.mu = np.ascontiguousarray(directions[:, 1])
        self.nu = np.clip(directions @ sun, -1.0, 1.0)

    def light(self, rayleigh: FloatArray, mie: FloatArray) -> FloatArray:
        """Radiance of its parts without phase functions."""
        nu = self.nu[:, None]
        return rayleigh * rayleigh_phase(nu) + mie * mie_phase(self.atmosphere, nu)


@lru_cache
def all_rays(name: str) -> list[ObserverRays]:
    """The grid of conditions in an air."""
    atmosphere = air(name)
    return [ObserverRays(atmosphere, height_m, sun) for height_m in HEIGHTS_M for sun in SUNS_DEG]


@lru_cache
def truths(name: str) -> list[FloatArray]:
    """The true radiance of all of them."""
    return _all_by_rule(name, "gauss-legendre", _TRUE_NODES)()


def _by_rule(name: str, rule: Rule, samples: Samples) -> BenchPath:
    prepare = partial(_all_by_rule, name, rule, samples)
    return _path(name, f"numpy, {rule}", samples, prepare)


def _compiled(name: str, nodes: int) -> BenchPath:
    def light(r: ObserverRays) -> FloatArray:
        return r.light(
            *fast_scattered_without_phase(r.atmosphere, r.height_m, r.mu, r.mu_s, r.nu, nodes)
        )

    return _path(name, "compiled, gauss-legendre", nodes, lambda: _of_all_rays(name, light))


def _by_bins(name: str, counts: tuple[int, int]) -> BenchPath:
    def prepare() -> Work:
        field = _dark(air(name), counts)
        return _of_all_rays(
            name, lambda r: r.light(*single_scattering_fast(field, r.height_m, r.mu, r.mu_s, r.nu))
        )

    return _path(name, "ray bins, float32", counts, prepare)


def _all_by_rule(name: str, rule: Rule, samples: Samples) -> Work:
    return _of_all_rays(
        name,
        lambda r: single_scattering(r.atmosphere, r.height_m, r.mu, r.mu_s, r.nu, rule, samples),
    )


def _of_all_rays(name: str, light: Callable[[ObserverRays], FloatArray]) -> Work:
    return lambda: [light(rays) for rays in all_rays(name)]


def _path(name: str, family: str, samples: Samples, prepare: Callable[[], Work]) -> BenchPath:
    view, light = samples if isinstance(samples, tuple) else (samples, 0)
    return BenchPath(
        name=f"{family}, {_in_words(samples)}",
        family=family,
        parameters={"samples": view, "second_samples": light},
        prepare=prepare,
        error=partial(_error, name),
        units=sum(rays.mu.size for rays in all_rays(name)),
    )


def _in_words(samples: Samples) -> str:
    return f"{samples} nodes" if isinstance(samples, int) else "{} x {}".format(*samples)


def _error(name: str, found: list[FloatArray]) -> dict[str, Errors]:
    return {
        rays.name: relative_errors(light, right)
        for rays, light, right in zip(all_rays(name), found, truths(name), strict=True)
    }


def _dark(atmosphere: Atmosphere, counts: tuple[int, int]) -> SourceField:
    """A field of light scattered once, looked at with that many steps and bins."""
    field = solve(atmosphere, orders=1)
    steps, bins = counts
    few = min(bins, field.sizes.multiple_bins), min(bins, field.sizes.node_bins)
    sizes = replace(
        field.sizes, steps=steps, single_bins=bins, multiple_bins=few[0], node_bins=few[1]
    )
    return replace(field, sizes=sizes)


_GPU_SUNS_DEG = (60.0, 10.0)


def _as_shader(rule: Rule, samples: Samples) -> BenchPath:
    return BenchPath(
        name=f"GPU shader, {rule}, {_in_words(samples)}",
        family=f"GPU shader, {rule}",
        prepare=partial(_prepare_shader, rule, samples),
        error=_shader_error,
        units=6 * _GPU_SIZE * _GPU_SIZE * len(_GPU_SUNS_DEG),
        batch="GPU",
        clock=gl_clock(),
        device="GPU",
    )


def _prepare_shader(rule: Rule, samples: Samples) -> Work:
    return GlTextures(
        [
            GlTexture(
                single_scattering_cube_job(
                    "bench", "cube", preset("earth-clear"), 0.0, sun_at(sun), _GPU_SIZE,
                    rule=rule, samples=samples, format="rgba32f",
                )
            )
            for sun in _GPU_SUNS_DEG
        ]
    )  # fmt: skip


def _shader_error(done: GlTextures) -> dict[str, Errors]:
    return {
        f"three wavelengths, sun {sun:g}°, 0 m up": relative_errors(
            cube.read()[_above()], _shader_truth(sun)
        )
        for sun, cube in zip(_GPU_SUNS_DEG, done.textures, strict=True)
    }


def _above() -> NDArray[np.bool_]:
    return texel_directions(_GPU_SIZE)[..., 1] > 0.0


@lru_cache
def _shader_truth(elevation_deg: float) -> FloatArray:
    atmosphere, sun = preset("earth-clear"), sun_at(elevation_deg)
    directions = texel_directions(_GPU_SIZE)[_above()]
    nu = np.clip(directions @ sun, -1.0, 1.0)
    light = single_scattering(
        atmosphere, 0.0, directions[:, 1], sun[1], nu, samples=_TRUE_NODES // 2
    )
    return np.asarray(light * three_sample_scale(atmosphere.wavelength_nm, 3.0))

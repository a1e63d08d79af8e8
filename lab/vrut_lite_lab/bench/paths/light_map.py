"""Light between surfaces: a furnished room's map by rays and texels; the time of each step.

Errors are those of the map at the middles of random texels, smoothing and all, against rays that
start at these very points in a bake with more texels, rays, patches and bounces.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
from dynamic_skylight import HosekWilkieSky
from light_transport.hour.illumination import HourLight, Illumination
from light_transport.jobs import first_rays
from light_transport.layout.layout import Layout, lay_out
from light_transport.surfaces.surfaces import Surfaces, surfaces_of
from light_transport.tolerance import RUNGS, quality_for
from light_transport.transport import SceneTransport
from light_transport.view.point_light import light_at

from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import Float32Array
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed
from vrut_lite_lab.bench.bench_path import BenchPath, Errors, Group, Work, sizes_of
from vrut_lite_lab.bench.gl import gl_clock, missing_gl
from vrut_lite_lab.bench.light_on_card import LightOnCard
from vrut_lite_lab.bench.paths.frame import SCENES
from vrut_lite_lab.bench.skies import sun_at

SCENE = "work/indoor.glb"
RAYS, QUICK_RAYS = (16, 64, 256), (16, 64)
TEXELS = (7_500, 15_000, 60_000)
# Of the paths in which the other is changed.
USUAL_TEXELS, QUICK_USUAL_TEXELS, USUAL_RAYS = 30_000, 7_500, 128
ELEVATIONS_DEG = (60.0, 20.0)
_NORM = "difference of irradiance over the map's mean, each channel; 99th percentile over points"
_TIMED_TEXELS, _TIMED_RAYS, _QUICK_TIMED_RAYS = 85_000, 256, 16


class _Truth(NamedTuple):
    """Texels, rays of each, patches, points, rays from each."""

    texels: int
    rays: int
    patch_texels: float
    points: int
    point_rays: int


_FULL, _QUICK = _Truth(120_000, 256, 3.0, 3000, 4096), _Truth(15_000, 64, 4.0, 300, 1024)


class Lit(NamedTuple):
    """A bake and the light of each sun (height, width, 4)."""

    transport: SceneTransport
    lights: list[Float32Array]


@lru_cache(maxsize=1)
def _scene() -> tuple[SceneOpened, Surfaces]:
    scene = packed(load_scene(str(SCENES / SCENE)))
    return scene, surfaces_of(scene)


@lru_cache(maxsize=8)
def _layout(texels: int) -> Layout:
    return lay_out(*_scene(), None, texels)


@lru_cache
def hour_of_bench(elevation_deg: float) -> Illumination:
    """Hosek and Wilkie's sky, in units of its zenith, and a sun in proportion."""
    sun = sun_at(elevation_deg)
    sky = HosekWilkieSky(turbidity=3.0, albedo=0.2, sun_elevation_rad=np.radians(elevation_deg))
    cube = np.asarray(sky.cube_map(size=64)[..., :3], np.float32)
    cube /= cube[2].mean()
    return Illumination(
        cube, (0.2,) * 3, (0.2,) * 3, tuple(sun), (9.0,) * 3, irradiance_coefficients(cube)
    )


def groups(quick: bool) -> list[Group]:
    """The bake with its errors, and its steps."""
    texels = QUICK_USUAL_TEXELS if quick else USUAL_TEXELS
    baked = [
        _baked(quick, f"{rays} rays, {texels} texels", "rays", texels, rays)
        for rays in (QUICK_RAYS if quick else RAYS)
    ]
    for count in () if quick else TEXELS:
        baked.append(
            _baked(quick, f"{count} texels, {USUAL_RAYS} rays", "texels", count, USUAL_RAYS)
        )
    # The finest would take as long as all the others.
    for rung in () if quick else RUNGS[:-1]:
        q = quality_for(0.1, rung)
        sizes = (q.texels, q.rays, q.patch_texels, q.bounces_left)
        baked.append(_baked(quick, f"rung {rung}", "the product's rungs", *sizes))
    rays = (_QUICK if quick else _FULL).point_rays
    truth = f"{rays} rays from the very points, finer texels and patches"
    title, steps = f"Light map of {SCENE}", _steps(texels if quick else _TIMED_TEXELS, quick)
    reason = "" if (SCENES / SCENE).exists() else f"there is no {SCENE}"
    return [
        Group(
            name, title + said, unit, norm, against, () if reason else tuple(paths),
            left_out={name: reason} if reason else {},
        )
        for name, said, unit, norm, against, paths in (
            ("light-map", "", "a bake and two hours", _NORM, truth, baked),
            ("light-map-steps", ", step by step", "a step", "none", "none", steps),
        )
    ]  # fmt: skip


def _baked(
    quick: bool,
    name: str,
    family: str,
    texels: int,
    rays: int,
    patch_texels: float = 6.0,
    left: float = 3e-3,
) -> BenchPath:
    return BenchPath(
        name=name,
        family=family,
        parameters={"texels": texels, "rays": rays, "patch_texels": patch_texels},
        prepare=partial(_prepare, texels, rays, patch_texels, left),
        error=partial(_errors, quick),
    )


def _prepare(texels: int, rays: int, patch_texels: float, left: float) -> Work:
    surfaces, layout = _scene()[1], _layout(texels)

    def work() -> Lit:
        transport = SceneTransport(surfaces, layout, 1, patch_texels, left)
        transport.add_rays(rays)
        return Lit(
            transport, [transport.light(hour_of_bench(each)).texels for each in ELEVATIONS_DEG]
        )

    return work


def _errors(quick: bool, lit: Lit) -> dict[str, Errors]:
    truth, texels = _QUICK if quick else _FULL, lit.transport.texels
    table = lit.transport.table
    free = np.flatnonzero((table.valid > 0.9 * table.traced)[: len(texels.pixel)])
    own = free[lit.transport.surfaces.part[lit.transport.colour_of[free]] >= 0]
    chosen = np.random.default_rng(1).choice(own, min(truth.points, len(own)), replace=False)
    places_m = texels.place[chosen].astype(float) * lit.transport.surfaces.radius_m
    places_m += lit.transport.surfaces.centre_m
    column, row = texels.pixel[chosen].T
    found = {}
    for light, each in zip(lit.lights, ELEVATIONS_DEG, strict=True):
        normals = texels.normal[chosen].astype(float)
        transport, rays = _true_bake(truth), truth.point_rays
        exact = light_at(
            transport, places_m, normals, transport.light(hour_of_bench(each)), rays
        ).irradiance_rgb
        found[f"sun {each:g}°"] = sizes_of(np.abs(light[row, column, :3] - exact) / exact.mean())
    return found


@lru_cache(maxsize=1)
def _true_bake(truth: _Truth) -> SceneTransport:
    transport = SceneTransport(_scene()[1], _layout(truth.texels), 2, truth.patch_texels, 1e-5)
    transport.add_rays(truth.rays)
    return transport


def _steps(texels: int, quick: bool) -> list[BenchPath]:
    """The layout, the first round of rays with its light, and an hour by all rays."""
    rays = _QUICK_TIMED_RAYS if quick else _TIMED_RAYS

    def transport() -> SceneTransport:
        return SceneTransport(_scene()[1], _layout(texels), 1)

    def first() -> Lit:
        made = transport()
        made.add_rays(first_rays(made.rows))
        return Lit(made, [made.light(hour_of_bench(60.0)).texels])

    def hour() -> Work:
        made = transport()
        made.add_rays(rays)
        # The first hour also makes what follows from the rays alone.
        made.light(hour_of_bench(60.0))
        return HourWork(made)

    works: dict[str, Callable[[], Work]] = {
        "layout": lambda: partial(lay_out, *_scene(), None, texels),
        "first light": lambda: first,
        f"an hour by {rays} rays": hour,
    }
    paths = [
        BenchPath(
            name=f"{name}, {texels} texels",
            family=name,
            prepare=prepare,
            error=None,
            parameters={"texels": texels},
            done=_hours_done if prepare is hour else None,
        )
        for name, prepare in works.items()
    ]
    if missing_gl():
        return paths

    def on_card(first: bool) -> Work:
        made = transport()
        made.add_rays(rays)
        return LightOnCard(made, hour_of_bench(60.0), first)

    hours = {f"an hour by {rays} rays": False, f"the first hour by {rays} rays, in pieces": True}
    by_card = [
        BenchPath(
            name=f"{name}, GPU shaders, {texels} texels",
            family=f"GPU, {'first hour' if first else 'hour'}",
            prepare=partial(on_card, first),
            error=None,
            parameters={"texels": texels},
            clock=gl_clock(),
            device="GPU",
            batch="GPU",
        )
        for name, first in hours.items()
    ]
    return [*paths, *by_card]


class HourWork:
    """Computes the light of an hour in each call, and counts the lights that it got anew."""

    def __init__(self, transport: SceneTransport):
        self._bake = transport
        self._last: HourLight | None = None
        self.done = 0

    def __call__(self) -> HourLight:
        """The light of the sun 20 degrees high."""
        # A copy of the hour: the bake returns the light of its last hour without computing it.
        light = self._bake.light(replace(hour_of_bench(20.0)))
        self.done += light is not self._last
        self._last = light
        return light


def _hours_done(work: Work) -> int:
    assert isinstance(work, HourWork)
    return work.done

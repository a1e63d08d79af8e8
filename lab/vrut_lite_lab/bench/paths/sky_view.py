"""From a solved atmosphere to a picture: sky-view tables, cube maps, and the whole chain."""

from dataclasses import replace
from functools import lru_cache, partial

import numpy as np
from bruneton_sky.sky_view import SkyView, fill_cube, light_view, sky_view
from bruneton_sky.sky_view.gpu import sky_view_job
from bruneton_sky.sky_view.table_on_card import table_cube_job, table_on_card
from bruneton_sky.solver import SourceField
from bruneton_sky.solver_job import solve_air
from numpy.typing import NDArray

from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.bench.bench_path import (
    PICTURE_NORM,
    BenchPath,
    Errors,
    Group,
    Work,
    relative_errors,
)
from vrut_lite_lab.bench.gl import GlTexture, GlTextures, gl_clock, has_timer, missing_gl, renderer
from vrut_lite_lab.bench.skies import (
    PICTURE,
    SETTINGS,
    Condition,
    air,
    conditions,
    in_view,
    random_directions,
)
from vrut_lite_lab.bench.sky_truth import (
    exact_skies,
    finely_traced,
    in_colour,
    in_words,
    light_again,
    light_once,
    sky_rgb,
)

# How many times as many rows, columns, steps and bins as usual.
FINER, QUICK_FINER = (0.2, 0.35, 0.5, 0.7, 1.0, 1.6), (0.5, 1.0)
LIGHT = "for light alone"
SIZES, QUICK_SIZES = (32, 64, 128, 256, 512, 1024), (32, 256)
GPU_SIZES, QUICK_GPU_SIZES, CARD_SIZES = (64, 256), (64,), (64, 256, 512, 1024, 2048)
_BLACK = np.zeros(3)
# Whose sky is looked up in cube maps, and in how many directions.
_AIR, _LOOK_UPS = "clear air", 5000
_SAME_SOLUTION = "direct evaluation of the same solution, 48 nodes for light scattered once"


def groups(quick: bool) -> list[Group]:
    """Tables, cube maps, and the chain from the atmosphere to the picture."""
    names = list(SETTINGS)[:1] if quick else list(SETTINGS)
    return [*(_tables(name, quick) for name in names), _cubes(quick), _chains(names, quick)]


@lru_cache(maxsize=1)
def solved(name: str) -> SourceField:
    """An air's solution with the product's sizes."""
    return solve_air(air(name))


def _tables(name: str, quick: bool) -> Group:
    finer = QUICK_FINER if quick else FINER
    return Group(
        name=f"sky-view-{name.replace(' ', '-')}",
        title=f"Sky-view table, {name}",
        unit="a table",
        norm=PICTURE_NORM,
        truth=_SAME_SOLUTION,
        paths=(
            *(_table_path(name, quick, f"{times:g} times as fine", times) for times in finer),
            _table_path(name, quick, LIGHT, None),
        ),
    )


def _table_path(name: str, quick: bool, said: str, finer: float | None) -> BenchPath:
    return BenchPath(
        name=said,
        family=LIGHT if finer is None else "table for pictures",
        parameters={} if finer is None else {"finer": finer},
        prepare=partial(_prepare_tables, name, quick, finer),
        error=partial(_table_errors, name, quick),
        units=len(_table_conditions(quick, finer)),
    )


def _table_conditions(quick: bool, finer: float | None) -> list[Condition]:
    """The table for light is made for an observer on the ground."""
    return [c for c in conditions(quick) if finer is not None or c.height_m == 0.0]


def _prepare_tables(name: str, quick: bool, finer: float | None) -> Work:
    field, asked = solved(name), _table_conditions(quick, finer)
    if finer is None:
        return lambda: {each: light_view(field, each.sun) for each in asked}
    return lambda: {each: sky_view(field, each.height_m, each.sun, finer) for each in asked}


def _table_errors(name: str, quick: bool, tables: dict[Condition, SkyView]) -> dict[str, Errors]:
    return {
        condition.name: relative_errors(_picture(name, condition, view), right)
        for condition, view in tables.items()
        for right in [_same_solution(name, condition)]
    }


def _picture(name: str, condition: Condition, view: SkyView) -> FloatArray:
    """The picture's sky (n, 3) straight from a table."""
    above = in_view(condition.height_m, air(name).ground_radius_m)
    return fill_cube(view, PICTURE, _BLACK)[above].astype(float)


@lru_cache
def _same_solution(name: str, condition: Condition) -> FloatArray:
    return sky_rgb(finely_traced(solved(name)), name, condition)


def _cubes(quick: bool) -> Group:
    paths = [_cube_path(size, quick) for size in (QUICK_SIZES if quick else SIZES)]
    left_out = {}
    if missing_gl():
        left_out["cube maps of a sky-view table on the GPU"] = missing_gl()
    else:
        usual = CARD_SIZES if has_timer(renderer()) else GPU_SIZES
        sizes = QUICK_GPU_SIZES if quick else usual
        paths += [_gpu_cube_path(size, quick) for size in sizes]
        heights = {condition.height_m for condition in conditions(quick)}
        paths += [
            _gpu_table_path(size, quick, height) for height in sorted(heights) for size in sizes
        ]
    return Group(
        name="sky-cube",
        title=f"Sky looked up in a cube map of a sky-view table, {_AIR}",
        unit="a map",
        norm=f"{PICTURE_NORM} (of {_LOOK_UPS} directions, linear look-up between texels)",
        truth=_SAME_SOLUTION,
        paths=tuple(paths),
        left_out=left_out,
    )


def _seen_from(height_m: float, quick: bool) -> list[Condition]:
    return [condition for condition in conditions(quick) if condition.height_m == height_m]


def _views(quick: bool) -> list[SkyView]:
    field = solved(_AIR)
    return [sky_view(field, each.height_m, each.sun) for each in _seen_from(0.0, quick)]


def _cube_path(size: int, quick: bool) -> BenchPath:
    return BenchPath(
        name=f"fill_cube, float32, {size}²",
        family="fill_cube, float32",
        parameters={"size": size},
        prepare=partial(_prepare_cubes, size, quick),
        error=partial(_cube_errors, _seen_from(0.0, quick)),
        units=len(_seen_from(0.0, quick)),
    )


def _prepare_cubes(size: int, quick: bool) -> Work:
    views = _views(quick)
    return lambda: [fill_cube(view, size, _BLACK) for view in views]


def _cube_errors(seen: list[Condition], cubes: list[NDArray[np.float32]]) -> dict[str, Errors]:
    return {
        condition.name: relative_errors(sample_sky(cube, random_directions(_LOOK_UPS)), right)
        for condition, cube in zip(seen, cubes, strict=True)
        for right in [_exact_looked_up(condition)]
    }


@lru_cache
def _exact_looked_up(condition: Condition) -> FloatArray:
    field, towards = finely_traced(solved(_AIR)), random_directions(_LOOK_UPS)
    order = np.argsort(towards[:, 1], kind="stable")
    light = light_once(field, condition, towards[order])
    light = light + light_again(field, condition, towards[order])
    right = np.empty((len(towards), 3))
    right[order] = in_colour(field.atmosphere, light)
    return right


def _gpu_cube_path(size: int, quick: bool) -> BenchPath:
    return BenchPath(
        name=f"GPU shader, float16, {size}²",
        family="GPU shader, float16",
        parameters={"size": size},
        prepare=partial(_prepare_gpu_cubes, size, quick),
        error=partial(_gpu_cube_errors, _seen_from(0.0, quick)),
        units=len(_seen_from(0.0, quick)),
        batch="GPU",
        clock=gl_clock(),
        device="GPU",
    )


def _prepare_gpu_cubes(size: int, quick: bool) -> Work:
    jobs = [sky_view_job(view, size, _BLACK, "bench", "cube") for view in _views(quick)]
    return GlTextures([GlTexture(job, scale) for job, scale in jobs])


def _gpu_table_path(size: int, quick: bool, height_m: float) -> BenchPath:
    family, seen = "GPU shaders, table and cube, float32", _seen_from(height_m, quick)
    if height_m > 0.0:
        family += f", {height_m:g} m up"
    return replace(
        _gpu_cube_path(size, quick),
        name=f"{family}, {size}²",
        family=family,
        prepare=partial(_prepare_gpu_tables, size, seen),
        error=partial(_gpu_cube_errors, seen),
        units=len(seen),
    )


def _prepare_gpu_tables(size: int, seen: list[Condition]) -> Work:
    field = solved(_AIR)
    tables = [table_on_card(field, each.height_m, each.sun) for each in seen]
    jobs = [table_cube_job(table, size, _BLACK, 1.0, "bench", "cube") for table in tables]
    return GlTextures([GlTexture(job) for job in jobs])


def _gpu_cube_errors(seen: list[Condition], done: GlTextures) -> dict[str, Errors]:
    return _cube_errors(seen, [cube.read().astype(np.float32) for cube in done.textures])


def _chains(names: list[str], quick: bool) -> Group:
    return Group(
        name="sky-chain",
        title="From a changed atmosphere, or a moved sun, to the picture",
        unit="a picture, its cube map of 256 texels an edge included",
        norm=PICTURE_NORM,
        truth=in_words(quick),
        paths=tuple(
            _chain_path(name, quick, changed) for name in names for changed in (True, False)
        ),
        front_of=names[-1],
    )


def _chain_path(name: str, quick: bool, changed: bool) -> BenchPath:
    what = "changed atmosphere" if changed else "moved sun"
    return BenchPath(
        name=f"{what}, {name}",
        family=what,
        prepare=partial(_prepare_chain, name, quick, changed),
        error=partial(_chain_errors, name, quick, changed),
        units=len(_chain_conditions(quick, changed)),
        batch=name,
    )


def _chain_conditions(quick: bool, changed: bool) -> list[Condition]:
    """One sun is enough to time a changed atmosphere: solving does not depend on the sun."""
    return conditions(quick)[: 1 if changed else None]


def _prepare_chain(name: str, quick: bool, changed: bool) -> Work:
    field, asked = solved(name), _chain_conditions(quick, changed)
    if changed:
        return lambda: {each: _seen(solve_air(air(name)), each) for each in asked}
    return lambda: {each: _seen(field, each) for each in asked}


def _seen(field: SourceField, condition: Condition) -> SkyView:
    """The table; the cube map is made from it too."""
    view = sky_view(field, condition.height_m, condition.sun)
    fill_cube(view, 256, _BLACK)
    return view


def _chain_errors(
    name: str, quick: bool, changed: bool, views: dict[Condition, SkyView]
) -> dict[str, Errors]:
    """Under all conditions, also if only one was timed: the solution is the same."""
    exact = exact_skies(name, quick)
    if changed:
        views = _prepare_chain(name, quick, False)()
    return {
        condition.name: relative_errors(_picture(name, condition, view), exact[condition.name])
        for condition, view in views.items()
    }

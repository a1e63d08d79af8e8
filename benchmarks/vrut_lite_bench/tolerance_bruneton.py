"""How far the Bruneton sky's pictures are off, by rung and size: against its converged twin."""

import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.sky_view import SkyView, fill_cube, sky_view
from bruneton_sky.solver import SourceField
from bruneton_sky.solver_job import solve_air
from bruneton_sky.solver_rungs import SOLVER_RUNGS, counted_work, rung_sizes
from bruneton_sky.tolerance import TABLES, Quality
from bruneton_sky.unseen_moves import sun_step_rad
from numpy.typing import NDArray

from vrut_lite.daylight.tolerance import Point
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.numeric_types import FloatArray
from vrut_lite_bench.tolerance_bruneton_truth import (
    EDGE,
    Air,
    View,
    evaluated,
    sky_texels,
    true_skies,
)

CUBE_SIZES = (64, 96, 128, 192, 256, 384, 512)
# Of the cube map that others are held against; so many of its texels are looked up.
_TRUE_SIZE, _LOOK_UPS = 1024, 4096
# Rays of a usual table times their steps: what a finer one is counted in.
_USUAL_ROWS, _USUAL_STEPS = 80, 48
_FLOOR, _MOST = 1e-3, 0.99
_BLACK = np.zeros(3)


def fronts(airs: Sequence[Air], kept: Path | None) -> dict[str, list[Point[int | str]]]:
    """Error, counted work and CPU time of each choice, in 99 of 100 of the airs' pictures."""
    found = [_errors_in(air, true_skies(air, kept)) for air in airs]
    most = {
        name: np.quantile(np.concatenate([errors[name] for errors in found]), _MOST, axis=0)
        for name in ("solver", "table", "cube_size")
    }
    return {
        "solver": list(_solver_points(most["solver"])),
        "table": list(_table_points(most["table"])),
        "cube_size": list(_cube_points(most["cube_size"])),
    }


def _errors_in(air: Air, truth: Sequence[FloatArray]) -> dict[str, FloatArray]:
    """Errors (views, choices) of each knob alone."""
    atmosphere = atmosphere_of(air.settings)
    fields = {rung: solve_air(atmosphere, rung=rung) for rung in SOLVER_RUNGS}
    solved = [
        [error(evaluated(fields[rung], air, view), sky) for rung in SOLVER_RUNGS]
        for view, sky in zip(air.views, truth, strict=True)
    ]
    usual = fields["usual"]
    return {
        "solver": np.array(solved),
        "table": np.array([_table_errors(usual, air, view) for view in air.views]),
        "cube_size": np.array([_cube_errors(usual, view) for view in air.views[::3]]),
    }


def _table_errors(field: SourceField, air: Air, view: View) -> list[float]:
    exact, texels = evaluated(field, air, view), sky_texels(air, view)
    tables = (sky_view(field, view.height_m, view.sun, finer) for finer in TABLES.values())
    return [error(fill_cube(table, EDGE, _BLACK)[texels], exact) for table in tables]


def _cube_errors(field: SourceField, view: View) -> list[float]:
    """Of look-ups between texels, above the level."""
    table = sky_view(field, view.height_m, view.sun)
    directions = texel_directions(_TRUE_SIZE)
    chosen = np.random.default_rng(0).choice(
        np.flatnonzero(directions[..., 1].ravel() > 0.0), _LOOK_UPS, replace=False
    )
    exact = fill_cube(table, _TRUE_SIZE, _BLACK).reshape(-1, 3)[chosen]
    looked = directions.reshape(-1, 3)[chosen]
    return [error(sample_sky(fill_cube(table, size, _BLACK), looked), exact) for size in CUBE_SIZES]


def picture_errors(airs: Sequence[Air], quality: Quality, kept: Path | None) -> list[float]:
    """Of each view, all knobs together, with the sun strayed as far as it may."""
    return [
        error(shown(solved, air, view, quality), sky)
        for air in airs
        for solved in [solve_air(atmosphere_of(air.settings), rung=quality.solver)]
        for view, sky in zip(air.views, true_skies(air, kept), strict=True)
    ]


def shown(field: SourceField, air: Air, view: View, quality: Quality) -> NDArray[np.floating]:
    """The sky (n, 3) as it is shown: looked up in the cube map, but from aloft in the table."""
    g = field.atmosphere.mie_g
    strayed = view._replace(
        elevation_rad=view.elevation_rad + sun_step_rad(view.elevation_rad, g, quality.sun_change)
    )
    table: SkyView = sky_view(field, view.height_m, strayed.sun, TABLES[quality.table])
    texels = sky_texels(air, view)
    if view.height_m > 0.0:
        return fill_cube(table, EDGE, _BLACK)[texels]
    directions = texel_directions(EDGE)[texels]
    return sample_sky(fill_cube(table, quality.cube_size, _BLACK), directions)


def error(seen: NDArray[np.floating], exact: FloatArray) -> float:
    """What 99 % of directions stay below, over the value or a thousandth of the brightest."""
    relative = np.abs(seen - exact) / np.maximum(exact, _FLOOR * exact.max())
    return float(np.quantile(relative, _MOST))


def _solver_points(errors: FloatArray) -> Iterator[Point[int | str]]:
    atmosphere = atmosphere_of(BrunetonSkySettings())
    for rung, most in zip(SOLVER_RUNGS, errors, strict=True):
        work = counted_work(rung_sizes(atmosphere, rung))
        yield Point(rung, float(most), work, _least_ms(partial(solve_air, atmosphere, rung=rung)))


def _table_points(errors: FloatArray) -> Iterator[Point[int | str]]:
    field = _usual_field()
    for (name, finer), most in zip(TABLES.items(), errors, strict=True):
        work = round(_USUAL_ROWS * finer) * round(_USUAL_STEPS * finer)
        make = partial(sky_view, field, 0.0, View(0.0, 0.8, 0.3).sun, finer)
        yield Point(name, float(most), float(work), _least_ms(make))


def _cube_points(errors: FloatArray) -> Iterator[Point[int | str]]:
    table = sky_view(_usual_field(), 0.0, View(0.0, 0.8, 0.3).sun)
    for size, most in zip(CUBE_SIZES, errors, strict=True):
        fill = partial(fill_cube, table, size, _BLACK)
        yield Point(size, float(most), 6.0 * size * size, _least_ms(fill))


def _usual_field() -> SourceField:
    atmosphere: Atmosphere = atmosphere_of(BrunetonSkySettings())
    return solve_air(atmosphere)


def _least_ms(work: Callable[[], object], rounds: int = 3) -> float:
    """CPU time, after one call that may compile."""
    work()
    spent = []
    for _ in range(rounds):
        start = time.process_time()
        work()
        spent.append(time.process_time() - start)
    return round(1e3 * min(spent), 3)

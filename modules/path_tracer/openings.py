"""Learns where light comes from, of scenes lit through openings: a `DirectionTable`.

A survey follows rays from the eye, scattered by the cosine. Where few of them end in the sky, but
some do, the scene is lit through openings, and its paths are worth guiding. Then a few paths are
traced, guided by what earlier ones found; each vertex adds the light that its next ray brings to
its row. That changes noise alone, for paths are weighed by the density that they were drawn with.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from path_tracer.direction_table import (
    AZIMUTHS,
    BINS,
    HEIGHTS,
    DirectionTable,
    Grid,
    direction_bin,
    grid_row,
)
from path_tracer.guided_path import GuidedScattering

# Share of scattered rays that end in the sky, below which a scene is lit through openings: a room
# with windows 0.02 to 0.05, a street 0.4, open land 0.6.
_OPEN = 0.15
_SURVEY_RAYS, _SURVEY_BOUNCES = 2**14, 4
# Share of surveyed places that lie beyond the grid on either side of each axis.
_FAR = 0.01
_CUBES = 500
# Passes, and surfaces of a path. A pass has at most so many paths, fewer if the picture has; one of
# fewer than `WORTH_PATHS` paths would not repay them.
_PASSES, _SURFACES = 4, 5
_MOST_PATHS, _SHARE_OF_PATHS, WORTH_PATHS = 2**17, 1.0 / 64.0, 2**20
# Samples of a part of the sphere from which its quarters' own light counts for more than evenness.
_PRIOR_SAMPLES = 4.0
# Vertices of a row from which it guides.
_FEWEST = 32
# Part of directions that are drawn from the table.
_SHARE = 0.5
_SEED = 20_261
# Light that one vertex adds at most, in means of a pass: one bright path would draw many others.
_BRIGHTEST = 50.0


class Survey(NamedTuple):
    """Share of scattered rays that end in the sky; the grid around what they met, and its rows."""

    open_share: float
    grid: Grid
    rows: NDArray[np.int_]

    @property
    def has_openings(self) -> bool:
        """Whether the scene is lit through openings."""
        return 0.0 < self.open_share < _OPEN


def survey(mi: Any, scene: Any) -> Survey:
    """Where rays from the eye, scattered by the cosine, end."""
    import drjit

    dr: Any = drjit
    sampler = _sampler(mi, _SURVEY_RAYS, _SEED)
    ray = _eye_rays(mi, scene, sampler)
    going, in_sky, scattered = dr.full(mi.Bool, True, _SURVEY_RAYS), 0, 0
    places, normals = [], []
    for bounce in range(_SURVEY_BOUNCES + 1):
        si = scene.ray_intersect(ray, mi.RayFlags.Minimal, False, going)
        going &= si.is_valid() | (bounce > 0)
        ends = going & ~si.is_valid()
        passes = ~ends & mi.has_flag(si.bsdf().flags(), mi.BSDFFlags.Transmission)
        facing = dr.select(dr.dot(si.n, ray.d) > 0.0, -si.n, si.n)
        cosine = mi.warp.square_to_cosine_hemisphere(sampler.next_2d())
        onwards = mi.Frame3f(facing).to_world(cosine)
        ray = si.spawn_ray(dr.select(passes, ray.d, onwards))
        counted = going & ~passes
        going &= si.is_valid()
        sampler.schedule_state()
        dr.eval(ray, going, si.p, facing, ends, counted)
        if bounce:
            in_sky += int(np.count_nonzero(ends))
            scattered += int(np.count_nonzero(counted))
        met = np.array(counted & going)
        places.append(np.array(si.p).T[met])
        normals.append(np.array(facing).T[met])
    place, normal = np.concatenate(places), np.concatenate(normals)
    if not len(place):
        return Survey(1.0, Grid((0.0, 0.0, 0.0), 1.0, (1, 1, 1)), np.zeros(0, int))
    grid = _grid(*np.quantile(place, (_FAR, 1.0 - _FAR), axis=0))
    row, inside = grid_row(mi, grid, mi.Point3f(*place.T), mi.Normal3f(*normal.T))
    return Survey(in_sky / max(scattered, 1), grid, np.unique(np.array(row)[np.array(inside)]))


def learn(mi: Any, scene: Any, found: Survey, passes: bool, picture_paths: int) -> DirectionTable:
    """A table of the light in a scene for a picture of so many paths.

    `passes`: as for `guided_path`.
    """
    import drjit

    dr: Any = drjit
    paths = min(_MOST_PATHS, int(picture_paths * _SHARE_OF_PATHS))
    grid, rows = found.grid, found.rows
    numbers = np.full(grid.rows, -1)
    numbers[rows] = np.arange(len(rows))
    light, squares = np.zeros((2, len(rows), BINS))
    vertices = np.zeros(len(rows), int)
    # Without light at first: all passes run the same kernel.
    table = DirectionTable(mi, grid, rows, light, _SHARE)
    for number in range(_PASSES):
        sampler = _sampler(mi, paths, _SEED + 1 + number)
        scattering = GuidedScattering(mi, scene, table, passes)
        ray = _eye_rays(mi, scene, sampler)
        place, pdf = dr.zeros(mi.Interaction3f, paths), dr.full(mi.Float, 1.0, paths)
        is_delta, going = dr.full(mi.Bool, True, paths), dr.full(mi.Bool, True, paths)
        # One kernel for all surfaces: its initial values must not become constants of its code.
        sampler.schedule_state()
        dr.make_opaque(ray, place, pdf, is_delta, going)
        path = []
        for _ in range(_SURFACES + 1):
            v = scattering.step(sampler, ray, place, pdf, is_delta, mi.Bool(True), going)
            row, inside = grid_row(mi, grid, v.interaction.p, v.facing)
            going = going & v.interaction.is_valid() & (dr.max(v.weight) > 0.0)
            counts = going & inside & ~v.is_delta & ~v.is_null
            cosine = dr.abs(dr.dot(v.ray.d, v.facing))
            now = (
                mi.luminance(v.emitted), v.emitted_weight, mi.luminance(v.direct),
                mi.luminance(v.weight), counts, row, direction_bin(mi, v.ray.d),
                dr.select(counts, cosine / v.pdf, 0.0),
            )  # fmt: skip
            ray, place, pdf, is_delta = v.ray, v.place, v.pdf, v.is_delta
            sampler.schedule_state()
            dr.make_opaque(now, ray, place, pdf, is_delta, going)
            path.append(_Step(*(np.array(values) for values in now)))
        _add(light, squares, vertices, numbers, path)
        kept = np.where((vertices >= _FEWEST)[:, None], _smoothed(light, squares), 0.0)
        table = DirectionTable(mi, grid, rows, kept, _SHARE)
    return table


class _Step(NamedTuple):
    """One surface of many paths (n,): luminances, and where the next ray leads."""

    emitted: NDArray[np.float32]
    emitted_weight: NDArray[np.float32]
    direct: NDArray[np.float32]
    weight: NDArray[np.float32]
    counts: NDArray[np.bool_]
    row: NDArray[np.uint32]
    bin: NDArray[np.uint32]
    per_density: NDArray[np.float32]


def _add(
    light: NDArray[np.float64],
    squares: NDArray[np.float64],
    vertices: NDArray[np.int_],
    numbers: NDArray[np.int_],
    path: list[_Step],
) -> None:
    """Add to bins the light that the rays of paths bring, from their ends backwards."""
    reflected = path[-1].direct.astype(float)
    for here, after in zip(path[-2::-1], path[:0:-1], strict=True):
        brought = after.emitted + reflected
        reflected = here.direct + here.weight * (after.emitted * after.emitted_weight + reflected)
        number = numbers[here.row * here.counts]
        at = np.flatnonzero(here.counts & (number >= 0))
        share = (brought * here.per_density)[at]
        if len(at):
            share = np.minimum(share, _BRIGHTEST * share.mean())
        index = number[at] * BINS + here.bin[at]
        light += np.bincount(index, share, light.size).reshape(light.shape)
        squares += np.bincount(index, share**2, light.size).reshape(light.shape)
        vertices += np.bincount(number[at], minlength=len(vertices))


def _smoothed(light: NDArray[np.float64], squares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Light (n, BINS), where what few samples brought spreads over larger solid angles.

    From the whole sphere down each part is divided among its quarters by their light, and evenly as
    far as the part has few samples, by the effective number (sum squared over sum of squares).
    """
    levels = [(light.reshape(-1, HEIGHTS, AZIMUTHS), squares.reshape(-1, HEIGHTS, AZIMUTHS))]
    while levels[-1][0].shape[1] > 1:
        levels.append((_quarters(levels[-1][0]), _quarters(levels[-1][1])))
    result = levels[-1][0]
    for (total, square), (parts, _) in zip(levels[:0:-1], levels[-2::-1], strict=True):
        samples = total**2 / np.maximum(square, 1e-300)
        trust = samples / (samples + _PRIOR_SAMPLES)
        per_light = np.where(total > 0.0, result * trust / np.maximum(total, 1e-300), 0.0)
        even = result * np.where(total > 0.0, 1.0 - trust, 1.0) / 4.0
        result = parts * _spread(per_light) + _spread(even)
    return result.reshape(light.shape)


def _quarters(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sums (n, h / 2, w / 2) of two by two."""
    n, h, w = values.shape
    return np.asarray(values.reshape(n, h // 2, 2, w // 2, 2).sum(axis=(2, 4)))


def _spread(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(values.repeat(2, axis=1).repeat(2, axis=2))


def _grid(lower: NDArray[np.float64], upper: NDArray[np.float64]) -> Grid:
    """Cubes that fill a box, which they reach beyond by half an edge."""
    size = np.maximum(upper - lower, 1e-3 * max(float((upper - lower).max()), 1e-3))
    edge = float(np.cbrt(np.prod(size) / _CUBES))
    counts = np.ceil(size / edge).astype(int) + 1
    return Grid(tuple((lower - 0.5 * edge).tolist()), edge, tuple(counts.tolist()))


def _eye_rays(mi: Any, scene: Any, sampler: Any) -> Any:
    ray, _ = scene.sensors()[0].sample_ray(0.0, 0.5, sampler.next_2d(), mi.Point2f(0.5))
    return mi.Ray3f(ray)


def _sampler(mi: Any, count: int, seed: int) -> Any:
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, count)
    return sampler

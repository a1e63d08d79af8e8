"""Sunlight that clouds scatter again and again, by diffusion on the grid of the light volume.

The P1 approximation of transport after delta-M (Ishimaru 1978, "Wave propagation and scattering in
random media", chapter 9), without absorption. With F the flux and G the fluence of scattered light,
s the diffusing extinction, E the remaining sunlight and d its direction,

    div F = s E,    grad G = 3 g s E d - 3 (1 - g) s F.

Cells exchange flux as resistors do, along lines between their middles. At base and top no diffuse
light enters: G = 2 F (Marshak), and the surface of a cloud has the same resistance. Between clouds
light goes straight, which is no diffusion: level paths there get an extinction that was fitted to
the Monte Carlo. A plane layer has neither. Importing this module imports numba.
"""

import math

import numpy as np
from numpy.typing import NDArray

from clouds.model.cloud_density_kernels import compiled
from clouds.model.cloud_grid import place_of
from vrut_lite.numeric_types import FloatArray

# Mean cosine of droplets' phase function after delta-M.
MEAN_COSINE = 0.74
# Resistance of a cloud's surface; free paths in a layer's thickness, on level paths between clouds.
_SURFACE, _FREE_PATHS = 2.0, 3.0
# Optical depth from which a cell counts as solid cloud, and the weight of clear air.
_SOLID, _CLEAR = 4.0, 1e-3
_LEAST_RESISTANCE = 1e-3
# Largest optical depth, within the range of exp.
_DEEP = 60.0
# Resistance of a cloud's visible rim, an optical depth of 1.
_SEEN = 3.0 * (1.0 - MEAN_COSINE)
# Multigrid: cycles, sweeps, and over-relaxation by columns.
_CYCLES, _SWEEPS, _AHEAD = 3, 2, 1.5
# 3/2 (1 - g) and 3/2 g: halves, of half a cell on each side of a face.
_HINDERS, _DRIVES = 1.5 * (1.0 - MEAN_COSINE), 1.5 * MEAN_COSINE


def diffuse_light(
    density: NDArray[np.float32],
    depths: NDArray[np.float32],
    scattered: NDArray[np.float32],
    sun: FloatArray,
    step_m: float,
    near_m: float,
    diffusing_per_m: float,
    diffused: float,
) -> NDArray[np.float32]:
    """Fluence, and flux along world x, up and z (heights + 1, columns z, columns x, 4).

    Of a sun of irradiance 1. `density` (heights, columns, columns) and `depths` are the light
    volume's, `scattered` the share of sunlight of the level that its cells scatter, `diffused` the
    share of extinction that diffuses.
    """
    heights, columns, _ = density.shape
    shape = (columns, columns, heights)
    edges_m = np.array([place_of(u, near_m) for u in np.linspace(-1.0, 1.0, columns + 1)])
    extinction, clear, sunlit, aside = np.empty((4, *shape), np.float32)
    drives = np.empty((*shape, 2), np.float32)
    lit = extinction, clear, sunlit, aside
    _light(density, depths, scattered, sun[1], step_m, diffusing_per_m, diffused, lit, drives)
    links = np.zeros((columns, columns, heights + 1, 3), np.float32)
    source, fluence = np.zeros((2, *shape), np.float32)
    free_per_m = _FREE_PATHS / (heights * step_m)
    cells = (edges_m, step_m, free_per_m, sun[0], sun[2])
    _link(cells, lit, drives, links, source)
    _relax(links, source, fluence, 1, True)
    for _ in range(_CYCLES):
        _settle(links, source, fluence)
    at_edges = np.zeros((heights + 1, columns, columns, 4), np.float32)
    _at_edges(edges_m, step_m, extinction, drives, links, fluence, at_edges)
    out = at_edges.copy()
    _reach_out(extinction * np.float32(step_m), at_edges, out)
    return out


@compiled
def plane_light(above, below, there, facing):  # type: ignore[no-untyped-def]
    """Fluence and downward flux in a plane layer between scaled depths, by the same equations.

    `there`: share of the sun that is scattered above; `facing`: cosine of the sun's angle to the
    layer's normal.
    """
    hinders = 3.0 * (1.0 - MEAN_COSINE)
    whole = above + below
    gone = -math.expm1(-whole / facing)
    at_top = facing * ((3.0 * facing - 2.0) * gone - hinders * whole) / (4.0 + hinders * whole)
    fluence = 3.0 * facing * facing * there - 2.0 * at_top - hinders * (at_top + facing) * above
    return fluence, at_top + facing * there


@compiled
def _mean_light(a, b):  # type: ignore[no-untyped-def]
    """Mean of exp(-t) for t from a to b."""
    return math.exp(-a) * (-math.expm1(a - b) / (b - a) if b - a > 1e-5 else 1.0)


@compiled
def _moment(a, b):  # type: ignore[no-untyped-def]
    """Mean of r exp(-t) over r from 0 to 1, while t goes evenly from a to b."""
    q = b - a
    if abs(q) < 1e-2:
        return math.exp(-a) * (0.5 - q / 3.0 + q * q / 8.0)
    return (math.exp(-a) - math.exp(-b) * (1.0 + q)) / (q * q)


@compiled
def _light(density, depths, scattered, sine, step_m, per_m, diffused, lit, drives):  # type: ignore[no-untyped-def]
    """Extinction, sunlight scattered per length, and the source of upward flux.

    The source is given from the lower face to the middle of a cell, and from there to the upper
    face. The share `aside` of the light enters through sides: its excess over the depths in the
    column's middle.
    """
    extinction, clear, sunlit, aside = lit
    heights, columns = density.shape[0], density.shape[1]
    for j in range(columns):
        for i in range(columns):
            for k in range(heights):
                half = 0.5 * step_m * per_m * density[k, j, i]
                high = diffused * depths[k + 1, j, i, 0]
                low = max(diffused * depths[k, j, i, 0], high)
                middle = 0.5 * (high + low)
                upper, lower = half * _mean_light(high, middle), half * _mean_light(middle, low)
                whole = sine * scattered[k, j, i]
                extinction[j, i, k] = per_m * density[k, j, i]
                clear[j, i, k] = math.exp(-2.0 * half)
                sunlit[j, i, k] = whole / step_m
                down = min(whole / max(upper + lower, 1e-30), 1.0)
                even = whole - down * (upper + lower)
                aside[j, i, k] = even / max(whole, 1e-30)
                # Scattering within the cell changes the flux: exact in plane layers.
                within, ahead = 2.0 * _HINDERS * half, 2.0 * _DRIVES * sine
                lower, upper = down * lower + 0.5 * even, down * upper + 0.5 * even
                at_low = down * half * _moment(middle, low) + 0.25 * even
                at_high = down * half * _moment(middle, high) + 0.25 * even
                drives[j, i, k, 0] = -ahead * lower - within * at_low
                drives[j, i, k, 1] = -ahead * upper + within * at_high


@compiled
def _halves(sunlit, sideways, depth):  # type: ignore[no-untyped-def]
    """Light scattered by the halves of a cell, the sunward one first, each with its moment.

    `sideways`: the share that enters through this side, `depth`: optical depth through half a cell.
    Moments count from the middle, 1 at the face, and belong to the half's depth.
    """
    even = 0.5 * (1.0 - sideways)
    if depth * sideways < 1e-4:
        return 0.5 * sunlit, 0.25 * sunlit, 0.5 * sunlit, 0.25 * sunlit
    near = sideways / (1.0 + math.exp(-depth))
    off = 1.0 / depth - 1.0 / math.expm1(min(depth, _DEEP))
    return (
        sunlit * (even + near), sunlit * (0.5 * even + near * (1.0 - off)),
        sunlit * (even + sideways - near), sunlit * (0.5 * even + (sideways - near) * off),
    )  # fmt: skip


@compiled
def _side(lit, j, i, k, share, width_m):  # type: ignore[no-untyped-def]
    """A cell as `_across` takes it; `share`: of light that comes in aside, through this side."""
    extinction, clear, sunlit, aside = lit
    return extinction[j, i, k], clear[j, i, k], sunlit[j, i, k], share * aside[j, i, k], width_m


@compiled
def _across(cell, beside, free_per_m, slope):  # type: ignore[no-untyped-def]
    """Resistance and drive from one column to the next; `slope`: the sun's direction that way.

    Cells: extinction, clear share of their height, light, its share that enters through this side,
    width.
    """
    a, clear_a, light_a, side_a, width_a = cell
    b, clear_b, light_b, side_b, width_b = beside
    resists = _HINDERS * (a * width_a + b * width_b) + 1.5 * free_per_m * (width_a + width_b)
    resists += _SURFACE * abs(clear_a - clear_b)
    steep = max(abs(slope), 1e-3)
    near_a, at_near_a, far_a, at_far_a = _halves(
        light_a * width_a, side_a, 0.5 * a * width_a / steep
    )
    near_b, at_near_b, far_b, at_far_b = _halves(
        light_b * width_b, side_b, 0.5 * b * width_b / steep
    )
    # The sun comes from the next one's side where the slope is positive.
    half_a, at_a = (near_a, at_near_a) if slope > 0.0 else (far_a, at_far_a)
    half_b, at_b = (far_b, at_far_b) if slope > 0.0 else (near_b, at_near_b)
    drive = -2.0 * _DRIVES * slope * (half_a + half_b)
    return resists, drive + _HINDERS * (a * width_a * at_a - b * width_b * at_b)


@compiled
def _upward(extinction, clear, k, step_m):  # type: ignore[no-untyped-def]
    """Resistance through the lower face of the cell k of a column."""
    heights = extinction.size
    half = step_m * _HINDERS * extinction[min(k, heights - 1)]
    if k in (0, heights):
        return half + 2.0
    below = step_m * _HINDERS * extinction[k - 1]
    return max(half + below + _SURFACE * abs(clear[k] - clear[k - 1]), _LEAST_RESISTANCE)


@compiled
def _link(cells, lit, drives, links, source):  # type: ignore[no-untyped-def]
    """Conductances to the next column along x, along z, and from below; light that cells get."""
    edges_m, step_m, free_per_m, sun_x, sun_z = cells
    extinction, clear, sunlit, _ = lit
    along_x, along_z = abs(sun_x) + 1e-6, abs(sun_z) + 1e-6
    columns, heights = extinction.shape[0], extinction.shape[2]
    for j in range(columns):
        dz = edges_m[j + 1] - edges_m[j]
        for i in range(columns):
            dx = edges_m[i + 1] - edges_m[i]
            for k in range(heights):
                by_x = along_x / dx / (along_x / dx + along_z / dz)
                source[j, i, k] += sunlit[j, i, k] * dx * dz * step_m
                if i + 1 < columns:
                    next_m = edges_m[i + 2] - edges_m[i + 1]
                    next_by_x = along_x / next_m / (along_x / next_m + along_z / dz)
                    cell = _side(lit, j, i, k, by_x, dx)
                    beside = _side(lit, j, i + 1, k, next_by_x, next_m)
                    resists, drive = _across(cell, beside, free_per_m, sun_x)
                    links[j, i, k, 0] = dz * step_m / resists
                    source[j, i, k] -= drive * links[j, i, k, 0]
                    source[j, i + 1, k] += drive * links[j, i, k, 0]
                if j + 1 < columns:
                    next_m = edges_m[j + 2] - edges_m[j + 1]
                    next_by_z = along_z / next_m / (along_x / dx + along_z / next_m)
                    cell = _side(lit, j, i, k, 1.0 - by_x, dz)
                    beside = _side(lit, j + 1, i, k, next_by_z, next_m)
                    resists, drive = _across(cell, beside, free_per_m, sun_z)
                    links[j, i, k, 1] = dx * step_m / resists
                    source[j, i, k] -= drive * links[j, i, k, 1]
                    source[j + 1, i, k] += drive * links[j, i, k, 1]
            for k in range(heights + 1):
                link = dx * dz / _upward(extinction[j, i], clear[j, i], k, step_m)
                links[j, i, k, 2] = link
                if k > 0:
                    source[j, i, k - 1] -= drives[j, i, k - 1, 1] * link
                    if k < heights:
                        source[j, i, k - 1] -= drives[j, i, k, 0] * link
                if k < heights:
                    source[j, i, k] += drives[j, i, k, 0] * link
                    if k > 0:
                        source[j, i, k] += drives[j, i, k - 1, 1] * link


def _settle(
    links: NDArray[np.float32], source: NDArray[np.float32], fluence: NDArray[np.float32]
) -> None:
    """Bring fluence nearer to its balance: far differences on columns twice as wide, and so on.

    Multigrid (Brandt 1977) on level ways alone: columns are solved whole.
    """
    _relax(links, source, fluence, _SWEEPS, False)
    columns = len(source)
    if columns % 2 == 0:
        wide = columns // 2
        links_of_wide = np.zeros((wide, wide, *links.shape[2:]), np.float32)
        rest, change = np.zeros((2, wide, wide, source.shape[2]), np.float32)
        _widen(links, source, fluence, links_of_wide, rest)
        _settle(links_of_wide, rest, change)
        _add_wide(change, fluence)
        _relax(links, source, fluence, _SWEEPS, False)


@compiled
def _widen(links, source, fluence, links_of_wide, rest):  # type: ignore[no-untyped-def]
    """The conductances of columns twice as wide, and what they lack of balance."""
    columns, heights = source.shape[0], source.shape[2]
    for j in range(columns):
        for i in range(columns):
            b, a = j // 2, i // 2
            for k in range(heights):
                here = fluence[j, i, k]
                lacks = source[j, i, k] - here * (links[j, i, k, 2] + links[j, i, k + 1, 2])
                if k > 0:
                    lacks += links[j, i, k, 2] * fluence[j, i, k - 1]
                if k + 1 < heights:
                    lacks += links[j, i, k + 1, 2] * fluence[j, i, k + 1]
                if i + 1 < columns:
                    lacks += links[j, i, k, 0] * (fluence[j, i + 1, k] - here)
                if i > 0:
                    lacks += links[j, i - 1, k, 0] * (fluence[j, i - 1, k] - here)
                if j + 1 < columns:
                    lacks += links[j, i, k, 1] * (fluence[j + 1, i, k] - here)
                if j > 0:
                    lacks += links[j - 1, i, k, 1] * (fluence[j - 1, i, k] - here)
                rest[b, a, k] += lacks
                if i % 2:
                    links_of_wide[b, a, k, 0] += links[j, i, k, 0]
                if j % 2:
                    links_of_wide[b, a, k, 1] += links[j, i, k, 1]
            for k in range(heights + 1):
                links_of_wide[b, a, k, 2] += links[j, i, k, 2]


@compiled
def _add_wide(change, fluence):  # type: ignore[no-untyped-def]
    for j in range(fluence.shape[0]):
        for i in range(fluence.shape[1]):
            for k in range(fluence.shape[2]):
                fluence[j, i, k] += change[j // 2, i // 2, k]


@compiled
def _relax(links, source, fluence, sweeps, first):  # type: ignore[no-untyped-def]
    """Fluence in cells: columns are solved whole, every second one of a board at a time.

    At `first` a column is one of a plane layer.
    """
    columns, heights = source.shape[0], source.shape[2]
    share, part = np.empty(heights), np.empty(heights)
    for _ in range(sweeps):
        ahead = 1.0 if first else _AHEAD
        for colour in range(2):
            begun = not first or colour > 0
            for j in range(columns):
                for i in range((j + colour) % 2, columns, 2):
                    before, rest = 0.0, 0.0
                    for k in range(heights):
                        light, whole = source[j, i, k], links[j, i, k, 2] + links[j, i, k + 1, 2]
                        if begun and i + 1 < columns:
                            light += links[j, i, k, 0] * fluence[j, i + 1, k]
                            whole += links[j, i, k, 0]
                        if begun and i > 0:
                            light += links[j, i - 1, k, 0] * fluence[j, i - 1, k]
                            whole += links[j, i - 1, k, 0]
                        if begun and j + 1 < columns:
                            light += links[j, i, k, 1] * fluence[j + 1, i, k]
                            whole += links[j, i, k, 1]
                        if begun and j > 0:
                            light += links[j - 1, i, k, 1] * fluence[j - 1, i, k]
                            whole += links[j - 1, i, k, 1]
                        # Thomas's elimination.
                        below = links[j, i, k, 2] if k else 0.0
                        pivot = whole - below * before
                        before, rest = links[j, i, k + 1, 2] / pivot, (light + below * rest) / pivot
                        share[k], part[k] = before, rest
                    value = 0.0
                    for k in range(heights - 1, -1, -1):
                        value = part[k] + (share[k] * value if k + 1 < heights else 0.0)
                        fluence[j, i, k] += ahead * (value - fluence[j, i, k])


@compiled
def _at_edges(edges_m, step_m, extinction, drives, links, fluence, out):  # type: ignore[no-untyped-def]
    """Fluence and flux between heights, at base and at top."""
    columns, heights = extinction.shape[0], extinction.shape[2]
    for j in range(columns):
        dz = edges_m[j + 1] - edges_m[j]
        for i in range(columns):
            dx = edges_m[i + 1] - edges_m[i]
            for k in range(heights + 1):
                low, high = max(k - 1, 0), min(k, heights - 1)
                drive = (drives[j, i, low, 1] if k else 0.0) + (
                    drives[j, i, high, 0] if k < heights else 0.0
                )
                under = fluence[j, i, low] if k else 0.0
                over = fluence[j, i, high] if k < heights else 0.0
                flux = (under - over + drive) * links[j, i, k, 2] / (dx * dz)
                if k == 0:
                    value = -2.0 * flux
                elif k == heights:
                    value = 2.0 * flux
                else:
                    half = step_m * _HINDERS * extinction[j, i, low]
                    value = under + drives[j, i, low, 1] - half * flux
                out[k, j, i, 0] = max(value, 0.0)
                out[k, j, i, 2] = flux
                # The sun's own drive on level ways is in the plane layer's light.
                for level in range(low, high + 1):
                    here, mean = fluence[j, i, level], 0.5 / (high - low + 1)
                    if i + 1 < columns:
                        there = (here - fluence[j, i + 1, level]) * links[j, i, level, 0]
                        out[k, j, i, 1] += mean * there / (dz * step_m)
                    if i > 0:
                        there = (fluence[j, i - 1, level] - here) * links[j, i - 1, level, 0]
                        out[k, j, i, 1] += mean * there / (dz * step_m)
                    if j + 1 < columns:
                        there = (here - fluence[j + 1, i, level]) * links[j, i, level, 1]
                        out[k, j, i, 3] += mean * there / (dx * step_m)
                    if j > 0:
                        there = (fluence[j - 1, i, level] - here) * links[j - 1, i, level, 1]
                        out[k, j, i, 3] += mean * there / (dx * step_m)


@compiled
def _reach_out(depths, light, out):  # type: ignore[no-untyped-def]
    """Extend the light of clouds into the clear air beside them.

    The visible part of a cloud is its rim, which the grid does not resolve: there the light is that
    at an optical depth of 1 inside, not that of the air before it, interpolated by resistance from
    the air to the middle of the cloud's cell. `depths`: of cells, (columns, columns, heights).
    """
    columns, heights = depths.shape[0], depths.shape[2]
    total, cloudy = np.empty(4), np.zeros((columns, columns), np.bool_)
    for j in range(columns):
        for i in range(columns):
            cloudy[j, i] = depths[j, i].max() > 0.0
    for j in range(columns):
        for i in range(columns):
            if not cloudy[max(j - 1, 0) : j + 2, max(i - 1, 0) : i + 2].any():
                continue
            for k in range(heights + 1):
                here = 0.5 * (depths[j, i, max(k - 1, 0)] + depths[j, i, min(k, heights - 1)])
                if here > _SOLID:
                    continue
                weights, densest = _CLEAR, here + _CLEAR
                for c in range(4):
                    total[c] = _CLEAR * light[k, j, i, c]
                for b in range(max(j - 1, 0), min(j + 2, columns)):
                    for a in range(max(i - 1, 0), min(i + 2, columns)):
                        for n in range(max(k - 1, 0), min(k + 2, heights + 1)):
                            weight = 0.5 * (
                                depths[b, a, max(n - 1, 0)] + depths[b, a, min(n, heights - 1)]
                            )
                            if weight > 0.0:
                                weights += weight
                                densest = max(densest, weight)
                                rim = min((_SURFACE + _SEEN) / (_SURFACE + _HINDERS * weight), 1.0)
                                for c in range(4):
                                    inner, clear = light[n, b, a, c], light[k, j, i, c]
                                    total[c] += weight * (clear + rim * (inner - clear))
                # Not within a layer that is as dense beside it.
                share = math.exp(-here) * (1.0 - here / densest)
                for c in range(4):
                    out[k, j, i, c] += share * (total[c] / weights - light[k, j, i, c])

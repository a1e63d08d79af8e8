"""A year at sensors: one matrix over the sky's cells, solved suns for bounces, rays to the sun.

Light of the sky is a product (Tregenza and Waters 1983). Bounces of sunlit surfaces are solved for
the suns of every few days and interpolated from day to day at the same hour; the sun's own light is
a ray for each sensor and hour.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from light_transport.public import (
    GROUND_NODE,
    NODES,
    CancelCheck,
    SceneTransport,
    always,
    columns_and_rays,
)
from scipy.sparse import csr_matrix

from daylight_numbers.matrix.measured_panes import MeasuredPanes
from daylight_numbers.matrix.operator import Half
from daylight_numbers.matrix.pane_bounces import PaneBounces
from daylight_numbers.now import sun_shares
from daylight_numbers.sky_cells import CELLS, node_of_cell
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.year_light import HOURS, YearLight
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.numeric_types import Float32Array, FloatArray, IntArray

# Suns are solved each so many days; the sun's height at an hour then changes by 3 degrees at most.
DAYS_BETWEEN = 8
LUMENS_RGB = np.asarray(luminance(np.eye(3)) * LUMENS_PER_WATT)
_SENSORS_AT_ONCE, _HOURS_AT_ONCE = 64, 64


@dataclass(frozen=True, eq=False)
class Year:
    """Illuminance in lux of the hours (H) of a `YearLight` at sensors (P).

    `total` (P, H) float32 by all light; `sun` (P, H) by the sun straight; `halves` (2, P, H) are
    `total` by either half of the rays.
    """

    total: Float32Array
    sun: Float32Array
    halves: tuple[Float32Array, Float32Array]


@dataclass(frozen=True, eq=False)
class SolvedYear:
    """Radiosity of patches (M) in a year, all bounces included, for sensors anywhere.

    `sent_by_cells` (M, GROUND_NODE + 1): irradiance by unit radiance of the sky's cells, straight;
    `by_sky` (3, M, GROUND_NODE + 1): radiosity by these; `sunlit` (S, M): irradiance straight from
    solved suns of 1 W m^-2; `by_suns` (3, M, S): radiosity by these; `sun_direction` (S, 3); `near`
    (H, 2) and `share` (H, 2): which of these stand for an hour's sun.
    """

    sent_by_cells: FloatArray
    by_sky: Float32Array
    sunlit: Float32Array
    by_suns: Float32Array
    sun_direction: FloatArray
    near: IntArray
    share: FloatArray

    def some(self, chosen: IntArray) -> "SolvedYear":
        """The same for those hours (H,) that are chosen."""
        return replace(self, near=self.near[chosen], share=self.share[chosen])


@dataclass(frozen=True, eq=False)
class YearMatrices:
    """Matrices that depend on scene, place and sensors alone.

    `sky`: of each half (3, P, GROUND_NODE + 1) by radiances; `suns`: of each half (3, P, S) by
    irradiances of solved suns; `near` and `share`: see `SolvedYear`; `direct` (P, H): lux straight
    from the sun for each hour; `scattered` (P, H): of each half, lux of the sun by measured panes.
    """

    sky: tuple[Float32Array, Float32Array]
    suns: tuple[Float32Array, Float32Array]
    near: IntArray
    share: FloatArray
    direct: Float32Array
    scattered: tuple[Float32Array, Float32Array] | None = None


def annual(work: DaylightWork, light: YearLight, go_on: CancelCheck = always) -> Year:
    """A year at sensors.

    Raises:
        GivenUp: by `go_on`.
    """
    solved = solved_year(work.transport, light, go_on, work.operator.bounces)
    return year_of(year_matrices(work, light, solved, go_on), light)


def solved_year(
    transport: SceneTransport,
    light: YearLight,
    go_on: CancelCheck = always,
    bounces: PaneBounces | None = None,
) -> SolvedYear:
    """Solve bounces of the sky's cells and of some suns, with the light of measured panes.

    Raises:
        GivenUp: by `go_on`.
    """
    assert transport.patches is not None
    reflectance = transport.patches.reflectance_rgb.copy()
    reflectance[transport.patches.on_ground] = light.ground_albedo_rgb
    straight = sent_by_cells(transport)
    by_sky = radiosities(transport, list(straight.T), reflectance, go_on)
    near, share, chosen = _solved_suns(light)
    with ThreadPoolExecutor(transport.threads) as pool:
        sunlit = list(pool.map(lambda n: transport.sunlit_patches(light.sun_direction[n]), chosen))
    by_suns = radiosities(transport, sunlit, reflectance, go_on)
    lit = np.array(sunlit, np.float32).reshape(len(chosen), len(reflectance))
    towards = light.sun_direction[chosen]
    if bounces is not None:
        by_sky += _by_panes(bounces, on_nodes(), by_sky, None, None, reflectance, go_on)
        with ThreadPoolExecutor(transport.threads) as pool:
            beams = np.array(list(pool.map(bounces.straight_sun, towards)), np.float32)
        glow = bounces.panes.of_sun(towards)
        beams = beams.reshape(len(chosen), len(reflectance))
        lit += beams
        by_suns += _by_panes(bounces, None, by_suns, glow, beams.T, reflectance, go_on)
    return SolvedYear(straight, by_sky, lit, by_suns, towards, near, share)


def year_matrices(
    work: DaylightWork, light: YearLight, solved: SolvedYear, go_on: CancelCheck = always
) -> YearMatrices:
    """Matrices from solved light to sensors, and their direct sun by rays of each hour.

    Raises:
        GivenUp: by `go_on`.
    """
    halves = work.operator.halves
    panes = work.operator.panes
    sky = [sky_matrix(half, solved.by_sky) for half in halves]
    suns = [brought(half, solved.by_suns) for half in halves]
    scattered = None
    if panes is not None:
        for n, half in enumerate(halves):
            for k in range(3):
                of_sky = panes.radiances(n, on_nodes(), solved.by_sky[k])
                of_suns = panes.radiances(n, None, solved.by_suns[k])
                through = half.through[k % len(half.through)].astype(np.float32)
                sky[n][k] += through @ of_sky.astype(np.float32)
                suns[n][k] += through @ of_suns.astype(np.float32)
        scattered = _scattered_suns(panes, halves, light, go_on)
    colour = light.sun_irradiance_rgb * LUMENS_RGB
    direct = np.zeros((len(work.sensors), len(light.hour)), np.float32)
    for first in range(0, len(work.sensors), _SENSORS_AT_ONCE):
        go_on()
        some = np.arange(first, min(first + _SENSORS_AT_ONCE, len(work.sensors)))
        part = sun_shares(
            work.transport, work.glass, work.sensors.some(some), light.sun_direction, panes
        )
        direct[some] = np.einsum("phc,hc->ph", part, colour)
    return YearMatrices(
        (sky[0], sky[1]), (suns[0], suns[1]), solved.near, solved.share, direct, scattered
    )


def year_of(matrices: YearMatrices, light: YearLight) -> Year:
    """The year's product."""
    sky = np.ascontiguousarray(light.sky.transpose(2, 1, 0))
    sun = (light.sun_irradiance_rgb * LUMENS_RGB).astype(np.float32)
    halves = []
    for n, (of_sky, of_suns) in enumerate(zip(matrices.sky, matrices.suns, strict=True)):
        total = matrices.direct.copy()
        if matrices.scattered is not None:
            total += matrices.scattered[n]
        for k in range(3):
            total += np.float32(LUMENS_RGB[k]) * (of_sky[k] @ sky[k])
            spread = suns_of_hours(matrices.near, matrices.share, sun[:, k], of_suns.shape[2])
            total += (spread.T @ of_suns[k].T).T
        halves.append(total)
    mean = np.float32(0.5) * (halves[0] + halves[1])
    return Year(mean, matrices.direct, (halves[0], halves[1]))


def suns_of_hours(
    near: IntArray, share: FloatArray, irradiance: FloatArray | Float32Array, suns: int
) -> csr_matrix:
    """Irradiance (S, H) of solved suns that stand for those of hours (H,)."""
    if not suns:
        return csr_matrix((0, len(near)), dtype=np.float32)
    hours = np.repeat(np.arange(len(near)), 2)
    values = (share * irradiance[:, None]).ravel()
    return csr_matrix((values, (near.ravel(), hours)), (suns, len(near)), dtype=np.float32)


def sent_by_cells(transport: SceneTransport) -> FloatArray:
    """Irradiance (M, GROUND_NODE + 1) of patches by unit radiance of cells, and of open ground."""
    table, patches = transport.table, transport.patches
    assert patches is not None
    column, rays = columns_and_rays(table.entry)
    row = np.repeat(np.arange(len(table.valid)), np.diff(table.start))
    sky = column < NODES
    where = np.minimum(column[sky], GROUND_NODE)
    share = np.pi * rays[sky] / np.maximum(table.valid[row[sky]], 1)
    rows = csr_matrix((share, (row[sky], where)), (len(table.valid), GROUND_NODE + 1))
    patch = np.repeat(np.arange(len(patches.area)), np.diff(patches.start))
    weight = np.where(table.valid[patches.member] > 0, patches.weight, 0.0).astype(float)
    weight /= np.maximum(np.bincount(patch, weight, len(patches.area)), 1e-12)[patch]
    means = csr_matrix((weight, (patch, patches.member)), (len(patches.area), len(table.valid)))
    return np.asarray((means @ rows).toarray())


class Solver(Protocol):
    """Solves bounces between patches: a scene's transport, or its light at some wavelengths."""

    @property
    def threads(self) -> int:
        """The number that solve at once."""

    def radiosity(
        self, direct: Float32Array, emitted: Float32Array, reflectance: Float32Array
    ) -> Float32Array:
        """Radiosity of patches (M, 3) by direct irradiance and all bounces; all (M, 3)."""


def radiosities(
    transport: Solver,
    direct: Sequence[FloatArray | Float32Array],
    reflectance: Float32Array,
    go_on: CancelCheck,
) -> Float32Array:
    """Radiosity (3, M, L) of patches by each of L direct irradiances: (M, 3), or (M,) where colours
    are alike."""
    nothing = np.zeros_like(reflectance)
    out = np.zeros((3, len(reflectance), len(direct)), np.float32)

    def solve(n: int) -> None:
        go_on()
        light = direct[n].astype(np.float32)
        light = np.repeat(light[:, None], 3, axis=1) if light.ndim == 1 else light
        out[:, :, n] = transport.radiosity(light, nothing, reflectance).T

    with ThreadPoolExecutor(transport.threads) as pool:
        list(pool.map(solve, range(len(direct))))
    return out


def _solved_suns(light: YearLight) -> tuple[IntArray, FloatArray, IntArray]:
    """For each hour the two solved suns (H, 2) and shares (H, 2), and the hours (S,) of these.

    They stand in the same hour of the day, before and after it; where the sun does not shine yet,
    or no more, one stands for both.
    """
    day, clock = np.divmod(light.hour, HOURS)
    shines = luminance(light.sun_irradiance_rgb) > 0.0
    is_above = shines & (light.sun_direction[:, 1] > 0.0)
    near, share = np.zeros((len(day), 2), np.int64), np.zeros((len(day), 2))
    chosen: list[int] = []
    for time in range(HOURS):
        here = np.flatnonzero((clock == time) & is_above)
        if not len(here):
            continue
        known = here[_every(day[here])]
        first = len(chosen)
        chosen += known.tolist()
        after = np.clip(np.searchsorted(day[known], day[here]), 0, len(known) - 1)
        before = np.maximum(after - (day[known][after] > day[here]), 0)
        apart = np.maximum(day[known][after] - day[known][before], 1)
        part = np.clip((day[here] - day[known][before]) / apart, 0.0, 1.0)
        near[here] = first + np.stack([before, after], axis=1)
        share[here] = np.stack([1.0 - part, part], axis=1)
    return near, share, np.array(chosen, np.int64)


def _every(days: IntArray) -> IntArray:
    """Some of sorted days, at most DAYS_BETWEEN apart, the first and the last among them."""
    kept, last = [], -DAYS_BETWEEN
    for n, day in enumerate(days.tolist()):
        if day - last >= DAYS_BETWEEN or n == len(days) - 1:
            kept.append(n)
            last = day
    return np.array(kept, np.int64)


def _by_panes(
    bounces: PaneBounces,
    cells: csr_matrix | None,
    radiosity: Float32Array,
    glow: Float32Array | None,
    beams: Float32Array | None,
    reflectance: Float32Array,
    go_on: CancelCheck,
) -> Float32Array:
    """Radiosity (3, M, L) of patches by light of measured panes, with its bounces.

    `cells` (CELLS + 1, L): radiances of the sky; `radiosity` (3, M, L) of patches without this
    light; `glow` (O, L): radiances of panes by suns; `beams` (M, L): irradiances straight through.
    """
    lights = []
    for k in range(3):
        go_on()
        of_panes = bounces.mean_radiances(cells, radiosity[k])
        light = bounces.on_patches(of_panes if glow is None else of_panes + glow, radiosity[k])
        if cells is not None:
            light += (bounces.by_cells @ cells).toarray()
        lights.append(light if beams is None else light + beams)
    return radiosities(
        bounces.transport, list(np.moveaxis(np.array(lights), 0, -1).swapaxes(0, 1)), reflectance,
        go_on,
    )  # fmt: skip


def _scattered_suns(
    panes: MeasuredPanes, halves: tuple[Half, Half], light: YearLight, go_on: CancelCheck
) -> tuple[Float32Array, Float32Array]:
    """Lux (P, H) that measured panes scatter of each hour's sun, by either half of the rays."""
    colour = (light.sun_irradiance_rgb * LUMENS_RGB).astype(np.float32)
    shape = halves[0].through[0].shape[0], len(light.hour)
    found = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    through = [[m.astype(np.float32) for m in half.through] for half in halves]
    for first in range(0, len(light.hour), _HOURS_AT_ONCE):
        go_on()
        some = slice(first, first + _HOURS_AT_ONCE)
        glow = panes.of_sun(light.sun_direction[some])
        for out, colours in zip(found, through, strict=True):
            for k, matrix in enumerate(colours):
                # One matrix stands for all colours.
                lux = colour[some, k] if len(colours) == 3 else colour[some].sum(axis=1)
                out[:, some] += (matrix @ glow) * lux
    return found


def sky_matrix(half: Half, by_sky: Float32Array) -> Float32Array:
    """Irradiance (3, P, GROUND_NODE + 1) by radiances, straight and by all bounces."""
    summed, count = on_nodes(), len(half.seen)
    straight = [np.asarray((seen @ summed).toarray(), np.float32) for seen in half.seen]
    bounced = brought(half, by_sky)
    return np.stack([straight[k % count] + bounced[k] for k in range(3)])


def on_nodes() -> csr_matrix:
    """Which cells (CELLS + 1) are parts of each of the table's nodes (GROUND_NODE + 1)."""
    nodes = np.append(node_of_cell(), GROUND_NODE)
    return csr_matrix(
        (np.ones(CELLS + 1, np.float32), (np.arange(CELLS + 1), nodes)),
        (CELLS + 1, GROUND_NODE + 1),
    )


def brought(half: Half, sent: Float32Array) -> Float32Array:
    """Irradiance (3, P, L) by radiosities (3, M, L)."""
    count = len(half.sent)
    return np.stack(
        [np.asarray(half.sent[k % count].astype(np.float32) @ sent[k]) for k in range(3)]
    )

"""Shares of light between patches, and the bounces of an hour."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.hour.gather import four_sums
from light_transport.kernels import hot, inlined, kernel
from light_transport.rays.patches import Patches
from light_transport.rays.ray_table import RayRows, column_at, rays_at
from light_transport.rays.sky_nodes import NODES
from vrut_lite.numeric_types import Float32Array, IntArray

# Each sweep goes so much farther than Gauss and Seidel's: six sweeps for eight indoors, and for
# seven in a street, which needs eight with 1.2.
_RELAXATION = 1.1
# Patches darker than this share of the mean are held to it: a shut room has no light at all.
_DARKEST = 1e-4
_MOST_SWEEPS = 400
# A patch gets light from so many others at most.
_MOST_PARTNERS = 192
# Numbers of 16 bits name so many patches.
_SMALL = 65_536


class PatchTransfer(NamedTuple):
    """The share of each other patch's radiosity that each patch (M) receives.

    Patch i has the entries `start[i]` to `start[i + 1]`; columns count patches from 0.
    """

    start: IntArray
    column: NDArray[np.uint16] | NDArray[np.int32]
    share: Float32Array


def patch_transfer_of(table: RayRows, patches: Patches) -> PatchTransfer:
    """Means of the table's rows over patches."""
    total = len(patches.area)
    most = _most_entries(table, patches, NODES + total + 1)
    made = PatchTransfer(
        np.zeros(total + 1, np.int64),
        np.empty(most, np.uint16 if total <= _SMALL else np.int32),
        np.empty(most, np.float32),
    )
    _fill(table, patches, NODES + total + 1, made)
    entries = int(made.start[-1])
    return PatchTransfer(made.start, made.column[:entries].copy(), made.share[:entries].copy())


def enclosure(exchange: PatchTransfer) -> Float32Array:
    """Share (M,) of a patch's view that is other patches."""
    running = np.append(0.0, np.cumsum(exchange.share, dtype=np.float64))
    return np.diff(running[exchange.start]).astype(np.float32)


@kernel
def _most_entries(table, patches, columns):  # type: ignore[no-untyped-def]
    """How many entries there are at most."""
    most = 0
    seen = np.full(columns, -1, np.int32)
    for p in range(len(patches.area)):
        here = 0
        for m in range(patches.start[p], patches.start[p + 1]):
            row = patches.member[m]
            for e in range(table.start[row] + table.nodes[row], table.start[row + 1]):
                c = column_at(table.entry, e)
                if seen[c] != p:
                    seen[c] = p
                    here += c < columns - 1
        most += min(here, _MOST_PARTNERS)
    return most


@inlined
def _sort(numbers, count):  # type: ignore[no-untyped-def]
    """Sort the first of some numbers (Shell 1959, with Ciura's gaps): numpy's sort is compiled in
    1.5 s, and these are a few hundred."""
    for gap in (701, 301, 132, 57, 23, 10, 4, 1):
        for i in range(gap, count):
            number, j = numbers[i], i
            while j >= gap and numbers[j - gap] > number:
                numbers[j] = numbers[j - gap]
                j -= gap
            numbers[j] = number


@kernel
def _fill(table, patches, columns, made):  # type: ignore[no-untyped-def]
    amount = np.zeros(columns)
    touched = np.empty(columns, np.int64)
    used = 0
    for p in range(len(patches.area)):
        met, weight = 0, 0.0
        for m in range(patches.start[p], patches.start[p + 1]):
            if table.valid[patches.member[m]] > 0:
                weight += patches.weight[m]
        for m in range(patches.start[p], patches.start[p + 1]):
            row = patches.member[m]
            if table.valid[row] == 0:
                continue
            share = patches.weight[m] / (weight * table.valid[row])
            for e in range(table.start[row] + table.nodes[row], table.start[row + 1]):
                c = column_at(table.entry, e)
                if amount[c] == 0.0:
                    touched[met] = c
                    met += 1
                amount[c] += share * rays_at(table.entry, e)
        _sort(touched, met)
        partners, total = 0, 0.0
        for k in range(met):
            c = touched[k]
            if c < columns - 1:
                partners += 1
                total += amount[c]
        # An even sample stands for many partners: neighbours have neighbouring numbers.
        portion = total / _MOST_PARTNERS if partners > _MOST_PARTNERS else 0.0
        left = 0.5 * portion
        for k in range(met):
            c = touched[k]
            if c < columns - 1:
                share = amount[c]
                if portion > 0.0:
                    times = math.floor((left + share) / portion)
                    left += share - times * portion
                    share = times * portion
                if share > 0.0 and used < len(made.column):
                    made.column[used], made.share[used] = c - NODES, share
                    used += 1
            amount[c] = 0.0
        made.start[p + 1] = used


def radiosity(
    exchange: PatchTransfer,
    direct_rgb: Float32Array,
    emitted_rgb: Float32Array,
    reflectance_rgb: Float32Array,
    left: float,
) -> Float32Array:
    """Radiosity (M, 3) of patches, W m^-2, after all bounces of their direct light (M, 3).

    Bounces end when the remaining light is below the share `left` of the slowest patch's light; the
    mean is then within a hundredth of it.
    """
    sent = np.zeros((len(direct_rgb), 4), np.float32)
    _bounce(exchange, direct_rgb, emitted_rgb, reflectance_rgb, np.float32(left), sent)
    return sent[:, :3]


@hot
def direct_sky(patches, valid, light, out):  # type: ignore[no-untyped-def]
    """Irradiance (M, 3) of patches by that of the sky on rows (N, 4) that have `valid` rays."""
    start, member, weight = patches.start, patches.member, patches.weight
    for p in range(len(out)):
        whole = np.float32(0.0)
        for m in range(start[p], start[p + 1]):
            if valid[member[m]] > 0:
                whole += weight[m]
        r, g, b, _ = four_sums(light, member, weight, start[p], start[p + 1])
        scale = np.float32(1.0) / max(whole, np.float32(1e-12))
        out[p, 0], out[p, 1], out[p, 2] = r * scale, g * scale, b * scale


@hot
def _bounce(exchange, direct, emitted, reflectance, left, sent):  # type: ignore[no-untyped-def]
    """Sweeps of successive over-relaxation until the remaining light is negligible.

    A sweep's gains shrink by a factor q or better in the next: gain q / (1 - q) is to come, of
    which the largest share of any patch's light decides. q is measured, and at most what the
    surfaces send back.
    """
    start, column, share = exchange.start, exchange.column, exchange.share
    patches = len(direct)
    brightest, mean = np.float32(0.0), np.float32(0.0)
    for p in range(patches):
        for k in range(3):
            sent[p, k] = emitted[p, k] + reflectance[p, k] * direct[p, k]
            brightest = max(brightest, reflectance[p, k])
            mean += sent[p, k]
    mean /= max(3 * patches, 1)
    largest = min(brightest, np.float32(0.999))
    last_gain = np.float32(0.0)
    for sweep in range(_MOST_SWEEPS):
        gain = np.float32(0.0)
        for p in range(patches):
            got = four_sums(sent, column, share, start[p], start[p + 1])
            for k in range(3):
                light = direct[p, k] + got[k]
                step = emitted[p, k] + reflectance[p, k] * light - sent[p, k]
                step *= np.float32(_RELAXATION)
                sent[p, k] = max(sent[p, k] + step, np.float32(0.0))
                gain = max(gain, abs(step) / max(sent[p, k], mean * np.float32(_DARKEST)))
        quotient = largest
        if sweep > 1 and last_gain > 0.0:
            quotient = min(largest, gain / last_gain)
        last_gain = gain
        if gain * quotient <= left * (np.float32(1.0) - quotient):
            break

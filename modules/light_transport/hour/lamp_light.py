"""Direct light of the scene's lamps on its surfaces, computed once: lamps do not move."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import hot, inlined
from light_transport.rays.patches import Patches
from light_transport.rays.ray_starts import begin, shift
from light_transport.rays.ray_table import TRIED
from light_transport.rays.trace import MISS, mixed, nearest
from light_transport.surfaces.surfaces import Surfaces
from vrut_lite.messages.lamps import MOST_DRAWN, NONE, SceneLamps
from vrut_lite.numeric_types import Float32Array, FloatArray

_SHARPEST_RAMP = 1e-3
# A surface so near before a lamp, as a share of the way, is the lamp's own glass.
_REACHED = 1.0 - 1e-4


class LampArrays(NamedTuple):
    """Lamps (L) as kernels read them; places in radii from the scene's middle."""

    place: FloatArray
    axes: FloatArray
    intensity: FloatArray
    cone_cos: FloatArray
    table: NDArray[np.int32]
    tables: Float32Array


class LampLight(NamedTuple):
    """Irradiance (N, 3) of rows, W m^-2: of lamps that the frame draws, and of the others."""

    drawn: Float32Array
    baked: Float32Array


def lamps_in_radii(lamps: SceneLamps, surfaces: Surfaces) -> LampArrays:
    """The lamps of a scene; intensities are over the square of a radius."""
    radius_m = surfaces.radius_m
    return LampArrays(
        (lamps.position_m.values - surfaces.centre_m) / radius_m,
        lamps.axes.values,
        lamps.intensity_rgb.values / radius_m**2,
        lamps.cone_cos.values,
        lamps.table.values,
        lamps.tables.values,
    )


def patch_lamp_light(patches: Patches, free: NDArray[np.uint8], light: LampLight) -> Float32Array:
    """Irradiance (M, 3) by all lamps: means over patches of their rows with free rays (N,)."""
    both = light.drawn + light.baked
    sizes = np.diff(patches.start)
    patch = np.repeat(np.arange(len(sizes)), sizes)
    weight = np.where(free[patches.member] < TRIED, patches.weight, 0.0).astype(float)
    total = np.maximum(np.bincount(patch, weight, len(sizes)), 1e-12)
    sums = [
        np.bincount(patch, weight * both[patches.member, channel], len(sizes))
        for channel in range(3)
    ]
    return np.asarray(np.stack(sums, axis=-1) / total[:, None], np.float32)


@inlined
def _share(lamps, lamp, x, y, z):  # type: ignore[no-untyped-def]
    """Share of a lamp's intensity into a direction; `SceneLamps.intensity_towards` is its twin."""
    axes = lamps.axes
    along = axes[lamp, 0, 0] * x + axes[lamp, 0, 1] * y + axes[lamp, 0, 2] * z
    inner, outer = lamps.cone_cos[lamp, 0], lamps.cone_cos[lamp, 1]
    ramp = min(max((along - outer) / max(inner - outer, _SHARPEST_RAMP), 0.0), 1.0)
    share = ramp * ramp
    table = lamps.table[lamp]
    if table != NONE and share > 0.0:
        rows, columns = lamps.tables.shape[1], lamps.tables.shape[2]
        across = axes[lamp, 1, 0] * x + axes[lamp, 1, 1] * y + axes[lamp, 1, 2] * z
        aside = axes[lamp, 2, 0] * x + axes[lamp, 2, 1] * y + axes[lamp, 2, 2] * z
        v = math.acos(min(max(along, -1.0), 1.0)) / math.pi * (rows - 1)
        turn = math.atan2(aside, across) / (2.0 * math.pi)
        u = (turn - math.floor(turn)) * (columns - 1)
        row, column = min(int(v), rows - 2), min(int(u), columns - 2)
        v -= row
        u -= column
        near = lamps.tables[table, row, column] * (1.0 - u)
        near += lamps.tables[table, row, column + 1] * u
        far = lamps.tables[table, row + 1, column] * (1.0 - u)
        far += lamps.tables[table, row + 1, column + 1] * u
        share *= near * (1.0 - v) + far * v
    return share


@hot
def lamp_irradiance(tree, receivers, free_start, lamps, scratch, first, last, drawn, baked):  # type: ignore[no-untyped-def]
    """Fill in the irradiance [first:last] of rows by the lamps that nothing hides.

    A row has one ray to each lamp, from where its first free ray (N,) begins; what arrives on a
    texel is that in its middle, or neighbours would differ by where in them rays begin.
    """
    stack, far_stack, shifts, weights, place, normal, face, middle = scratch
    geometry, texels, probes, groups = receivers
    count = len(texels.pixel)
    for row in range(first, last):
        for channel in range(3):
            drawn[row, channel] = 0.0
            baked[row, channel] = 0.0
        if free_start[row] >= TRIED:
            continue
        shift(row, shifts)
        begin(
            geometry, texels, probes, groups, row, free_start[row], shifts, weights, place, normal,
            face,
        )  # fmt: skip
        for channel in range(3):
            middle[channel] = texels.place[row, channel] if row < count else place[channel]
        for lamp in range(len(lamps.place)):
            x = lamps.place[lamp, 0] - middle[0]
            y = lamps.place[lamp, 1] - middle[1]
            z = lamps.place[lamp, 2] - middle[2]
            squared = x * x + y * y + z * z
            cosine = face[0] * x + face[1] * y + face[2] * z
            if cosine <= 0.0 or squared <= 0.0:
                continue
            inverse = 1.0 / math.sqrt(squared)
            share = _share(lamps, lamp, -x * inverse, -y * inverse, -z * inverse)
            if share <= 0.0:
                continue
            # Along the whole way to the lamp, which is 1 long.
            distance, hit, _, _ = nearest(
                tree,
                np.float32(place[0]),
                np.float32(place[1]),
                np.float32(place[2]),
                np.float32(lamps.place[lamp, 0] - place[0]),
                np.float32(lamps.place[lamp, 1] - place[1]),
                np.float32(lamps.place[lamp, 2] - place[2]),
                mixed(row, lamp),
                stack,
                far_stack,
            )
            if hit != MISS and distance < _REACHED:
                continue
            falls = share * cosine * inverse / squared
            for channel in range(3):
                if lamp < MOST_DRAWN:
                    drawn[row, channel] += falls * lamps.intensity[lamp, channel]
                else:
                    baked[row, channel] += falls * lamps.intensity[lamp, channel]

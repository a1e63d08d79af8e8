"""Density and optical depth of a `CloudLayer`, compiled: the CPU's cloud_density.glsl.

Places are world x and z relative to the eye; heights count from the layer's base. Noise is read
from mip levels as wide as a sample, as the GPU reads it. Importing this module
imports numba.
"""

import math
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.cloud_density import (
    ANVIL_BASE_FADE,
    ANVIL_FROM,
    ANVIL_TOP_FADE,
    NOISE_TURN_RAD,
    PLANET_RADIUS_M,
    WARP,
    WARP_WAVES,
    WEATHER_TURN_RAD,
)
from vrut_lite.daylight.clouds import CloudForm
from vrut_lite.njit import SUMS_IN_ORDER, njit

# As in cloud_density.glsl: weather is never smoothed so far that the threshold finds other clouds.
SMOOTHEST_WEATHER = 2.0
_WEATHER_TURN = (math.cos(WEATHER_TURN_RAD), math.sin(WEATHER_TURN_RAD))
_TURN = 2.0 * math.pi
_NOISE_TURN = (math.cos(NOISE_TURN_RAD), math.sin(NOISE_TURN_RAD))


class Form(NamedTuple):
    """A `CloudForm` as numbers, its fields by the same names."""

    first_period_m: float
    second_period_m: float
    second_share: float
    shape_period_m: float
    detail_period_m: float
    stretch: float
    lean: float
    growth: float
    least_height: float
    side_fade: float
    anvil: float
    base_fade: float
    top_fade: float
    fraying: float
    sharpness: float


def form_numbers(form: CloudForm) -> Form:
    """A form for the kernels."""
    first_m, second_m, *others = (*form.weather_periods_m, *msgspec.structs.astuple(form)[1:])
    return Form(float(first_m), float(second_m), *(float(value) for value in others))


class Field(NamedTuple):
    """A cloud layer prepared for one eye.

    There are few arrays, since each adds to the cost of a call. `texels`: weather, shape and detail
    in [0, 1], each
    with its means over 2, 4, ... texels; `levels` (3, most, 2) has where each begins, and its edge.

    Attributes:
        logs: binary logarithm of texels a metre of the two views of the weather, of shape, detail.
        last: the coarsest level of weather, shape, detail that there is, or is used.
        origin: the eye in the two views of the weather, in shape and in detail, in periods, and in
            the two waves that warp the shape.
    """

    texels: NDArray[np.float32]
    levels: NDArray[np.int64]
    logs: tuple[float, ...]
    last: tuple[float, ...]
    origin: tuple[float, ...]
    threshold: float
    extinction_per_m: float
    base_m: float
    thickness_m: float
    eye_altitude_m: float
    form: Form


compiled = njit(cache=True, nogil=True, fastmath=SUMS_IN_ORDER)


@compiled
def _neighbours(at, n):  # type: ignore[no-untyped-def]
    """The two of n periodic texels beside a place, in periods, and the share of the second."""
    place = (at - math.floor(at)) * n - 0.5
    low = math.floor(place)
    i = int(low)
    return i if i >= 0 else n - 1, i + 1 if i + 1 < n else 0, place - low


@compiled
def _flat(texels, start, n, u, v):  # type: ignore[no-untyped-def]
    """Bilinear look-up of a level at periods u (columns) and v (rows)."""
    i0, i1, s = _neighbours(u, n)
    j0, j1, t = _neighbours(v, n)
    low = start + j0 * n
    high = start + j1 * n
    near = texels[low + i0] * (1.0 - s) + texels[low + i1] * s
    far = texels[high + i0] * (1.0 - s) + texels[high + i1] * s
    return near * (1.0 - t) + far * t


@compiled
def _deep(texels, start, n, u, v, w):  # type: ignore[no-untyped-def]
    """Trilinear look-up of a level at periods u (last axis), v and w (first axis)."""
    i0, i1, s = _neighbours(u, n)
    j0, j1, t = _neighbours(v, n)
    k0, k1, r = _neighbours(w, n)
    a = start + (k0 * n + j0) * n
    b = start + (k0 * n + j1) * n
    c = start + (k1 * n + j0) * n
    d = start + (k1 * n + j1) * n
    low = (texels[a + i0] * (1.0 - s) + texels[a + i1] * s) * (1.0 - t)
    low += (texels[b + i0] * (1.0 - s) + texels[b + i1] * s) * t
    high = (texels[c + i0] * (1.0 - s) + texels[c + i1] * s) * (1.0 - t)
    high += (texels[d + i0] * (1.0 - s) + texels[d + i1] * s) * t
    return low * (1.0 - r) + high * r


@compiled
def _weather(texels, levels, lod, u, v):  # type: ignore[no-untyped-def]
    """The weather map at periods, between two of its levels."""
    level = int(lod)
    value = _flat(texels, levels[0, level, 0], levels[0, level, 1], u, v)
    if lod > level:
        level += 1
        coarser = _flat(texels, levels[0, level, 0], levels[0, level, 1], u, v)
        value += (lod - level + 1) * (coarser - value)
    return value


@compiled
def _noise(texels, levels, kind, lod, u, v, w):  # type: ignore[no-untyped-def]
    """Shape (kind 1) or detail (2) at periods, between two of its levels."""
    level = int(lod)
    value = _deep(texels, levels[kind, level, 0], levels[kind, level, 1], u, v, w)
    if lod > level:
        level += 1
        coarser = _deep(texels, levels[kind, level, 0], levels[kind, level, 1], u, v, w)
        value += (lod - level + 1) * (coarser - value)
    return value


@compiled
def narrowed(width_m):  # type: ignore[no-untyped-def]
    """Binary logarithm of a sample's width, 1 m at least."""
    return math.log2(max(width_m, 1.0))


@compiled
def column_in(field, x, z, log_width):  # type: ignore[no-untyped-def]
    """Side and top of the clouds over a place."""
    c, s = _WEATHER_TURN
    form, o, texels, levels = field.form, field.origin, field.texels, field.levels
    first_m, second_m = form.first_period_m, form.second_period_m
    lod = min(max(log_width + field.logs[0], 0.0), field.last[0])
    weather = (1.0 - form.second_share) * _weather(
        texels, levels, lod, o[0] + x / first_m, o[1] + z / first_m
    )
    lod = min(max(log_width + field.logs[1], 0.0), field.last[0])
    weather += form.second_share * _weather(
        texels, levels, lod, o[2] + (c * x - s * z) / second_m, o[3] + (s * x + c * z) / second_m
    )
    above = weather - field.threshold
    growth = min(max(above / form.growth, 0.0), 1.0)
    top = form.least_height + (1.0 - form.least_height) * growth * (2.0 - growth)
    return above / form.side_fade, top


@compiled
def envelope_in(field, side, top, height):  # type: ignore[no-untyped-def]
    """Envelope of the noise in a column, at a height given as a share of the layer's thickness."""
    form = field.form
    base = min(max(height / form.base_fade, 0.0), 1.0)
    round_top = min(max((1.0 - height / top) / form.top_fade, 0.0), 1.0)
    cloud = min(max(side, 0.0), 1.0) * base * math.sqrt(round_top)
    if form.anvil == 0.0:
        return cloud
    from_base = min(max((height - ANVIL_FROM) / ANVIL_BASE_FADE, 0.0), 1.0)
    to_top = min(max((1.0 - height) / ANVIL_TOP_FADE, 0.0), 1.0)
    return max(cloud, min(max(side + form.anvil, 0.0), 1.0) * from_base * to_top)


@compiled
def density_in(field, envelope, x, z, over_base_m, log_width):  # type: ignore[no-untyped-def]
    """Density in [0, 1]: the noise cut by the envelope."""
    if envelope <= 0.0:
        return 0.0
    c, s = _NOISE_TURN
    form, o, texels, levels = field.form, field.origin, field.texels, field.levels
    east = (c * x - s * z - form.lean * over_base_m) / form.stretch
    south = s * x + c * z
    period_m = form.shape_period_m
    first, second = WARP_WAVES
    # The waves know no lean: the eye's origin in them is that of the base.
    along = (c * x - s * z) / form.stretch / period_m
    u = o[4] + east / period_m + WARP * math.sin(_TURN * (o[8] + first * south / period_m))
    v = o[5] + south / period_m + WARP * math.sin(_TURN * (o[9] + second * along))
    lod = min(max(log_width + field.logs[2], 0.0), field.last[1])
    kept = envelope - 1.0 + _noise(texels, levels, 1, lod, u, v, over_base_m / period_m)
    if kept <= 0.0:
        return 0.0
    if kept < form.fraying + 1.0 / form.sharpness:
        lod = min(max(log_width + field.logs[3], 0.0), field.last[2])
        period_m = form.detail_period_m
        kept -= form.fraying * _noise(
            texels, levels, 2, lod, o[6] + east / period_m, o[7] + south / period_m,
            over_base_m / period_m,
        )  # fmt: skip
    return min(max(form.sharpness * kept, 0.0), 1.0)


@compiled
def density_at(field, x, z, over_base_m, width_m):  # type: ignore[no-untyped-def]
    """Density in [0, 1] at a place; `width_m`: width of the sample."""
    height = over_base_m / field.thickness_m
    if height < 0.0 or height > 1.0:
        return 0.0
    log_width = narrowed(width_m)
    side, top = column_in(field, x, z, log_width)
    envelope = envelope_in(field, side, top, height)
    return density_in(field, envelope, x, z, over_base_m, log_width)


@compiled
def place_on_ray(field, d, along, at_m, fine_m, pixel_rad):  # type: ignore[no-untyped-def]
    """Where a ray is: x, z, height over the base, and the width of a sample there."""
    eye_radius_m = PLANET_RADIUS_M + field.eye_altitude_m
    rise = at_m * (2.0 * along + at_m)
    radius = math.sqrt(eye_radius_m * eye_radius_m + rise)
    over_base_m = field.eye_altitude_m - field.base_m + rise / (eye_radius_m + radius)
    return d[0] * at_m, d[2] * at_m, over_base_m, max(pixel_rad * at_m, 0.25 * fine_m)


@compiled
def optical_depths(field, places_m, direction, enter_m, leave_m, steps):  # type: ignore[no-untyped-def]
    """Optical depths (n,) from places (n, 2), relative to the eye, along one direction.

    `enter_m`, `leave_m`: where rays from the eye's altitude enter and leave the layer.
    """
    out = np.empty(places_m.shape[0])
    along = (PLANET_RADIUS_M + field.eye_altitude_m) * direction[1]
    step_m = (leave_m - enter_m) / steps
    for n in range(places_m.shape[0]):
        depth = 0.0
        for i in range(steps):
            at_m = enter_m + (i + 0.5) * step_m
            x, z, over_base_m, _ = place_on_ray(field, direction, along, at_m, step_m, 0.0)
            x, z = x + places_m[n, 0], z + places_m[n, 1]
            depth += density_at(field, x, z, over_base_m, 0.0)
        out[n] = depth * step_m * field.extinction_per_m
    return out

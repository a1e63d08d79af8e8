"""Density and optical depth of a `CloudLayer`, compiled: the CPU's cloud_density.glsl.

Places are world x and z relative to the eye; heights count from the layer's base. Weather and
noise are read from mip levels as wide as a sample, as the GPU reads them; within the sample they
are taken for evenly distributed about that (`cloud_spread`). Importing this module imports numba.
"""

import math
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from clouds.model.cloud_density import (
    ANVIL_FADE,
    ANVIL_FROM,
    ANVIL_RISE,
    ANVIL_ROOT,
    NOISE_TURN_RAD,
    WARP,
    WARP_WAVES,
    WEATHER_TURN_RAD,
    WEATHER_WARP,
    WEATHER_WAVES,
)
from clouds.model.cloud_spread import CloudSpread
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.messages.clouds import CloudForm
from vrut_lite.njit import SUMS_IN_ORDER, njit

# Half the range of an even distribution, in standard deviations.
_RANGE = math.sqrt(3.0)
_NARROWEST = 1e-3
# Weather is one within a sample.
_EVEN = 5e-3
_WEATHER_TURN = (math.cos(WEATHER_TURN_RAD), math.sin(WEATHER_TURN_RAD))
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
        last: the coarsest level of weather, shape, detail that there is.
        spread: see cloud_spread.py.
        origin: the eye in the two views of the weather, in shape and in detail, in periods, and in
            the waves that warp shape and weather.
    """

    texels: NDArray[np.float32]
    levels: NDArray[np.int64]
    logs: tuple[float, ...]
    last: tuple[float, ...]
    spread: CloudSpread
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
def _wave(at):  # type: ignore[no-untyped-def]
    """Nearly a sine, of period 1: parabolas."""
    place = at - math.floor(at + 0.5)
    return 8.0 * place * (1.0 - 2.0 * abs(place))


@compiled
def _spread_in(field, log_width, kind):  # type: ignore[no-untyped-def]
    """Spread of weather (kind 0) or noise (1) over a width."""
    power, log_half = field.spread.power[kind], field.spread.log_half[kind]
    return field.spread.most[kind] / (1.0 + math.pow(2.0, power * (log_half - log_width)))


@compiled
def column_in(field, x, z, log_width):  # type: ignore[no-untyped-def]
    """Mean of the weather over a place less the threshold, and half its range there."""
    c, s = _WEATHER_TURN
    form, o, texels, levels = field.form, field.origin, field.texels, field.levels
    first_m, second_m = form.first_period_m, form.second_period_m
    (ax, az), (bx, bz) = WEATHER_WAVES
    east = WEATHER_WARP * _wave(o[10] + (ax * x + az * z) / first_m)
    south = WEATHER_WARP * _wave(o[11] + (bx * x + bz * z) / first_m)
    lod = min(max(log_width + field.logs[0], 0.0), field.last[0])
    weather = (1.0 - form.second_share) * _weather(
        texels, levels, lod, o[0] + x / first_m + east, o[1] + z / first_m + south
    )
    lod = min(max(log_width + field.logs[1], 0.0), field.last[0])
    u, v = o[2] + (c * x - s * z) / second_m + east, o[3] + (s * x + c * z) / second_m + south
    weather += form.second_share * _weather(texels, levels, lod, u, v)
    return weather - field.threshold, _RANGE * _spread_in(field, log_width, 0)


@compiled
def _envelope(field, above, height):  # type: ignore[no-untyped-def]
    form = field.form
    side = above / form.side_fade
    growth = min(max(above / form.growth, 0.0), 1.0)
    top = form.least_height + (1.0 - form.least_height) * growth * (2.0 - growth)
    base = min(max(height / form.base_fade, 0.0), 1.0)
    round_top = min(max((1.0 - height / top) / form.top_fade, 0.0), 1.0)
    cloud = min(max(side, 0.0), 1.0) * base * math.sqrt(round_top)
    if form.anvil == 0.0:
        return cloud
    if height <= ANVIL_FROM:
        return cloud
    rise = min((height - ANVIL_FROM) / ANVIL_RISE, 1.0)
    within = min(max(min(height - ANVIL_FROM, 1.0 - height) / ANVIL_FADE, 0.0), 1.0)
    reach = (form.anvil + ANVIL_ROOT) * rise * rise - ANVIL_ROOT
    return max(cloud, min(max(side + reach, 0.0), 1.0) * within)


@compiled
def envelope_in(field, above, half_range, height):  # type: ignore[no-untyped-def]
    """Envelopes (4) of the noise in a column, at a height as a share of the layer's thickness: from
    the least weather in it to the most, in even steps."""
    least = _envelope(field, above - half_range, height)
    if half_range < _EVEN:
        return least, least, least, least
    third = half_range / 3.0
    return (
        least,
        _envelope(field, above - third, height),
        _envelope(field, above + third, height),
        _envelope(field, above + half_range, height),
    )


@compiled
def _filled(x):  # type: ignore[no-untyped-def]
    """Integral from 0 of a density that rises to 1 at x = 1."""
    part = min(max(x, 0.0), 1.0)
    return 0.5 * part * part + max(x - 1.0, 0.0)


@compiled
def cloud_in(field, envelopes, x, z, over_base_m, log_width):  # type: ignore[no-untyped-def]
    """Mean density in [0, 1] of a sample, and the share of it that is cloud."""
    if envelopes[3] <= 0.0:
        return 0.0, 0.0
    c, s = _NOISE_TURN
    form, o, texels, levels = field.form, field.origin, field.texels, field.levels
    east = (c * x - s * z - form.lean * over_base_m) / form.stretch
    south = s * x + c * z
    period_m = form.shape_period_m
    first, second = WARP_WAVES
    # The waves know no lean: the eye's origin in them is that of the base.
    along = (c * x - s * z) / form.stretch / period_m
    u = o[4] + east / period_m + WARP * _wave(o[8] + first * south / period_m)
    v = o[5] + south / period_m + WARP * _wave(o[9] + second * along)
    spread = _RANGE * _spread_in(field, log_width, 1)
    lod = min(max(log_width + field.logs[2], 0.0), field.last[1])
    kept = _noise(texels, levels, 1, lod, u, v, over_base_m / period_m) - 1.0
    if envelopes[3] + kept + spread <= 0.0:
        return 0.0, 0.0
    if envelopes[0] + kept - spread < form.fraying + 1.0 / form.sharpness:
        lod = min(max(log_width + field.logs[3], 0.0), field.last[2])
        period_m = form.detail_period_m
        kept -= form.fraying * _noise(
            texels, levels, 2, lod, o[6] + east / period_m, o[7] + south / period_m,
            over_base_m / period_m,
        )  # fmt: skip
    density, share = 0.0, 0.0
    for k in range(3):
        low, high = envelopes[k], envelopes[k + 1]
        if high > 0.0:
            middle = 0.5 * (low + high) + kept
            half = max(math.sqrt(0.25 * (high - low) ** 2 + spread * spread), _NARROWEST)
            share += min(max((middle + half) / (2.0 * half), 0.0), 1.0) / 3.0
            most, least = form.sharpness * (middle + half), form.sharpness * (middle - half)
            density += (_filled(most) - _filled(least)) / (6.0 * form.sharpness * half)
    return density, min(share, 1.0)


@compiled
def density_in(field, envelopes, x, z, over_base_m, log_width):  # type: ignore[no-untyped-def]
    """Mean density in [0, 1]: the noise cut by the envelope."""
    return cloud_in(field, envelopes, x, z, over_base_m, log_width)[0]


@compiled
def density_at(field, x, z, over_base_m, width_m):  # type: ignore[no-untyped-def]
    """Mean density in [0, 1] at a place; `width_m`: width of the sample."""
    height = over_base_m / field.thickness_m
    if height < 0.0 or height > 1.0:
        return 0.0
    log_width = narrowed(width_m)
    above, half_range = column_in(field, x, z, log_width)
    envelopes = envelope_in(field, above, half_range, height)
    return density_in(field, envelopes, x, z, over_base_m, log_width)


@compiled
def place_on_ray(field, d, along, at_m, fine_m, pixel_rad):  # type: ignore[no-untyped-def]
    """Where a ray is: x, z, height over the base, and the width of a sample there."""
    eye_radius_m = GROUND_RADIUS_M + field.eye_altitude_m
    rise = at_m * (2.0 * along + at_m)
    radius = math.sqrt(eye_radius_m * eye_radius_m + rise)
    over_base_m = field.eye_altitude_m - field.base_m + rise / (eye_radius_m + radius)
    # Places keep their area (Lambert's projection).
    level = at_m * math.sqrt(2.0 * radius / (radius + eye_radius_m + at_m * d[1]))
    return d[0] * level, d[2] * level, over_base_m, max(pixel_rad * at_m, 0.25 * fine_m)


@compiled
def optical_depths(field, places_m, direction, enter_m, leave_m, steps):  # type: ignore[no-untyped-def]
    """Optical depths (n,) from places (n, 2), relative to the eye, along one direction.

    `enter_m`, `leave_m`: where rays from the eye's altitude enter and leave the layer.
    """
    out = np.empty(places_m.shape[0])
    along = (GROUND_RADIUS_M + field.eye_altitude_m) * direction[1]
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

"""A `CloudLayer` along rays, compiled: the CPU's twin of clouds.frag and cloud_shadow.frag.

Places are world x and z relative to the eye; heights count from the layer's base. Noise is read
from mip levels as wide as what a sample stands for, as the GPU reads it. Importing this module
imports numba.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.cloud_density import (
    BASE_FADE,
    DETAIL_PERIOD_M,
    FRAYING,
    GROWTH,
    LEAST_HEIGHT,
    NOISE_TURN_RAD,
    PLANET_RADIUS_M,
    SHAPE_PERIOD_M,
    SHARPNESS,
    SIDE_FADE,
    TOP_FADE,
    WEATHER_PERIODS_M,
    WEATHER_SHARES,
    WEATHER_TURN_RAD,
)
from vrut_lite.njit import SUMS_IN_ORDER, njit
from vrut_lite.numeric_types import FloatArray

# Constants of cloud_light.glsl and clouds.frag, which explain them.
OCTAVES = ((2.0, 1.0), (0.8, 0.03), (0.28, 0.0066))
_DIFFUSION, _MEAN_DENSITY = 0.2, 0.5
_SUN_STEPS, _REACH, _FIRST_STEP, _STEP_GROWTH = 6, 1.6, 0.01954572, 1.9
LOWEST_SUN = -0.1
SMOOTHEST_WEATHER = 2.0
_MOST_STEPS, _STEPS_TO_COARSE, _SURFACE_HALVINGS = 256, 8, 4
_FINE, _LEAST_FINE, _FINE_OF_DISTANCE, _COARSE = 0.02, 0.06, 0.004, 3.0
_FEWEST_STEPS, _SHORTEST_STEP_M, _MOST_DEPTH = 40.0, 1.0, 1.2
_OPAQUE, _NEVER = 0.03, 1e30
_FOUR_PI = 4.0 * math.pi
_WEATHER_TURN = (math.cos(WEATHER_TURN_RAD), math.sin(WEATHER_TURN_RAD))
_NOISE_TURN = (math.cos(NOISE_TURN_RAD), math.sin(NOISE_TURN_RAD))
_NARROWEST_M = 1.0
# A constant global of this type becomes a constant of the kernel.
_OCTAVES = np.array(OCTAVES)


class Field(NamedTuple):
    """A layer as an eye has it.

    Few arrays, for each costs at every call. `texels`: weather, shape and detail in [0, 1], each
    with its means over 2, 4, ... texels; `levels` (3, most, 2) has where each begins, and its edge.

    Attributes:
        logs: binary logarithm of texels a metre of the two views of the weather, of shape, detail.
        last: the coarsest level of weather, shape, detail that there is, or is used.
        origin: the eye in the two views of the weather, in shape and in detail, in periods.
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


class Lights(NamedTuple):
    """What shines on the layer: `suns` (2, n, 3) at base and top by the sun's height."""

    sun: FloatArray
    suns: FloatArray
    from_above: FloatArray
    from_below: FloatArray
    phase: FloatArray


_compiled = njit(cache=True, nogil=True, fastmath=SUMS_IN_ORDER)
_inner = njit(cache=True, nogil=True, fastmath=SUMS_IN_ORDER)


@_compiled
def _neighbours(at, n):  # type: ignore[no-untyped-def]
    """The two of n periodic texels beside a place, in periods, and the share of the second."""
    place = (at - math.floor(at)) * n - 0.5
    low = math.floor(place)
    i = int(low)
    return i if i >= 0 else n - 1, i + 1 if i + 1 < n else 0, place - low


@_compiled
def _flat(texels, start, n, u, v):  # type: ignore[no-untyped-def]
    """Bilinear look-up of a level at periods u (columns) and v (rows)."""
    i0, i1, s = _neighbours(u, n)
    j0, j1, t = _neighbours(v, n)
    low = start + j0 * n
    high = start + j1 * n
    near = texels[low + i0] * (1.0 - s) + texels[low + i1] * s
    far = texels[high + i0] * (1.0 - s) + texels[high + i1] * s
    return near * (1.0 - t) + far * t


@_compiled
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


@_compiled
def _weather(texels, levels, lod, u, v):  # type: ignore[no-untyped-def]
    """The weather map at periods, between two of its levels."""
    level = int(lod)
    value = _flat(texels, levels[0, level, 0], levels[0, level, 1], u, v)
    if lod > level:
        level += 1
        coarser = _flat(texels, levels[0, level, 0], levels[0, level, 1], u, v)
        value += (lod - level + 1) * (coarser - value)
    return value


@_compiled
def _noise(texels, levels, kind, lod, u, v, w):  # type: ignore[no-untyped-def]
    """Shape (kind 1) or detail (2) at periods, between two of its levels."""
    level = int(lod)
    value = _deep(texels, levels[kind, level, 0], levels[kind, level, 1], u, v, w)
    if lod > level:
        level += 1
        coarser = _deep(texels, levels[kind, level, 0], levels[kind, level, 1], u, v, w)
        value += (lod - level + 1) * (coarser - value)
    return value


@_compiled
def _column(field, x, z, log_width):  # type: ignore[no-untyped-def]
    """Strength and top of the clouds over a place."""
    c, s = _WEATHER_TURN
    first_m, second_m = WEATHER_PERIODS_M
    o, texels, levels = field.origin, field.texels, field.levels
    lod = min(max(log_width + field.logs[0], 0.0), field.last[0])
    weather = WEATHER_SHARES[0] * _weather(
        texels, levels, lod, o[0] + x / first_m, o[1] + z / first_m
    )
    lod = min(max(log_width + field.logs[1], 0.0), field.last[0])
    weather += WEATHER_SHARES[1] * _weather(
        texels, levels, lod, o[2] + (c * x - s * z) / second_m, o[3] + (s * x + c * z) / second_m
    )
    above = weather - field.threshold
    growth = min(max(above / GROWTH, 0.0), 1.0)
    strength = min(max(above / SIDE_FADE, 0.0), 1.0)
    return strength, LEAST_HEIGHT + (1.0 - LEAST_HEIGHT) * growth * (2.0 - growth)


@_compiled
def _envelope(strength, top, height):  # type: ignore[no-untyped-def]
    base = min(max(height / BASE_FADE, 0.0), 1.0)
    round_top = min(max((1.0 - height / top) / TOP_FADE, 0.0), 1.0)
    return strength * base * math.sqrt(round_top)


@_compiled
def _density(field, envelope, x, z, over_base_m, log_width):  # type: ignore[no-untyped-def]
    if envelope <= 0.0:
        return 0.0
    c, s = _NOISE_TURN
    o, texels, levels = field.origin, field.texels, field.levels
    east, south = c * x - s * z, s * x + c * z
    lod = min(max(log_width + field.logs[2], 0.0), field.last[1])
    kept = envelope - 1.0 + _noise(
        texels, levels, 1, lod, o[4] + east / SHAPE_PERIOD_M, o[5] + south / SHAPE_PERIOD_M,
        over_base_m / SHAPE_PERIOD_M,
    )  # fmt: skip
    if kept <= 0.0:
        return 0.0
    if kept < FRAYING + 1.0 / SHARPNESS:
        lod = min(max(log_width + field.logs[3], 0.0), field.last[2])
        kept -= FRAYING * _noise(
            texels, levels, 2, lod, o[6] + east / DETAIL_PERIOD_M, o[7] + south / DETAIL_PERIOD_M,
            over_base_m / DETAIL_PERIOD_M,
        )  # fmt: skip
    return min(max(SHARPNESS * kept, 0.0), 1.0)


@_inner
def _density_at(field, x, z, over_base_m, width_m):  # type: ignore[no-untyped-def]
    height = over_base_m / field.thickness_m
    if height < 0.0 or height > 1.0:
        return 0.0
    log_width = math.log2(max(width_m, _NARROWEST_M))
    strength, top = _column(field, x, z, log_width)
    envelope = _envelope(strength, top, height)
    return _density(field, envelope, x, z, over_base_m, log_width)


@_inner
def _sun_optical_depth(field, sun, x, z, over_base_m, width_m):  # type: ignore[no-untyped-def]
    """Towards the sun, until the layer ends."""
    rise = sun[1]
    room_m = field.thickness_m - over_base_m if rise > 0.0 else over_base_m
    reach_m = min(_REACH * field.thickness_m, max(room_m, 0.0) / max(abs(rise), 1e-6))
    step_m, gone_m, depth = _FIRST_STEP * reach_m, 0.0, 0.0
    for _ in range(_SUN_STEPS):
        at_m = gone_m + 0.5 * step_m
        depth += step_m * _density_at(
            field,
            x + sun[0] * at_m,
            z + sun[2] * at_m,
            over_base_m + rise * at_m,
            max(width_m, 0.5 * step_m),
        )
        gone_m += step_m
        step_m *= _STEP_GROWTH
    return depth * field.extinction_per_m


@_inner
def _add_source(field, lights, x, z, over_base_m, top, phase, width_m, seen, radiance):  # type: ignore[no-untyped-def]
    """Add `seen` times the radiance per optical depth that a place in the cloud sends."""
    height = over_base_m / field.thickness_m
    sun = lights.sun
    depth = _sun_optical_depth(field, sun, x, z, over_base_m, width_m)
    scattered = phase * math.exp(-depth)
    for k in range(3):
        scattered += _OCTAVES[k, 0] * math.exp(-_OCTAVES[k, 1] * depth) / _FOUR_PI
    full_depth = field.extinction_per_m * field.thickness_m * _MEAN_DENSITY
    above = 1.0 + _DIFFUSION * max(top - height, 0.0) * full_depth
    below = 1.0 + _DIFFUSION * height * full_depth
    sine = sun[1] + (x * sun[0] + z * sun[2]) / PLANET_RADIUS_M
    last = lights.suns.shape[1] - 1
    row = math.sqrt(min(max((sine - LOWEST_SUN) / (1.0 - LOWEST_SUN), 0.0), 1.0)) * last
    i = min(int(row), last - 1)
    for c in range(3):
        base = lights.suns[0, i, c] + (row - i) * (lights.suns[0, i + 1, c] - lights.suns[0, i, c])
        high = lights.suns[1, i, c] + (row - i) * (lights.suns[1, i + 1, c] - lights.suns[1, i, c])
        sky = 0.5 * (lights.from_above[c] / above + lights.from_below[c] / below)
        radiance[c] += seen * ((base + height * (high - base)) * scattered + sky)


@_compiled
def _henyey_greenstein(beside, g):  # type: ignore[no-untyped-def]
    spread = (1.0 - g) * (1.0 - g) + 2.0 * g * beside
    return (1.0 - g * g) / (_FOUR_PI * spread * math.sqrt(spread))


@_compiled
def _squares_m2(altitude_m, eye_altitude_m):  # type: ignore[no-untyped-def]
    radii_m = 2.0 * PLANET_RADIUS_M + altitude_m + eye_altitude_m
    return (altitude_m - eye_altitude_m) * radii_m


@_compiled
def _chord(eye_radius_m, along, perigee_m, squares_m2):  # type: ignore[no-untyped-def]
    """Distances to where a ray enters and leaves a sphere, and half the chord; none if negative."""
    radius = math.sqrt(eye_radius_m * eye_radius_m + squares_m2)
    squared = along * along + squares_m2
    if squares_m2 < 0.0 and perigee_m < 0.7 * radius:
        squared = (radius - perigee_m) * (radius + perigee_m)
    if squared <= 0.0:
        return _NEVER, -_NEVER, -1.0
    root = math.sqrt(squared)
    far = along + root if along > 0.0 else root - along
    if along > 0.0:
        return -far, squares_m2 / far, root
    return -squares_m2 / far, far, root


@_compiled
def _place(field, d, along, at_m, fine_m, pixel_rad):  # type: ignore[no-untyped-def]
    """Where a ray is: x, z, height over the base, and the width of a sample there."""
    eye_radius_m = PLANET_RADIUS_M + field.eye_altitude_m
    rise = at_m * (2.0 * along + at_m)
    radius = math.sqrt(eye_radius_m * eye_radius_m + rise)
    over_base_m = field.eye_altitude_m - field.base_m + rise / (eye_radius_m + radius)
    return d[0] * at_m, d[2] * at_m, over_base_m, max(pixel_rad * at_m, 0.25 * fine_m)


@_inner
def _density_on_ray(field, d, along, at_m, fine_m, pixel_rad):  # type: ignore[no-untyped-def]
    x, z, over_base_m, width_m = _place(field, d, along, at_m, fine_m, pixel_rad)
    log_width = math.log2(max(width_m, _NARROWEST_M))
    strength, top = _column(field, x, z, log_width)
    height = min(max(over_base_m / field.thickness_m, 0.0), 1.0)
    envelope = _envelope(strength, top, height)
    return envelope, top, _density(field, envelope, x, z, over_base_m, log_width)


@_inner
def _march(field, lights, d, along, first_m, end_m, pixel_rad, dither, phase, out):  # type: ignore[no-untyped-def]
    """March through one piece of a ray; `out`: radiance, transmittance, distance, weight."""
    t, clear_m, clear, inside = first_m, first_m, _STEPS_TO_COARSE, False
    # Wide rays take longer steps.
    fine = min(max(_FINE, 2.0 * pixel_rad), _LEAST_FINE)
    coarsest_m = max((end_m - first_m) / _FEWEST_STEPS, _SHORTEST_STEP_M)
    for _ in range(_MOST_STEPS):
        if t >= end_m:
            break
        fine_m = max(fine * field.thickness_m, max(_FINE_OF_DISTANCE, 0.5 * pixel_rad) * t)
        fine_m = min(fine_m, coarsest_m)
        coarse = clear >= _STEPS_TO_COARSE
        step_m = _COARSE * fine_m if coarse else fine_m
        if inside:
            step_m = min(step_m, _MOST_DEPTH / field.extinction_per_m)
        step_m = min(step_m, end_m - t)
        at_m = t + (0.5 if inside else dither) * step_m
        envelope, top, density = _density_on_ray(field, d, along, at_m, fine_m, pixel_rad)
        if coarse and envelope > 0.0:
            clear = 0
            continue
        if density > 0.0 and not inside:
            inside, clear = True, 0
            near, far = max(clear_m, t - fine_m), at_m
            for _ in range(_SURFACE_HALVINGS):
                middle = 0.5 * (near + far)
                if _density_on_ray(field, d, along, middle, fine_m, pixel_rad)[2] > 0.0:
                    far = middle
                else:
                    near = middle
            t = far
            continue
        if density > 0.0:
            kept = math.exp(-field.extinction_per_m * density * step_m)
            seen = out[3] * (1.0 - kept)
            x, z, over_base_m, width_m = _place(field, d, along, at_m, fine_m, pixel_rad)
            _add_source(field, lights, x, z, over_base_m, top, phase, width_m, seen, out)
            out[4] += seen * at_m
            out[5] += seen
            out[3] *= kept
            if out[3] < _OPAQUE:
                break
        else:
            clear_m, inside = at_m, False
            clear += 1
        t += step_m


@_compiled
def look_at_clouds(field, lights, directions, pixel_rad, out):  # type: ignore[no-untyped-def]
    """Clouds along rays (n, 3) from the eye, unit vectors in world axes.

    `out` (n, 5) takes radiance, transmittance, and the mean distance (m) of what is seen of them,
    0 where nothing is. `pixel_rad`: the angle that a ray stands for.
    """
    eye_radius_m = PLANET_RADIUS_M + field.eye_altitude_m
    top_m2 = _squares_m2(field.base_m + field.thickness_m, field.eye_altitude_m)
    base_m2 = _squares_m2(field.base_m, field.eye_altitude_m)
    ground_m2 = _squares_m2(min(0.0, field.eye_altitude_m), field.eye_altitude_m)
    march = np.empty(6)
    for n in range(directions.shape[0]):
        d = directions[n]
        along = eye_radius_m * d[1]
        perigee_m = eye_radius_m * math.hypot(d[0], d[2])
        ground = _chord(eye_radius_m, along, perigee_m, ground_m2)
        last_m = ground[0] if ground[2] > 0.0 and along < 0.0 else _NEVER
        top = _chord(eye_radius_m, along, perigee_m, top_m2)
        base = _chord(eye_radius_m, along, perigee_m, base_m2)
        first_m, end_m = max(top[0], 0.0), min(top[1], last_m)
        beside = 0.0
        for c in range(3):
            beside += 0.5 * (d[c] - lights.sun[c]) ** 2
        forward = _henyey_greenstein(beside, lights.phase[0])
        phase = _henyey_greenstein(beside, lights.phase[1])
        phase += lights.phase[2] * (forward - phase)
        # The R2 sequence (Roberts 2018) along the rays: neighbours begin their steps elsewhere.
        dither = (0.5 + 0.7548776662466927 * n) % 1.0
        march[:] = 0.0
        march[3] = 1.0
        if base[2] < 0.0:
            _march(field, lights, d, along, first_m, end_m, pixel_rad, dither, phase, march)
        else:
            near_m, far_m = min(end_m, base[0]), max(first_m, base[1])
            _march(field, lights, d, along, first_m, near_m, pixel_rad, dither, phase, march)
            if march[3] >= _OPAQUE:
                _march(field, lights, d, along, far_m, end_m, pixel_rad, dither, phase, march)
        hidden = march[3] if march[3] < _OPAQUE else 0.0
        for c in range(3):
            out[n, c] = march[c] / (1.0 - hidden)
        out[n, 3] = march[3] - hidden
        out[n, 4] = march[4] / march[5] if march[5] > 0.0 else 0.0


@_compiled
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
            x, z, over_base_m, _ = _place(field, direction, along, at_m, step_m, 0.0)
            x, z = x + places_m[n, 0], z + places_m[n, 1]
            depth += _density_at(field, x, z, over_base_m, 0.0)
        out[n] = depth * step_m * field.extinction_per_m
    return out

"""Rays through a `CloudLayer`, compiled: the CPU's clouds.frag and cloud_light.glsl.

Places are world x and z relative to the eye; heights count from the layer's base. Importing this
module imports numba.
"""

import math
from typing import NamedTuple

import numpy as np

from vrut_lite.daylight.cloud_density import PLANET_RADIUS_M
from vrut_lite.daylight.cloud_density_kernels import (
    column_in,
    compiled,
    density_at,
    density_in,
    envelope_in,
    narrowed,
    place_on_ray,
)
from vrut_lite.numeric_types import FloatArray

# As in cloud_light.glsl and clouds.frag, which explain them.
_OCTAVES = np.array(((2.0, 1.0), (0.8, 0.03), (0.28, 0.0066)))
_DIFFUSION, _MEAN_DENSITY = 0.2, 0.5
_SUN_STEPS, _REACH, _FIRST_STEP, _STEP_GROWTH = 6, 1.6, 0.01954572, 1.9
LOWEST_SUN = -0.1
_MOST_STEPS, _STEPS_TO_COARSE, _SURFACE_HALVINGS = 256, 8, 4
_FINE, _FINE_OF_DISTANCE, _COARSE = 0.02, 0.004, 3.0
_FEWEST_STEPS, _SHORTEST_STEP_M, _MOST_DEPTH = 40.0, 1.0, 1.2
# The longest fine steps, of wide rays. Rays end sooner than the shader's, which are fewer.
_LEAST_FINE, _OPAQUE = 0.06, 0.01
_NEVER, _FOUR_PI = 1e30, 4.0 * math.pi


class Lights(NamedTuple):
    """Light on the layer: `suns` (2, n, 3) at base and top by the sun's height."""

    sun: FloatArray
    suns: FloatArray
    from_above: FloatArray
    from_below: FloatArray
    phase: FloatArray


@compiled
def _sun_optical_depth(field, sun, x, z, over_base_m, width_m):  # type: ignore[no-untyped-def]
    """Optical depth towards the sun, to the end of the layer."""
    rise = sun[1]
    room_m = field.thickness_m - over_base_m if rise > 0.0 else over_base_m
    reach_m = min(_REACH * field.thickness_m, max(room_m, 0.0) / max(abs(rise), 1e-6))
    step_m, gone_m, depth = _FIRST_STEP * reach_m, 0.0, 0.0
    for _ in range(_SUN_STEPS):
        at_m = gone_m + 0.5 * step_m
        depth += step_m * density_at(
            field,
            x + sun[0] * at_m,
            z + sun[2] * at_m,
            over_base_m + rise * at_m,
            max(width_m, 0.5 * step_m),
        )
        gone_m += step_m
        step_m *= _STEP_GROWTH
    return depth * field.extinction_per_m


@compiled
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


@compiled
def _henyey_greenstein(beside, g):  # type: ignore[no-untyped-def]
    spread = (1.0 - g) * (1.0 - g) + 2.0 * g * beside
    return (1.0 - g * g) / (_FOUR_PI * spread * math.sqrt(spread))


@compiled
def _squares_m2(altitude_m, eye_altitude_m):  # type: ignore[no-untyped-def]
    radii_m = 2.0 * PLANET_RADIUS_M + altitude_m + eye_altitude_m
    return (altitude_m - eye_altitude_m) * radii_m


@compiled
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


@compiled
def _density_on_ray(field, d, along, at_m, fine_m, pixel_rad):  # type: ignore[no-untyped-def]
    x, z, over_base_m, width_m = place_on_ray(field, d, along, at_m, fine_m, pixel_rad)
    log_width = narrowed(width_m)
    side, top = column_in(field, x, z, log_width)
    height = min(max(over_base_m / field.thickness_m, 0.0), 1.0)
    envelope = envelope_in(field, side, top, height)
    return envelope, top, density_in(field, envelope, x, z, over_base_m, log_width)


@compiled
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
            x, z, over_base_m, width_m = place_on_ray(field, d, along, at_m, fine_m, pixel_rad)
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


@compiled
def look_at_clouds(field, lights, directions, pixel_rad, out):  # type: ignore[no-untyped-def]
    """Clouds along rays (n, 3) from the eye, unit vectors in world axes.

    `out` (n, 5) takes radiance, transmittance, and the mean distance (m) of the visible clouds, 0
    where there are none. `pixel_rad`: the angle that a ray stands for.
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

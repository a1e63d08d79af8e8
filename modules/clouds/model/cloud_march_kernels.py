"""Rays through a `CloudLayer`, compiled: the CPU's clouds.frag and cloud_light.glsl.

Places are world x and z relative to the eye; heights count from the layer's base. Importing this
module imports numba.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from clouds.model.cloud_density_kernels import (
    cloud_in,
    column_in,
    compiled,
    density_at,
    envelope_in,
    narrowed,
    place_on_ray,
)
from clouds.model.cloud_diffusion import MEAN_COSINE, plane_light
from clouds.model.cloud_grid import LEAST_SINE
from clouds.model.cloud_light_volume import DARKEST, LightVolume, volume_at
from clouds.model.cloud_transport import (
    DEPTH_SCALE,
    LOWEST_RAD,
    MOST_DEPTH,
    NODE_DEPTHS,
    NODE_SINES,
    NODE_VIEWS,
)
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.numeric_types import FloatArray

# As in cloud_light.glsl and clouds.frag, which explain them.
_NEAR_STEPS, _LONGEST_UNIT = (1.0, 2.0), 0.05
_LEAST_DEPTH, _LEAST_SHARE, _LEAST_DIFFUSE, _LEAST_LIGHT = 0.02, 0.1, 0.2, 1e-6
_DARK = 0.5 * DARKEST
LOWEST_SUN = -0.1
_MOST_STEPS, _STEPS_TO_COARSE, _SURFACE_HALVINGS = 256, 8, 4
_FINE, _FINE_OF_DISTANCE, _COARSE = 0.02, 0.004, 3.0
_FEWEST_STEPS, _SHORTEST_STEP_M, _MOST_DEPTH = 40.0, 1.0, 1.0
# The longest fine steps, of wide rays. Rays end sooner than the shader's, which are fewer.
_LEAST_FINE, _OPAQUE = 0.06, 0.005
_BILLOW, _PARTED = 0.3, 1e-6
_NEVER = 1e30
_DEPTH_NODES = NODE_DEPTHS.size - 1.0
_OF_LOG_DEPTH = _DEPTH_NODES / math.log1p(MOST_DEPTH / DEPTH_SCALE)
_OF_VIEW = (NODE_VIEWS.size - 1.0) / math.pi
_SINE_NODES = NODE_SINES.size - 1.0
_SINE_RANGE_RAD = 0.5 * math.pi - LOWEST_RAD
_LEVEL = 1e-6
_SPHERE = 4.0 * math.pi


class Lights(NamedTuple):
    """Light on the layer: `suns` (2, n, 3) at base and top by the sun's height.

    Attributes:
        phase: (3, nodes, 3) of the droplets, uniform in sin(theta / 2), and `source`, see
            cloud_transport.py.
        volume: see cloud_light_volume.py.
        diffused: share of extinction that counts, after delta-M.
    """

    sun: FloatArray
    suns: FloatArray
    from_above: FloatArray
    from_below: FloatArray
    phase: FloatArray
    volume: LightVolume
    source: NDArray[np.float32]
    diffused: float


@compiled
def _depth_node(scaled):  # type: ignore[no-untyped-def]
    return min(math.log1p(scaled / DEPTH_SCALE) * _OF_LOG_DEPTH, _DEPTH_NODES)


@compiled
def _view_node(mu):  # type: ignore[no-untyped-def]
    return (math.asin(min(max(mu, -1.0), 1.0)) + 0.5 * math.pi) * _OF_VIEW


@compiled
def _sine_node(sine):  # type: ignore[no-untyped-def]
    over = (math.asin(min(max(sine, 0.0), 1.0)) - LOWEST_RAD) / _SINE_RANGE_RAD
    return math.sqrt(max(over, 0.0)) * _SINE_NODES


@compiled
def _look_up(table, below, above, view, count, out):  # type: ignore[no-untyped-def]
    """The first numbers of a table (below, above, views, 4) at nodes, into `out`."""
    b, a = min(int(below), table.shape[0] - 2), min(int(above), table.shape[1] - 2)
    v = min(int(view), table.shape[2] - 2)
    s, t, r = below - b, above - a, view - v
    for c in range(count):
        total = 0.0
        for i in range(2):
            near = table[b + i, a, v, c] * (1.0 - r) + table[b + i, a, v + 1, c] * r
            far = table[b + i, a + 1, v, c] * (1.0 - r) + table[b + i, a + 1, v + 1, c] * r
            total += (s if i else 1.0 - s) * (near * (1.0 - t) + far * t)
        out[c] = total


@compiled
def sun_source(source, above, below, sine, view, nu, log_twice, out):  # type: ignore[no-untyped-def]
    """Diffuse source (sr^-1) of a sun of irradiance 1: scaled depths, cosines of the slab."""
    a, b, v = _depth_node(above), _depth_node(below), _view_node(view)
    node = _sine_node(sine)
    i = min(int(node), source.shape[0] - 3)
    level = math.sqrt(max((1.0 - view * view) * (1.0 - sine * sine), _LEVEL))
    wave = min(max((nu - view * sine) / level, -1.0), 1.0)
    logs = 0.0
    for k in range(2):
        _look_up(source[i + k], b, a, v, 4, out)
        log = out[0] + out[1] * wave + out[2] * (2.0 * wave * wave - 1.0) + out[3] * log_twice
        logs += log * (node - i if k else 1.0 - node + i)
    return math.exp(logs)


@compiled
def _add_source(  # type: ignore[no-untyped-def]
    field, lights, d, nu, rise, x, z, over_base_m, phase, width_m, seen, work, radiance
):
    """Add `seen` times the radiance per optical depth that a place in the cloud sends.

    `rise`: sine of the view's elevation there; `work`: (8,) room for look-ups.
    """
    sun, diffused = lights.sun, lights.diffused
    # Near depth from the density itself, the rest from the volume, which is coarse.
    unit_m = min(1.0 / (diffused * field.extinction_per_m), _LONGEST_UNIT * field.thickness_m)
    near, reach_m = 0.0, 0.0
    for k in range(len(_NEAR_STEPS)):
        step_m = _NEAR_STEPS[k] * unit_m
        at_m = reach_m + 0.5 * step_m
        near += step_m * density_at(
            field, x + sun[0] * at_m, z + sun[2] * at_m, over_base_m + sun[1] * at_m,
            max(width_m, 0.5 * step_m),
        )  # fmt: skip
        reach_m += step_m
    near *= field.extinction_per_m
    ahead_x, ahead_z = x + sun[0] * reach_m, z + sun[2] * reach_m
    ahead = (over_base_m + sun[1] * reach_m) / field.thickness_m
    depths = work[4:8]
    volume_at(lights.volume.depths, lights.volume.near_m, ahead, ahead_x, ahead_z, depths)
    to_sun = near + depths[0]
    upright = depths[1] + depths[2]
    lit, unscattered = math.exp(-diffused * to_sun), math.exp(-to_sun)
    sine = sun[1] + (x * sun[0] + z * sun[2]) / GROUND_RADIUS_M
    # Light in the plane layer that is as deep, with as much before the sun as here, by the tables;
    # how much more or less of it there is than in that layer, by diffusion.
    low = min(max(sine, LEAST_SINE), 1.0)
    over = min(max(depths[1] + near * max(sun[1], 0.0), 0.0), upright)
    # Where no sun is left the volume does not count on.
    counts = min(max(2.0 - diffused * to_sun / _DARK, 0.0), 1.0)
    above = diffused * (over + counts * (to_sun * low - over))
    below = max(diffused * upright - above, 0.0)
    diffuse = sun_source(lights.source, above, below, low, rise, nu, phase[2, 0], work)
    _look_up(
        lights.source[-1], _depth_node(diffused * (upright - over)), _depth_node(diffused * over),
        _view_node(rise), 1, work,
    )  # fmt: skip
    even = work[0]
    height = over_base_m / field.thickness_m
    levels = lights.volume.depths.shape[0] - 1
    under = min(int(min(max(height, 0.0), 1.0) * levels), levels - 1)
    far, there, ahead, over = min(max(height, 0.0), 1.0) * levels - under, 0.0, 0.0, 0.0
    # As the grid has it: what falls to nothing within one of its cells is a line there.
    for k in range(2):
        volume_at(
            lights.volume.depths, lights.volume.near_m, (under + k) / levels, x, z, depths
        )  # fmt: skip
        share = far if k else 1.0 - far
        there -= share * math.expm1(-diffused * max(depths[0], 0.0))
        ahead += share * depths[0]
        over += share * depths[1]
    above = diffused * (over + counts * (ahead * low - over))
    below = max(diffused * upright - above, _LEAST_DEPTH)
    level, flux = plane_light(max(above, _LEAST_DEPTH), below, there, low)
    volume_at(lights.volume.diffuse, lights.volume.near_m, height, x, z, depths)
    along = -(depths[1] * d[0] + depths[2] * rise + depths[3] * d[2])
    here = max(depths[0] + 3.0 * MEAN_COSINE * along, _LEAST_SHARE * depths[0])
    plane = max(level + 3.0 * MEAN_COSINE * flux * rise, _LEAST_SHARE * level)
    # Directions that diffusion has not are the plane layer's, as far as the light is like its.
    alike = max(min(depths[0], level) / max(depths[0], level, _LEAST_LIGHT), 0.0)
    diffuse = alike * diffuse + (here - alike * plane) / _SPHERE
    diffuse = max(diffuse, _LEAST_DIFFUSE * here / _SPHERE)
    last = lights.suns.shape[1] - 1
    row = math.sqrt(min(max((sine - LOWEST_SUN) / (1.0 - LOWEST_SUN), 0.0), 1.0)) * last
    i = min(int(row), last - 1)
    for c in range(3):
        base = lights.suns[0, i, c] + (row - i) * (lights.suns[0, i + 1, c] - lights.suns[0, i, c])
        high = lights.suns[1, i, c] + (row - i) * (lights.suns[1, i + 1, c] - lights.suns[1, i, c])
        scattered = (phase[0, c] * lit + phase[1, c] * unscattered) / diffused + diffuse
        sky = lights.from_below[c] + even * (lights.from_above[c] - lights.from_below[c])
        radiance[c] += seen * ((base + height * (high - base)) * scattered + sky)


@compiled
def _phase_into(table, beside, out):  # type: ignore[no-untyped-def]
    """Parts of the phase function (3, 3) at 1 - the cosine."""
    place = math.sqrt(min(max(0.5 * beside, 0.0), 1.0)) * (table.shape[1] - 1)
    i = min(int(place), table.shape[1] - 2)
    for k in range(3):
        for c in range(3):
            out[k, c] = table[k, i, c] + (place - i) * (table[k, i + 1, c] - table[k, i, c])


@compiled
def _squares_m2(altitude_m, eye_altitude_m):  # type: ignore[no-untyped-def]
    radii_m = 2.0 * GROUND_RADIUS_M + altitude_m + eye_altitude_m
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
    above, half_range = column_in(field, x, z, log_width)
    height = min(max(over_base_m / field.thickness_m, 0.0), 1.0)
    envelopes = envelope_in(field, above, half_range, height)
    density, share = cloud_in(field, envelopes, x, z, over_base_m, log_width)
    return envelopes[3], density, share, width_m


@compiled
def _enter_share(out, share, way):  # type: ignore[no-untyped-def]
    """A wide ray goes on to a sample of which a share is cloud: see clouds.frag."""
    beside, grown = out[3] - out[6], share - out[7]
    parted = beside / max(1.0 - out[7], _PARTED) if grown > 0.0 else out[6] / max(out[7], _PARTED)
    out[6] += grown * parted
    out[6] = share * out[3] + (out[6] - share * out[3]) / (1.0 + way)
    out[7] = share


@compiled
def _march(field, lights, d, along, nu, first_m, end_m, pixel_rad, dither, phase, work, out):  # type: ignore[no-untyped-def]
    """March through one piece of a ray; `out`: radiance, transmittance, distance, weight, and of
    what passed and of the ray, the shares in clouds."""
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
            step_m = min(step_m, _MOST_DEPTH / (lights.diffused * field.extinction_per_m))
        step_m = min(step_m, end_m - t)
        at_m = t + (0.5 if inside else dither) * step_m
        envelope, density, share, width_m = _density_on_ray(
            field, d, along, at_m, fine_m, pixel_rad
        )
        if coarse and envelope > 0.0:
            clear = 0
            continue
        if density > 0.0 and not inside:
            inside, clear = True, 0
            near, far = max(clear_m, t - fine_m), at_m
            for _ in range(_SURFACE_HALVINGS):
                middle = 0.5 * (near + far)
                if _density_on_ray(field, d, along, middle, fine_m, pixel_rad)[1] > 0.0:
                    far = middle
                else:
                    near = middle
            t = far
            continue
        _enter_share(out, share, step_m / min(width_m, _BILLOW * field.form.shape_period_m))
        if density > 0.0:
            per_m = lights.diffused * field.extinction_per_m * density / share
            seen = -out[6] * math.expm1(-per_m * step_m)
            x, z, over_base_m, width_m = place_on_ray(field, d, along, at_m, fine_m, pixel_rad)
            rise = d[1] + at_m / GROUND_RADIUS_M
            _add_source(
                field, lights, d, nu, rise, x, z, over_base_m, phase, width_m, seen, work, out
            )  # fmt: skip
            out[4] += seen * at_m
            out[5] += seen
            out[3] -= seen
            out[6] -= seen
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
    without clouds. `pixel_rad`: the angular width of a ray's pixel.
    """
    eye_radius_m = GROUND_RADIUS_M + field.eye_altitude_m
    top_m2 = _squares_m2(field.base_m + field.thickness_m, field.eye_altitude_m)
    base_m2 = _squares_m2(field.base_m, field.eye_altitude_m)
    ground_m2 = _squares_m2(min(0.0, field.eye_altitude_m), field.eye_altitude_m)
    march, phase, work = np.empty(8), np.empty((3, 3)), np.empty(8)
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
        _phase_into(lights.phase, beside, phase)
        # The R2 sequence (Roberts 2018) along the rays: neighbours begin their steps elsewhere.
        dither = (0.5 + 0.7548776662466927 * n) % 1.0
        march[:] = 0.0
        march[3] = 1.0
        if base[2] < 0.0:
            _march(
                field,
                lights,
                d,
                along,
                1.0 - beside,
                first_m,
                end_m,
                pixel_rad,
                dither,
                phase,
                work,
                march,
            )
        else:
            near_m, far_m = min(end_m, base[0]), max(first_m, base[1])
            _march(
                field,
                lights,
                d,
                along,
                1.0 - beside,
                first_m,
                near_m,
                pixel_rad,
                dither,
                phase,
                work,
                march,
            )
            if march[3] >= _OPAQUE:
                _march(
                    field,
                    lights,
                    d,
                    along,
                    1.0 - beside,
                    far_m,
                    end_m,
                    pixel_rad,
                    dither,
                    phase,
                    work,
                    march,
                )
        hidden = march[3] if march[3] < _OPAQUE else 0.0
        passed = march[3] - hidden
        through = passed ** (1.0 / lights.diffused)
        behind = lights.from_above if d[1] > 0.0 else lights.from_below
        for c in range(3):
            out[n, c] = march[c] / (1.0 - hidden) + (passed - through) * behind[c]
        out[n, 3] = through
        out[n, 4] = march[4] / march[5] if march[5] > 0.0 else 0.0

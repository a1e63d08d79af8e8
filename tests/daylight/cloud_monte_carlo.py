"""Sunlight in a cloud field by backward Monte Carlo: the truth for the clouds' light.

Delta tracking (Woodcock 1965) in the very density that is drawn, droplets' phase function by Mie's
theory, a black sky and a black ground. At each collision the sun is tried along one more tracked
path. What is diffracted within 10 degrees counts as not scattered (Potter 1970): its peak would be
all noise. So rays must not look closer to the sun.
"""

# numba knows the old generator alone.
# ruff: noqa: NPY002
import math

import numpy as np

from vrut_lite.daylight.aerosols.phase_table import node_cosines
from vrut_lite.daylight.cloud_density_kernels import compiled, density_at
from vrut_lite.daylight.cloud_transport import droplets

_PEAK_RAD = np.radians(10.0)


def sun_radiance(field, sun, origins, directions, paths, seed=1, density=density_at, phase=None):
    """Radiance (n,) of the clouds by a sun of irradiance 1, and its standard error (n,).

    Args:
        field: `Field` of the layer, whose eye is the origin of places.
        origins: (n, 3) relative to the eye's place, heights over the base, m; outside the layer or
            at its edge.
        directions: (n, 3).
        density: compiled, of a field, x, z, height and width, in place of the clouds'.
        phase: (nodes,), in place of the droplets'; nothing is cut off it.
    """
    phase, kept = without_peak() if phase is None else (phase, 1.0)
    field = field._replace(extinction_per_m=field.extinction_per_m * kept)
    angle = _angles(phase)
    out = np.empty((len(directions), 2))
    start = np.ascontiguousarray(origins, dtype=float)
    rays = np.ascontiguousarray(directions, dtype=float)
    towards = np.asarray(sun, dtype=float)
    _trace(density, field, towards, start, rays, paths, seed, angle, phase, out)
    return out[:, 0], out[:, 1]


def without_peak():
    """The phase function's table (nodes,) without its peak, and the share of light it scatters."""
    nu, whole = node_cosines(), droplets().values[1]
    cut = np.minimum(whole, whole[np.count_nonzero(nu > np.cos(_PEAK_RAD))])
    kept = -2.0 * np.pi * np.trapezoid(cut, nu)
    return cut / kept, kept


def _angles(phase):
    """Scattering angles' cosines at even steps of their distribution function."""
    nu = node_cosines()
    between = -0.5 * (phase[1:] + phase[:-1]) * np.diff(nu)
    whole = np.concatenate([[0.0], np.cumsum(between)])
    return np.interp(np.linspace(0.0, 1.0, 4097), whole / whole[-1], nu)


@compiled
def _phase(table, nu):
    place = math.sqrt(min(max(0.5 - 0.5 * nu, 0.0), 1.0)) * (table.shape[0] - 1)
    i = min(int(place), table.shape[0] - 2)
    return table[i] + (place - i) * (table[i + 1] - table[i])


@compiled
def _collide(density, field, p, d):
    """Move a point to its next collision; whether there is one before it leaves the layer."""
    k = field.extinction_per_m
    while True:
        t = -math.log(1.0 - np.random.random()) / k
        for c in range(3):
            p[c] += t * d[c]
        if not 0.0 <= p[1] <= field.thickness_m or abs(p[0]) + abs(p[2]) > 2e5:
            return False
        if np.random.random() < density(field, p[0], p[2], p[1], 0.0):
            return True


@compiled
def _turn(d, cosine, azimuth):
    """Turn a direction by an angle."""
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    c, s = math.cos(azimuth) * sine, math.sin(azimuth) * sine
    x, y, z = d[0], d[1], d[2]
    if abs(y) < 0.99:
        level = math.sqrt(x * x + z * z)
        ux, uy, uz = z / level, 0.0, -x / level
    else:
        level = math.sqrt(y * y + z * z)
        ux, uy, uz = 0.0, z / level, -y / level
    vx, vy, vz = y * uz - z * uy, z * ux - x * uz, x * uy - y * ux
    d[0] = cosine * x + c * ux + s * vx
    d[1] = cosine * y + c * uy + s * vy
    d[2] = cosine * z + c * uz + s * vz
    length = math.sqrt(d[0] ** 2 + d[1] ** 2 + d[2] ** 2)
    for i in range(3):
        d[i] /= length


@compiled
def _trace(density, field, sun, origins, directions, paths, seed, angle, phase, out):
    np.random.seed(seed)
    p, d, q = np.empty(3), np.empty(3), np.empty(3)
    for n in range(directions.shape[0]):
        total, squares = 0.0, 0.0
        for _ in range(paths):
            p[:] = origins[n]
            d[:] = directions[n]
            # To the layer.
            edge = 0.0 if p[1] < 0.0 else field.thickness_m
            if not 0.0 <= p[1] <= field.thickness_m:
                way = (edge - p[1]) / d[1]
                for c in range(3):
                    p[c] += way * d[c]
                p[1] = edge
            value = 0.0
            while _collide(density, field, p, d):
                q[:] = p
                if not _collide(density, field, q, sun) and q[1] > field.thickness_m:
                    value += _phase(phase, d[0] * sun[0] + d[1] * sun[1] + d[2] * sun[2])
                place = np.random.random() * (angle.size - 1)
                i = int(place)
                cosine = angle[i] + (place - i) * (angle[i + 1] - angle[i])
                _turn(d, cosine, 2.0 * math.pi * np.random.random())
            total += value
            squares += value * value
        mean = total / paths
        out[n, 0] = mean
        out[n, 1] = math.sqrt(max(squares / paths - mean * mean, 0.0) / paths)

"""Sunlight in a cloud field by backward Monte Carlo: the truth for the clouds' light.

Delta tracking (Woodcock 1965) in the very density that is drawn, droplets' phase function by Mie's
theory, a black sky and a black ground. At each collision the sun is tried along one more tracked
path. The forward peak that delta-M leaves out counts as not scattered (Potter 1970): it would be
all noise. So rays must not look closer than 6 degrees to the sun. Importing this module imports
numba.
"""

# numba knows the old generator alone.
# ruff: noqa: NPY002
import math
from typing import Any, NamedTuple

import numpy as np
from clouds.model.cloud_density_kernels import compiled, density_at
from clouds.model.cloud_transport import scatterer
from numpy.typing import ArrayLike

from vrut_lite.atmosphere.aerosols.phase_table import node_cosines
from vrut_lite.numeric_types import FloatArray


class TracedRays(NamedTuple):
    """What rays (n,) see by a sun of irradiance 1, sr^-1, and its standard error.

    `once` is the part (n,) of what was scattered once.
    """

    radiance: FloatArray
    error: FloatArray
    once: FloatArray


def sun_radiance(
    field: Any,
    sun: ArrayLike,
    origins: ArrayLike,
    directions: ArrayLike,
    paths: int,
    seed: int = 1,
    disc_rad: float = 0.0,
    density: Any = density_at,
    phase: FloatArray | None = None,
) -> TracedRays:
    """Light of the clouds along rays, by so many paths each.

    Args:
        field: `Field` of the layer, whose eye is the origin of places.
        sun: (3,) towards it.
        origins: (n, 3) relative to the eye's place, heights over the base, m; outside the layer or
            at its edge.
        directions: (n, 3).
        disc_rad: radius of the disc around each direction that its paths are spread over.
        density: compiled, of a field, x, z, height and width, in place of the clouds'.
        phase: (nodes,), in place of the droplets'; nothing is cut off it.
    """
    phase, kept = without_peak() if phase is None else (phase, 1.0)
    field = field._replace(extinction_per_m=field.extinction_per_m * kept)
    angle = _angles(phase)
    start = np.ascontiguousarray(origins, dtype=float)
    rays = np.ascontiguousarray(directions, dtype=float)
    out = np.empty((len(rays), 3))
    towards = np.asarray(sun, dtype=float)
    _trace(density, field, towards, start, rays, disc_rad, paths, seed, angle, phase, out)
    return TracedRays(*out.T)


def without_peak() -> tuple[FloatArray, float]:
    """The phase function's table (nodes,) without its peak, and the share of light it scatters."""
    droplets = scatterer("droplets")
    return np.ascontiguousarray(droplets.phase[0, :, 1] / droplets.diffused), droplets.diffused


def _angles(phase: FloatArray) -> FloatArray:
    """Scattering angles' cosines at even steps of their distribution function."""
    nu = node_cosines()
    between = -0.5 * (phase[1:] + phase[:-1]) * np.diff(nu)
    whole = np.concatenate([[0.0], np.cumsum(between)])
    return np.interp(np.linspace(0.0, 1.0, 4097), whole / whole[-1], nu)


@compiled
def _phase(table, nu):  # type: ignore[no-untyped-def]
    place = math.sqrt(min(max(0.5 - 0.5 * nu, 0.0), 1.0)) * (table.shape[0] - 1)
    i = min(int(place), table.shape[0] - 2)
    return table[i] + (place - i) * (table[i + 1] - table[i])


@compiled
def _collide(density, field, p, d):  # type: ignore[no-untyped-def]
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
def _turn(d, cosine, azimuth):  # type: ignore[no-untyped-def]
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
def _trace(density, field, sun, origins, directions, disc_rad, paths, seed, angle, phase, out):  # type: ignore[no-untyped-def]
    np.random.seed(seed)
    p, d, q = np.empty(3), np.empty(3), np.empty(3)
    for n in range(directions.shape[0]):
        total, squares, once = 0.0, 0.0, 0.0
        for _ in range(paths):
            p[:] = origins[n]
            d[:] = directions[n]
            if disc_rad > 0.0:
                off = disc_rad * math.sqrt(np.random.random())
                _turn(d, math.cos(off), 2.0 * math.pi * np.random.random())
            # To the layer.
            edge = 0.0 if p[1] < 0.0 else field.thickness_m
            if not 0.0 <= p[1] <= field.thickness_m:
                way = (edge - p[1]) / d[1]
                for c in range(3):
                    p[c] += way * d[c]
                p[1] = edge
            value, order = 0.0, 0
            while _collide(density, field, p, d):
                q[:] = p
                if not _collide(density, field, q, sun) and q[1] > field.thickness_m:
                    sent = _phase(phase, d[0] * sun[0] + d[1] * sun[1] + d[2] * sun[2])
                    value += sent
                    once += sent if order == 0 else 0.0
                order += 1
                place = np.random.random() * (angle.size - 1)
                i = int(place)
                cosine = angle[i] + (place - i) * (angle[i + 1] - angle[i])
                _turn(d, cosine, 2.0 * math.pi * np.random.random())
            total += value
            squares += value * value
        mean = total / paths
        out[n, 0] = mean
        out[n, 1] = math.sqrt(max(squares / paths - mean * mean, 0.0) / paths)
        out[n, 2] = once / paths

"""The loops over pairs of Haber's cells, compiled.

Points are tuples in m from the planet's centre. The air is 50 layers of even density, told by
the radii of their bounds (51,) and relative densities (2, 50) of molecules and aerosol.

Importing this module imports numba.
"""

import math

import numpy as np

from vrut_lite.njit import njit

compiled = njit(cache=True, error_model="numpy")


@compiled
def layered_paths(start, end, bounds, density):  # type: ignore[no-untyped-def]
    """Optical paths (2, n) in m between points (n, 3); the molecules' is infinite underground."""
    paths = np.empty((2, len(start)))
    for i in range(len(start)):
        one, other = start[i], end[i]
        paths[0, i], paths[1, i] = _path(
            (one[0], one[1], one[2]), (other[0], other[1], other[2]), bounds, density
        )
    return paths


@compiled
def ring_paths(across, up, turn, bounds, density):  # type: ignore[no-untyped-def]
    """Optical paths (2, n, n, turns) between cells of n rings, that many turns apart.

    `across` and `up` (n,) are the rings' radius and height, `turn` (turns,) angles.
    """
    n = across.size
    paths = np.empty((2, n, n, turn.size), np.float32)
    for a in range(n):
        start = across[a], 0.0, up[a]
        for b in range(a + 1):
            for t in range(turn.size):
                end = across[b] * math.cos(turn[t]), across[b] * math.sin(turn[t]), up[b]
                molecules, aerosol = _path(start, end, bounds, density)
                paths[0, a, b, t] = paths[0, b, a, t] = molecules
                paths[1, a, b, t] = paths[1, b, a, t] = aerosol
    return paths


@compiled
def _path(start, end, bounds, density):  # type: ignore[no-untyped-def]
    from_radius, to_radius = _length(start), _length(end)
    way = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    length = _length(way)
    if length == 0.0:
        return 0.0, 0.0
    along = (start[0] * way[0] + start[1] * way[1] + start[2] * way[2]) / length
    perigee_squared = from_radius * from_radius - along * along
    if -length < along < 0.0:
        perigee = math.sqrt(perigee_squared)
        if perigee <= bounds[0]:
            return np.inf, 0.0
        down = _ascent(perigee_squared, perigee, from_radius, bounds, density)
        ascent = _ascent(perigee_squared, perigee, to_radius, bounds, density)
        return down[0] + ascent[0], down[1] + ascent[1]
    low, high = min(from_radius, to_radius), max(from_radius, to_radius)
    return _ascent(perigee_squared, low, high, bounds, density)


@compiled
def _ascent(perigee_squared, low, high, bounds, density):  # type: ignore[no-untyped-def]
    """Optical paths of an ascent from one radius to another."""
    molecules = aerosol = 0.0
    layer = _layer(low, bounds)
    before = math.sqrt(max(low * low - perigee_squared, 0.0))
    last = density.shape[1] - 1
    while True:
        ends = layer == last or bounds[layer + 1] >= high
        radius = high if ends else bounds[layer + 1]
        distance = math.sqrt(max(radius * radius - perigee_squared, 0.0))
        molecules += density[0, layer] * (distance - before)
        aerosol += density[1, layer] * (distance - before)
        if ends:
            return molecules, aerosol
        before = distance
        layer += 1


@compiled
def _layer(radius, bounds):  # type: ignore[no-untyped-def]
    """The layer that holds a radius; the lowest and the highest hold all beyond them."""
    low, high = 0, bounds.size - 2
    while low < high:
        middle = (low + high + 1) // 2
        if bounds[middle] <= radius:
            low = middle
        else:
            high = middle - 1
    return low


@compiled
def _length(vector):  # type: ignore[no-untyped-def]
    return math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])


@compiled
def from_aerosol(across, up, sources, power, paths, extinction, sun, phase, cosines, sines):  # type: ignore[no-untyped-def]
    """Irradiance (n, C, 36) of cells by sunlight that aerosol scatters after its phase function.

    Args:
        across, up: radius and height (n,) of the rings.
        sources: numbers (k,) of those rings that have aerosol.
        power: that they scatter (k, C, 108): by azimuth, and from azimuth 0 on once more.
        paths: of `ring_paths`, for turns of 0 to half the circle.
        extinction: (2, C) of molecules and aerosol.
        sun: sine and cosine of its zenith angle.
        phase: Cornette and Shanks' function as factor, (1 - g)^2 and 2 g.
        cosines, sines: (36,) of the cells' azimuths.

    All but `across`, `up` and `sun` in float32: with one float64 among them it takes twice as
    long.
    """
    half, count = cosines.size, extinction.shape[1]
    arriving = np.zeros((across.size, count, half), np.float32)
    scattered, weight = np.empty(half, np.float32), np.empty(count, np.float32)
    for a in range(across.size):
        for k in range(sources.size):
            b = sources[k]
            for turns in range(half + 1):
                if paths[0, a, b, turns] == np.inf or (a == b and turns == 0):
                    continue
                angle = turns * math.pi / half
                x = across[b] * math.cos(angle) - across[a]
                y, z = across[b] * math.sin(angle), up[b] - up[a]
                squared = x * x + y * y + z * z
                share = np.float32(1.0 / squared)
                for c in range(count):
                    depth = extinction[0, c] * paths[0, a, b, turns]
                    depth += extinction[1, c] * paths[1, a, b, turns]
                    weight[c] = math.exp(-depth) * share
                scale = sun[0] / math.sqrt(squared)
                upright = z * sun[1] / math.sqrt(squared)
                for side in range(1 if turns == 0 or turns == half else 2):
                    across_y = y * scale if side == 0 else -y * scale
                    _scatter(cosines, sines, x * scale, across_y, upright, phase, scattered)
                    first = turns if side == 0 else 2 * half - turns
                    for c in range(count):
                        # Slices: an index that might be negative keeps the loop from SIMD.
                        sent, here = power[k, c, first : first + half], arriving[a, c]
                        for j in range(half):
                            here[j] += weight[c] * scattered[j] * sent[j]
    return arriving


@compiled
def _scatter(cosines, sines, x, y, upright, phase, scattered):  # type: ignore[no-untyped-def]
    """Set the phase function (36,) for light from (x, y) and above, turned to each azimuth."""
    factor, least, steep = phase
    one = np.float32(1.0)
    level_x, level_y, level_z = np.float32(x), np.float32(y), np.float32(upright)
    for j in range(cosines.size):
        nu = cosines[j] * level_x - sines[j] * level_y + level_z
        spread = least + steep * (one - nu)
        scattered[j] = factor * (one + nu * nu) / (spread * np.sqrt(spread))

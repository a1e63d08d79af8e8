"""Groups of triangles, each projected onto the plane that it faces.

Coordinates are whole multiples of 2^-10 of a texel. They stay exact in float32 in a map of any size
that a GPU takes, and which triangle a texel's middle lies in is decided without rounding.
"""

import numpy as np

from light_transport.kernels import cross, dot, kernel

STEPS_PER_PX = 1024.0
# A look-up this far beside a chart, in texels, still finds the chart's own texels: GPUs round
# coordinates of a look-up to 1/256 of a texel.
MARGIN_PX = 1.0 / 16.0
# Turns that are tried for the smallest rectangle, beside that along the longest border.
_TURNS = 15


@kernel
def projected(group, direction, corners, opposite):  # type: ignore[no-untyped-def]
    """Places (F, 3, 2) of corners in their group's plane, and their heights (F, 3) above it.

    Groups are turned to fill a lying rectangle best; its size (G, 2) comes third.

    Args:
        group, direction: see `facing_groups.Groups`.
        corners: (F, 3, 3), in texels.
        opposite: see `welding.opposite_edges`.
    """
    groups = len(direction)
    axes = np.empty((groups, 2, 3))
    for g in range(groups):
        n, u, v = direction[g], axes[g, 0], axes[g, 1]
        seldom = 0
        for k in range(3):
            if abs(n[k]) < abs(n[seldom]):
                seldom = k
        for k in range(3):
            v[k] = 1.0 if k == seldom else 0.0
        cross(v, n, u)
        length = np.sqrt(dot(u, u))
        for k in range(3):
            u[k] /= length
        cross(n, u, v)
    uv, heights = np.empty((len(group), 3, 2)), np.empty((len(group), 3))
    longest = np.zeros(groups)
    # The directions that are tried, the first of them along the longest border.
    turn = np.zeros((groups, 1 + _TURNS, 2))
    for g in range(groups):
        turn[g, 0, 0] = 1.0
        for k in range(1, 1 + _TURNS):
            turn[g, k, 0] = np.cos(0.5 * np.pi * (k - 1) / _TURNS)
            turn[g, k, 1] = np.sin(0.5 * np.pi * (k - 1) / _TURNS)
    for f in range(len(group)):
        g = group[f]
        for k in range(3):
            uv[f, k, 0] = dot(corners[f, k], axes[g, 0])
            uv[f, k, 1] = dot(corners[f, k], axes[g, 1])
            heights[f, k] = dot(corners[f, k], direction[g])
        for e in range(3):
            if opposite[f, e] < 0 or group[opposite[f, e] // 3] != g:
                du = uv[f, (e + 1) % 3, 0] - uv[f, e, 0]
                dv = uv[f, (e + 1) % 3, 1] - uv[f, e, 1]
                length = np.sqrt(du * du + dv * dv)
                # Among equal ones the first, whatever the last digit.
                if length > 1.000001 * longest[g]:
                    longest[g] = length
                    turn[g, 0, 0], turn[g, 0, 1] = du / length, dv / length
    lower = np.full((groups, 1 + _TURNS, 2), np.inf)
    upper = np.full((groups, 1 + _TURNS, 2), -np.inf)
    for f in range(len(group)):
        g = group[f]
        for c in range(3):
            for k in range(1 + _TURNS):
                a, b = turn[g, k, 0], turn[g, k, 1]
                s, t = a * uv[f, c, 0] + b * uv[f, c, 1], a * uv[f, c, 1] - b * uv[f, c, 0]
                lower[g, k, 0], lower[g, k, 1] = min(lower[g, k, 0], s), min(lower[g, k, 1], t)
                upper[g, k, 0], upper[g, k, 1] = max(upper[g, k, 0], s), max(upper[g, k, 1], t)
    best = np.zeros(groups, np.int64)
    sizes = np.empty((groups, 2), np.int64)
    lies = np.empty(groups, np.bool_)
    for g in range(groups):
        least = np.inf
        for k in range(1 + _TURNS):
            wide, high = upper[g, k, 0] - lower[g, k, 0], upper[g, k, 1] - lower[g, k, 1]
            area = (wide + 1.0) * (high + 1.0)
            if area < 0.98 * least:
                best[g], least = k, area
        k = best[g]
        lies[g] = upper[g, k, 0] - lower[g, k, 0] >= upper[g, k, 1] - lower[g, k, 1]
    for f in range(len(group)):
        g = group[f]
        k = best[g]
        a, b = turn[g, k, 0], turn[g, k, 1]
        for c in range(3):
            s = a * uv[f, c, 0] + b * uv[f, c, 1] - lower[g, k, 0]
            t = a * uv[f, c, 1] - b * uv[f, c, 0] - lower[g, k, 1]
            if not lies[g]:
                s, t = upper[g, k, 1] - lower[g, k, 1] - t, s
            uv[f, c, 0], uv[f, c, 1] = s, t
    for g in range(groups):
        k = best[g]
        wide, high = upper[g, k, 0] - lower[g, k, 0], upper[g, k, 1] - lower[g, k, 1]
        if not lies[g]:
            wide, high = high, wide
        sizes[g, 0] = int(np.ceil(wide + 2.0 * MARGIN_PX)) + 1
        sizes[g, 1] = int(np.ceil(high + 2.0 * MARGIN_PX)) + 1
        # In the middle of what whole texels leave.
        lower[g, 0, 0] = 0.5 * (sizes[g, 0] - wide)
        lower[g, 0, 1] = 0.5 * (sizes[g, 1] - high)
    for f in range(len(group)):
        for c in range(3):
            for k in range(2):
                at = uv[f, c, k] + lower[group[f], 0, k]
                uv[f, c, k] = np.round(at * STEPS_PER_PX) / STEPS_PER_PX
    return uv, heights, sizes

"""Sums the light that rows of the table receive from their columns: the sky's nodes, then patches.

What patches get of the sky is a mean of what their rows get: so rows come first, the bounces
between patches next, and what they bring to rows last. Each entry of the table is read once.
"""

import numpy as np

from light_transport.hour.simd_gather import counted_sums
from light_transport.kernels import hot


@hot
def sky_gathered(table, light, first, last, out):  # type: ignore[no-untyped-def]
    """Fill out[first:last] (N, 4): means over each row's rays of light (columns, 4) of nodes."""
    start, entry = table.start, table.entry
    for i in range(first, last):
        end = start[i] + np.int64(table.nodes[i])
        r, g, b, a = counted_sums(light, entry, start[i], end)
        scale = np.float32(1.0) / np.float32(max(table.valid[i], 1))
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = r * scale, g * scale, b * scale, a * scale


@hot
def patches_gathered(table, light, first, last, out):  # type: ignore[no-untyped-def]
    """Add to out[first:last] (N, 4) what the other columns of light (columns, 4) bring."""
    start, entry = table.start, table.entry
    for i in range(first, last):
        begin = start[i] + np.int64(table.nodes[i])
        r, g, b, a = counted_sums(light, entry, begin, start[i + 1])
        scale = np.float32(1.0) / np.float32(max(table.valid[i], 1))
        out[i, 0] += r * scale
        out[i, 1] += g * scale
        out[i, 2] += b * scale
        out[i, 3] += a * scale

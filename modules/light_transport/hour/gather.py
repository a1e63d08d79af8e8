"""Light of the table's rows, gathered from an hour's light of its columns."""

import numpy as np

from light_transport.hour.four_sums import four_sums
from light_transport.kernels import hot


@hot
def gathered(table, light, first, last, out):  # type: ignore[no-untyped-def]
    """Fill out[first:last] (N, 4): means over each row's rays of light (columns, 4)."""
    start, column, rays = table.start, table.column, table.rays
    for i in range(first, last):
        r, g, b, a = four_sums(light, column, rays, start[i], start[i + 1])
        scale = np.float32(1.0) / np.float32(max(table.valid[i], 1))
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = r * scale, g * scale, b * scale, a * scale

"""What rows of the table get by an hour's light of its columns."""

import numpy as np

from light_transport.kernels import hot


@hot
def gathered(table, light, first, last, out):  # type: ignore[no-untyped-def]
    """Fill out[first:last] (N, 4): means over each row's rays of light (columns, 4)."""
    for i in range(first, last):
        r, g = np.float32(0.0), np.float32(0.0)
        b, a = np.float32(0.0), np.float32(0.0)
        for e in range(table.start[i], table.start[i + 1]):
            c, n = table.column[e], np.float32(table.rays[e])
            r += n * light[c, 0]
            g += n * light[c, 1]
            b += n * light[c, 2]
            a += n * light[c, 3]
        scale = np.float32(1.0) / np.float32(max(table.valid[i], 1))
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = r * scale, g * scale, b * scale, a * scale

"""What one observer sees under one sun, as a table by direction, and its cube map.

In reading order: `rays` says where the table looks, `table` what it holds (filled by
`table_kernels`), `cube_kernels` and `gpu` lay it onto a cube map.
"""

from bruneton_sky.sky_view.table import (
    STANDING_M,
    GroundColours,
    SkyView,
    fill_cube,
    level_direction,
    light_view,
    limb_counts,
    sky_view,
    standing_m,
    table_counts,
)

__all__ = [
    "STANDING_M",
    "GroundColours",
    "SkyView",
    "fill_cube",
    "level_direction",
    "light_view",
    "limb_counts",
    "sky_view",
    "standing_m",
    "table_counts",
]

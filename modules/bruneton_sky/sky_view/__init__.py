"""The sky of one observer under one sun as a table by direction, and its cube map.

In reading order: `rays` has the table's directions, `table` its values (filled by
`table_kernels`), `cube_kernels` and `gpu` resample it to a cube map. `table_on_card` makes
both on a graphics card.
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

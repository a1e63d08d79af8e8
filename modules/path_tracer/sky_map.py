"""The sky's cube map as mitsuba's environment map, in linear radiance.

In `envmap` column j looks to azimuth 2 pi (j + 1/2) / width, clockwise from -Z seen from above
(its local frame has +Y up, as ours), and row i to the angle pi i / (height - 1) from the zenith:
poles lie on rows. Rows are even in number, so that none lies in the horizon and either side of
it keeps its own values to within half a row.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.sky import BackgroundChanged, SkyRadianceChanged

# Rows for each texel of a cube face's edge: a row is then no wider than half the smallest texel.
_ROWS_A_TEXEL = 4
_FEWEST_ROWS, _MOST_ROWS = 64, 2048


def radiance_cube(sky: BackgroundChanged | SkyRadianceChanged) -> NDArray[np.float32]:
    """The cube map (6, n, n, 3) in W m^-2 sr^-1.

    Raises:
        ValueError: it is a texture that never left the GPU.
    """
    if isinstance(sky.cube, GpuTexture):
        raise ValueError("the path tracer needs the sky as an array: demand it as float16")
    values = np.asarray(sky.cube.values)
    return decode_float16(values, sky.radiance_scale)


def map_directions(rows: int) -> NDArray[np.float64]:
    """World directions (rows, 2 rows, 3) of the environment map's nodes."""
    azimuth = (np.arange(2 * rows) + 0.5) * (np.pi / rows)
    elevation = (0.5 - np.arange(rows) / (rows - 1)) * np.pi
    return world_from_enu(direction_from_angles(azimuth[None, :], elevation[:, None]))


def environment_map(cube: NDArray[np.floating]) -> NDArray[np.float32]:
    """The environment map (h, 2 h, 3) of a cube map (6, n, n, 3), as the GL frame looks it up."""
    rows = int(np.clip(_ROWS_A_TEXEL * cube.shape[1], _FEWEST_ROWS, _MOST_ROWS))
    return sample_sky(cube, map_directions(rows)).astype(np.float32)


def sky_emitter(mitsuba: Any, cube: NDArray[np.floating]) -> dict[str, Any]:
    """The emitter, as a dictionary of mitsuba, of a cube map that is not all black."""
    return {"type": "envmap", "bitmap": mitsuba.Bitmap(environment_map(cube))}


def darkness() -> dict[str, Any]:
    """An environment that gives no light: without any, mitsuba shows nothing where a ray ends."""
    black = {"type": "rgb", "value": [0.0, 0.0, 0.0]}
    return {"type": "constant", "radiance": black, "sampling_weight": 0.0}

"""The light of the air before surfaces by the sun's height, and the air's extinction.

Air between an eye and a near point adds a mean radiance times what it takes from the point
(`vrut_lite/sky/air_volume.py`). The mean depends on the direction and hardly on the distance; it
is taken half a scene away. Layers and columns are those of the sky's table, and so are the rows
above the horizon; `BELOW` rows from the nadir to the horizon go before them, at the heights
-pi/2 (1 - t)^2 for t in [0, 1]. The twin is `page/src/shaders.js`.
"""

from dataclasses import dataclass

import numpy as np

from share.shared_scene import SunSky
from share.sky_table import SkyTable, table_directions
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.air_volume import look_up_air

BELOW = 8
# Number of heights of view at which extinction is kept: sin(pi/2 t |t|) for t in [-1, 1].
VIEWS = 33
_HALF_PI = 0.5 * np.pi


@dataclass(frozen=True, eq=False)
class AirTable:
    """Light and extinction of air; linear sRGB.

    Attributes:
        radiance: (H, BELOW + LOWER + UPPER, COLUMNS, 4) float16, mean radiance as a share of the
            sky table's level, sr^-1; last the share of its luminance that is sunlight scattered
            once, which a scene may shade.
        optical_depth: (VIEWS, 3) float16, along `scene_m`, by the height of the view.
    """

    radiance: np.ndarray
    optical_depth: np.ndarray


def air_table(skies: list[SunSky], table: SkyTable, scene_m: float) -> AirTable:
    """The air of skies by rising height, those of `table`; none where they make no air."""
    views = np.linspace(-1.0, 1.0, VIEWS)
    height = _HALF_PI * views * np.abs(views)
    level = np.stack([np.zeros(VIEWS), np.sin(height), -np.cos(height)], axis=-1)
    depth, radiance = np.zeros((VIEWS, 3)), []
    for sky, scale in zip(skies, table.level_rgb, strict=True):
        directions = _directions(max(sky.apparent_rad, 0.0), sky.azimuth_rad)
        if sky.air is None:
            radiance.append(np.zeros((*directions.shape[:-1], 4)))
            continue
        near_m = np.full(directions.shape[:-1], 0.5 * scene_m)
        found = look_up_air(sky.air, directions, near_m)
        taken = np.maximum(1.0 - found.transmittance, 1e-12)
        whole = found.shaded + found.sunlit
        sunlit = luminance(found.sunlit) / np.maximum(luminance(whole), 1e-30)
        radiance.append(np.concatenate([whole / taken / scale, sunlit[..., None]], axis=-1))
        # The air's matter is the same at all hours.
        left = look_up_air(sky.air, level, np.full(VIEWS, 0.5 * scene_m)).transmittance
        depth = -2.0 * np.log(left)
    return AirTable(np.stack(radiance).astype(np.float16), depth.astype(np.float16))


def _directions(sun_rad: float, sun_azimuth_rad: float) -> FloatArray:
    """Unit directions (rows, columns, 3) of the nodes."""
    above = table_directions(sun_rad, sun_azimuth_rad)
    height = -_HALF_PI * (1.0 - np.linspace(0.0, 1.0, BELOW)) ** 2
    # The horizon's row has the azimuths.
    below = above[:1] * np.cos(height)[:, None, None]
    below[..., 1] = np.sin(height)[:, None]
    return np.concatenate([below, above])

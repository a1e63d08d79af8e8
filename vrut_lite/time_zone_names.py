"""Names of time zones by coordinates, the first one that a session asks for kept on disk.

tzfpy's map takes 0.07 s to load, and most sessions ask for one place.
"""

from functools import lru_cache
from importlib.metadata import version

import numpy as np
import tzfpy

from vrut_lite.array_cache import ArrayCache

# A name takes 300 bytes.
_LIMIT_BYTES = 1 << 18


@lru_cache(maxsize=64)
def zone_name(longitude_deg: float, latitude_deg: float) -> str:
    """The zone's name, empty where the map has none."""
    # Later ones in a session find the map loaded.
    if zone_name.cache_info().currsize:
        return tzfpy.get_tz(longitude_deg, latitude_deg)
    recipe = version("tzfpy"), longitude_deg, latitude_deg
    names = ArrayCache.of_user("time_zones", _LIMIT_BYTES, warns=False)
    kept = names.get(recipe)
    if kept is not None:
        return kept["name"].tobytes().decode()
    name = tzfpy.get_tz(longitude_deg, latitude_deg)
    names.put(recipe, {"name": np.frombuffer(name.encode(), np.uint8)})
    return name

"""Rays kept on disk: a scene that is opened again has its light at once.

A table of rays follows from where triangles lie and how map and patches are laid out: neither
colours nor the hour are in it. It is kept after each round, under a digest of these, of the numbers
of rays (those of the first round decide on the patches) and of this package's own code. So a round
gives the same table whether it was kept or not, and a replay the same messages.
"""

from collections.abc import Callable

import numpy as np

from light_transport.bake import Bake
from light_transport.digests import code_digest
from light_transport.rays.ray_table import Rows
from vrut_lite.array_cache import ArrayCache

# A scene's rounds together take some 100 MB.
_LIMIT_BYTES = 2 << 30
# The files that decide where rays begin and end, and which patches they end on.
_CODE = ("bake.py", "ray_scene.py", "row_numbers.py", "surfaces/*.py", "layout/*.py", "rays/*.py")


def add_kept_rays(bake: Bake, count: int, is_cancelled: Callable[[], bool]) -> bool:
    """As `Bake.add_rays`, but kept rays are read instead of traced."""
    cache = ArrayCache.of_user("light_maps", _LIMIT_BYTES)
    rays = bake.first_rays or count, bake.rays + count
    recipe = (code_digest(_CODE), bake.geometry_digest, bake.patch_texels, *rays)
    arrays = cache.get(recipe)
    if arrays is not None and _fits(arrays, bake):
        bake.take_rays(Rows(0, **arrays), count)
        return True
    if not bake.add_rays(count, is_cancelled):
        return False
    kept = bake.table._asdict()
    del kept["first"]
    cache.put(recipe, kept)
    return True


def _fits(arrays: dict[str, np.ndarray], bake: Bake) -> bool:
    names = {name for name in Rows._fields if name != "first"}
    return arrays.keys() == names and len(arrays["start"]) == bake.rows + 1

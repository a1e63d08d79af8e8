"""Rays kept on disk: a scene that is opened again has its light at once.

A table of rays follows from where triangles lie and how map and patches are laid out: neither
colours nor the hour are in it. It is kept after each round, under a digest of these, of the numbers
of rays (those of the first round decide on the patches) and of this package's own code. So a round
gives the same table whether it was kept or not, and a replay the same messages.
"""

import hashlib
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import numpy as np

from light_transport.bake import Bake
from light_transport.rays.ray_table import Rows
from vrut_lite.array_cache import ArrayCache

# A scene's rounds together take some 100 MB.
_LIMIT_BYTES = 2 << 30


def add_kept_rays(bake: Bake, count: int, is_cancelled: Callable[[], bool]) -> bool:
    """As `Bake.add_rays`, but kept rays are read instead of traced."""
    cache = ArrayCache.of_user("light_maps", _LIMIT_BYTES)
    rays = bake.first_rays or count, bake.rays + count
    recipe = (_code_digest(), bake.geometry_digest, bake.patch_texels, *rays)
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


@lru_cache(maxsize=1)
def _code_digest() -> str:
    """Of the files that decide where rays begin and end, and which patches they end on."""
    digest = hashlib.blake2b(digest_size=16)
    package = Path(__file__).parent
    packages = ("surfaces/*.py", "layout/*.py", "rays/*.py")
    for pattern in ("bake.py", "ray_scene.py", "row_numbers.py", *packages):
        for path in sorted(package.glob(pattern)):
            digest.update(path.read_bytes())
    return digest.hexdigest()

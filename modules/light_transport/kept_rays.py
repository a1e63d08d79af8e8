"""Rays kept on disk: a scene that is opened again has its light at once.

A table of rays follows from where triangles lie and how map and patches are laid out: neither
colours nor the hour are in it. It is kept after each round, under a digest of these, of the number
of rays and of this package's own code. So a round gives the same table whether it was kept or not,
and a replay the same messages.
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
    recipe = (_code_digest(), _geometry_digest(bake), bake.patch_texels, bake.rays + count)
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


def _geometry_digest(bake: Bake) -> str:
    """Digest of all surfaces that rays meet and begin at."""
    surfaces, digest = bake.surfaces, hashlib.blake2b(digest_size=16)
    receivers = bake.receivers
    for array in (
        surfaces.corners_m,
        surfaces.opacity,
        *receivers.geometry,
        receivers.texels.pixel,
        *receivers.probes,
        *receivers.groups,
    ):
        digest.update(f"{array.dtype.str}{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
    return digest.hexdigest()


@lru_cache(maxsize=1)
def _code_digest() -> str:
    """Digest of the files that decide where rays begin and end."""
    digest = hashlib.blake2b(digest_size=16)
    for folder in ("surfaces", "layout", "rays"):
        for path in sorted((Path(__file__).parent / folder).glob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()

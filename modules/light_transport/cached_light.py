"""Light of stills kept on disk: a picture that is rendered again has its light at once.

So has one with another exposure or in another file, and a window that opens where it was closed.
Light follows from the scene, colours included, from the sizes of map and patches, the rays, the
hour and the view, and from this package's own code: all of them are in its recipe.
"""

from collections.abc import Callable

import numpy as np

from light_transport.cached_layout import BakeRecipe
from light_transport.digests import digest_of
from light_transport.hour.illumination import Illumination
from vrut_lite.array_cache import ArrayCache, Arrays

# A map's and a view's together take some 10 MB.
_LIMIT_BYTES = 1 << 28


def kept_light(
    bake: BakeRecipe, hour: Illumination, view: tuple[object, ...], make: Callable[[], Arrays]
) -> Arrays:
    """What `make` makes of these, or made in another session; `view` is all else that it needs."""
    recipe = (*bake, digest_of(map(np.asarray, vars(hour).values())), view)
    cache = ArrayCache.of_user("still_light", _LIMIT_BYTES)
    kept = cache.get(recipe)
    if kept is not None:
        return kept
    made = make()
    cache.put(recipe, made)
    return made

"""Layouts kept on disk, and what is told of rounds: a still whose light is kept needs no bake."""

from typing import NamedTuple

import numpy as np

from light_transport.digests import code_digest
from light_transport.struct_arrays import arrays_of, struct_of
from vrut_lite.array_cache import ArrayCache
from vrut_lite.messages.light_map import LightMapLaid
from vrut_lite.messages.scene import SceneOpened

# A scene takes some MB.
_LIMIT_BYTES = 1 << 28
# All that light follows from.
CODE = ("*.py", "surfaces/*.py", "layout/*.py", "rays/*.py", "hour/*.py")


class BakeRecipe(NamedTuple):
    """What a bake follows from: a scene and sizes, the rays of the first round, and all rays."""

    scene: str
    first_rays: int
    rays: int


class RoundNumbers(NamedTuple):
    """What is told of a bake: its texels, and the memory of its arrays."""

    texels: int
    table_bytes: int


def scene_key(scene: SceneOpened, plan: tuple[object, ...]) -> str:
    """Of all that a bake follows from, but for the numbers of rays; `plan` has its sizes."""
    bounds_m = scene.lower_m, scene.upper_m
    return repr((code_digest(CODE), scene.content_key, scene.ground, bounds_m, plan))


def kept_layout(key: str) -> tuple[LightMapLaid, int] | None:
    """The layout of a scene that was laid out in another session, and the rows of its bake."""
    arrays = _cache().get(key)
    return None if arrays is None else (struct_of(LightMapLaid, arrays), int(arrays["rows"]))


def keep_layout(key: str, message: LightMapLaid, rows: int) -> None:
    """Keep a layout and the number of rows."""
    _cache().put(key, {**dict(arrays_of(message)), "rows": np.array(rows)})


def kept_round(recipe: BakeRecipe) -> RoundNumbers | None:
    """The numbers of a bake of another session."""
    arrays = _cache().get(tuple(recipe))
    return None if arrays is None else RoundNumbers(*map(int, arrays["numbers"]))


def keep_round(recipe: BakeRecipe, numbers: RoundNumbers) -> None:
    """Keep the numbers of a bake."""
    _cache().put(tuple(recipe), {"numbers": np.array(numbers)})


def _cache() -> ArrayCache:
    return ArrayCache.of_user("layouts", _LIMIT_BYTES)

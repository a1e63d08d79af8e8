"""Layouts, cut texels, rays and light kept on disk, and the keys under which they are.

A scene that is opened again has its light at once, and so has a picture that is rendered again with
another exposure or in another file. A table of rays follows from triangles, map and patches alone,
neither from colours nor from the hour; it is kept after each round, under the numbers of rays of
the first round, which decide on the patches, and of all. So a round gives the same table whether it
was kept or not, and a replay the same messages. Light also follows from colours, hour and view. All
keys have a digest of this package's own code.
"""

import hashlib
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

import msgspec
import numpy as np
from numpy.typing import NDArray

from light_transport.hour.illumination import Illumination
from light_transport.rays.map_texels import CELLS, MapGeometry, Texels
from light_transport.rays.ray_table import RayRows
from light_transport.rays.split_texels import OverRows, split_texels
from light_transport.rays.tree import Tree
from vrut_lite.array import Array
from vrut_lite.array_cache import ArrayCache, Arrays
from vrut_lite.messages.light_map import LightMapLaid
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import BoolArray

S = TypeVar("S", bound=msgspec.Struct)
# Limits of the four folders. A scene has 10 MB of cut texels, a few MB of layouts, 10 MB of light
# of a map and a view, and 100 MB of rays of all rounds.
_CUTS_BYTES = _LAYOUTS_BYTES = _LIGHT_BYTES = 1 << 28
_RAYS_BYTES = 2 << 30
# Files of code that the ends of rays follow from, and those of all light.
_RAYS_CODE = ("kernels.py", "transport.py", "surfaces/*.py", "layout/*.py", "rays/*.py")
_LIGHT_CODE = ("*.py", "surfaces/*.py", "layout/*.py", "rays/*.py", "hour/*.py", "view/*.py")

# The light of the hour need not wait for a digest of 50 MB and the disk.
_writer = ThreadPoolExecutor(1, "vrut-lite kept rays")


def digest_of(arrays: Iterable[NDArray]) -> str:
    """Digest of element types, shapes and bytes."""
    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        digest.update(f"{array.dtype.str}{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
    return digest.hexdigest()


@lru_cache
def code_digest(patterns: tuple[str, ...]) -> str:
    """Digest of the files of the package that match, in order."""
    digest = hashlib.blake2b(digest_size=16)
    for pattern in patterns:
        for path in sorted(Path(__file__).parent.glob(pattern)):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _arrays_of(value: msgspec.Struct, before: str = "") -> Iterator[tuple[str, NDArray[Any]]]:
    """The fields of a structure that holds arrays, numbers, texts, rows of numbers, structures of
    these, or None, by `before` and their name."""
    for name in value.__struct_fields__:
        field = getattr(value, name)
        if isinstance(field, msgspec.Struct):
            yield from _arrays_of(field, f"{before}{name}.")
        elif isinstance(field, Array):
            yield before + name, field.values
        elif isinstance(field, str):
            yield before + name, np.frombuffer(field.encode(), np.uint8)
        elif field is not None:
            yield before + name, np.asarray(field)


def _struct_of(kind: type[S], arrays: dict[str, NDArray[Any]], before: str = "") -> S:
    """The structure whose `_arrays_of` these are."""
    hints = get_type_hints(kind)
    fields = {name: _field(hints[name], arrays, before + name) for name in kind.__struct_fields__}
    return kind(**fields)


def _field(hint: Any, arrays: dict[str, NDArray[Any]], name: str) -> Any:
    kinds = [kind for kind in get_args(hint) if isinstance(kind, type)]
    kind = kinds[0] if type(None) in kinds else hint
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        inside = f"{name}."
        there = any(other.startswith(inside) for other in arrays)
        return _struct_of(kind, arrays, inside) if there else None
    values = arrays.get(name)
    if values is None:
        return None
    if kind is Array:
        return Array(values)
    if kind is str:
        return values.tobytes().decode()
    return tuple(values.tolist()) if get_origin(kind) is tuple else values.item()


def cached_split_texels(
    tree: Tree,
    geometry: MapGeometry,
    texels: Texels,
    charts: NDArray[np.int32],
    links: NDArray[np.int32],
    sheets: BoolArray,
    over_rows: OverRows,
) -> tuple[Texels, NDArray[np.int32]]:
    """As `split_texels`, but those of a scene that was opened before are read."""
    cache = ArrayCache.of_user("cut_texels", _CUTS_BYTES)
    recipe = code_digest(_RAYS_CODE), digest_of([*tree, *geometry, *texels, charts, links, sheets])
    kept = cache.get(recipe)
    if kept is not None and _fit_cuts(kept, texels):
        linked = kept.pop("links")
        return texels._replace(**kept), linked
    found, linked = split_texels(tree, geometry, texels, charts, links, sheets, over_rows)
    made = {"cut": found.cut, "cell_row": found.cell_row, "middle": found.middle}
    cache.put(recipe, {**made, "begins": found.begins, "links": linked})
    return found, linked


def _fit_cuts(kept: dict[str, NDArray], texels: Texels) -> bool:
    """Whether arrays have the shapes of these texels."""
    names = {"cut", "cell_row", "middle", "begins", "links"}
    count = len(texels.pixel)
    return kept.keys() == names and (
        (kept["cut"].shape, kept["begins"].shape) == ((count,), (count,))
        and kept["links"].shape == (count, 4)
        and kept["cell_row"].shape == (len(kept["middle"]), CELLS * CELLS)
    )


class TransportKey(NamedTuple):
    """Key of a transport: scene and sizes, rays of the first round, and all rays."""

    scene: str
    first_rays: int
    rays: int


class RoundCounts(NamedTuple):
    """Number of texels of a transport, and memory of its arrays."""

    texels: int
    table_bytes: int


def scene_key(scene: SceneOpened, sizes: tuple[object, ...]) -> str:
    """Key of a scene and the `TransportSizes` of its transport."""
    bounds_m = scene.lower_m, scene.upper_m
    return repr((code_digest(_LIGHT_CODE), scene.content_key, scene.ground, bounds_m, sizes))


def cached_layout(key: str) -> tuple[LightMapLaid, int] | None:
    """The layout of a scene that was laid out in another session, and its number of rows."""
    arrays = _layouts().get(key)
    return None if arrays is None else (_struct_of(LightMapLaid, arrays), int(arrays["rows"]))


def cache_layout(key: str, message: LightMapLaid, rows: int) -> None:
    """Keep a layout and the number of rows."""
    _layouts().put(key, {**dict(_arrays_of(message)), "rows": np.array(rows)})


def cached_round(key: TransportKey) -> RoundCounts | None:
    """The counts of a transport of another session."""
    arrays = _layouts().get(tuple(key))
    return None if arrays is None else RoundCounts(*map(int, arrays["counts"]))


def cache_round(key: TransportKey, counts: RoundCounts) -> None:
    """Keep the counts of a transport."""
    _layouts().put(tuple(key), {"counts": np.array(counts)})


def _layouts() -> ArrayCache:
    return ArrayCache.of_user("layouts", _LAYOUTS_BYTES)


def cached_light(
    key: TransportKey, hour: Illumination, view: tuple[object, ...], make: Callable[[], Arrays]
) -> Arrays:
    """Light that `make` computes now, or another session did; `view` is all else that it needs."""
    recipe = (*key, digest_of(map(np.asarray, vars(hour).values())), view)
    cache = ArrayCache.of_user("still_light", _LIGHT_BYTES)
    kept = cache.get(recipe)
    if kept is not None:
        return kept
    made = make()
    cache.put(recipe, made)
    return made


def cached_rays(key: tuple[object, ...], rows: int) -> RayRows | None:
    """The table of rays of so many rows that another session traced, or this one before."""
    wait_for_rays()
    arrays = _rays().get((code_digest(_RAYS_CODE), *key))
    names = {name for name in RayRows._fields if name != "first"}
    if arrays is None or arrays.keys() != names or len(arrays["start"]) != rows + 1:
        return None
    return RayRows(0, **arrays)


def cache_rays(key: tuple[object, ...], table: RayRows) -> None:
    """Keep the rays of all rows; they are written by another thread, before the process ends."""
    arrays = table._asdict()
    del arrays["first"]
    _writer.submit(_rays().put, (code_digest(_RAYS_CODE), *key), arrays)


def wait_for_rays() -> None:
    """Until all rays that are to be kept are on disk."""
    _writer.submit(int).result()


def _rays() -> ArrayCache:
    return ArrayCache.of_user("light_maps", _RAYS_BYTES)

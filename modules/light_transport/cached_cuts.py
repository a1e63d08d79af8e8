"""Cut texels kept on disk: what takes longest of a layout is found once for a scene's geometry."""

import numpy as np
from numpy.typing import NDArray

from light_transport.digests import code_digest, digest_of
from light_transport.rays.split_texels import OverRows, cut_texels
from light_transport.rays.tree import Tree
from light_transport.surfaces.map_texels import CELLS, MapGeometry, Texels
from vrut_lite.array_cache import ArrayCache
from vrut_lite.numeric_types import BoolArray

# A scene takes some 10 MB.
_LIMIT_BYTES = 1 << 28
_CODE = ("kernels.py", "rays/*.py", "surfaces/*.py")


def kept_cut_texels(
    tree: Tree,
    geometry: MapGeometry,
    texels: Texels,
    charts: NDArray[np.int32],
    links: NDArray[np.int32],
    sheets: BoolArray,
    over_rows: OverRows,
) -> tuple[Texels, NDArray[np.int32]]:
    """As `cut_texels`, but of a scene that was opened before they are read."""
    cache = ArrayCache.of_user("cut_texels", _LIMIT_BYTES)
    recipe = code_digest(_CODE), digest_of([*tree, *geometry, *texels, charts, links, sheets])
    kept = cache.get(recipe)
    if kept is not None and _fit(kept, texels):
        linked = kept.pop("links")
        return texels._replace(**kept), linked
    found, linked = cut_texels(tree, geometry, texels, charts, links, sheets, over_rows)
    made = {"cut": found.cut, "cell_row": found.cell_row, "middle": found.middle}
    cache.put(recipe, {**made, "begins": found.begins, "links": linked})
    return found, linked


def _fit(kept: dict[str, NDArray], texels: Texels) -> bool:
    """Whether arrays are those of so many texels."""
    names = {"cut", "cell_row", "middle", "begins", "links"}
    count = len(texels.pixel)
    return kept.keys() == names and (
        (kept["cut"].shape, kept["begins"].shape) == ((count,), (count,))
        and kept["links"].shape == (count, 4)
        and kept["cell_row"].shape == (len(kept["middle"]), CELLS * CELLS)
    )

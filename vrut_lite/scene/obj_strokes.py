"""Points and lines (`p`, `l`) of an OBJ file: as its text states them, and as they are drawn."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.gltf_points_and_lines import Strokes
from vrut_lite.scene.scene_file_error import SceneFileError

# Memory (bytes) of a point's number and material in a list, and of an end's place and colour.
_STATED_BYTES, _PLACED_BYTES = 128, 80


class ObjStrokes(NamedTuple):
    """Vertices of points (n, 1) or of the ends of lines (n, 2), from 0, and materials (n,)."""

    vertices: NDArray[np.int64]
    group: NDArray[np.int32]


class StatedStrokes:
    """Collects statements."""

    def __init__(self, budget: SceneBudget) -> None:
        self._budget = budget
        # Vertices counted from 1, then the material's number.
        self._rows: dict[int, list[tuple[int, ...]]] = {1: [], 2: []}

    def read(self, kind: bytes, words: bytes, vertices: int, group: int) -> None:
        """Take a statement; negative numbers count back from the last of so many `vertices`.

        Raises:
            SceneFileError: something else than numbers stands there.
        """
        try:
            numbers = [int(corner.split(b"/")[0]) for corner in words.split()]
        except ValueError:
            raise SceneFileError(
                "its OBJ text is damaged: a point or line has something else than numbers; "
                "export it again"
            ) from None
        numbers = [number if number >= 0 else vertices + 1 + number for number in numbers]
        self._budget.take(_STATED_BYTES * len(numbers), "its points and lines")
        if kind == b"p":
            self._rows[1] += [(number, group) for number in numbers]
        else:
            self._rows[2] += [(start, end, group) for start, end in pairwise(numbers)]

    def all(self, vertices: int) -> list[ObjStrokes]:
        """Points and lines of a file of so many vertices; empty without any.

        Raises:
            SceneFileError: one refers to a vertex that is not there.
        """
        found = []
        for ends, rows in self._rows.items():
            if not rows:
                continue
            most = max(max(row[:ends]) for row in rows)
            if most > vertices or min(min(row[:ends]) for row in rows) < 1:
                raise SceneFileError(
                    f"a point or line refers to a vertex that is not among its {vertices}; "
                    "export it again"
                )
            table = np.array(rows, np.int64)
            found.append(ObjStrokes(table[:, :ends] - 1, table[:, ends].astype(np.int32)))
        return found


def placed_strokes(
    strokes: list[ObjStrokes],
    positions: NDArray[np.float64],
    colours: NDArray[np.float64] | None,
    material_rgba: dict[int, NDArray[np.float64]],
    budget: SceneBudget,
) -> list[Strokes]:
    """Points and lines at their vertices (V, 3), in vertices' colours (V, 3) times materials'.

    Raises:
        SceneFileError: a vertex is not finite, or they do not fit the budget.
    """
    placed = []
    for one in strokes:
        budget.take(_PLACED_BYTES * one.vertices.size, "its points and lines")
        places = positions[one.vertices]
        if not np.isfinite(places).all():
            raise SceneFileError("points or lines in it have no finite positions; export it again")
        numbers, at = np.unique(one.group, return_inverse=True)
        rgba = np.stack([material_rgba[int(number)] for number in numbers])[at]
        rgba = np.repeat(rgba[:, None], one.vertices.shape[1], axis=1)
        if colours is not None:
            rgba[..., :3] *= np.nan_to_num(colours[one.vertices])
        placed.append(Strokes(places, np.clip(rgba, 0.0, 1.0).astype(np.float32)))
    return placed

"""The points and lines of a glTF file where its nodes place them, unbent."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.messages.points_and_lines import PointsAndLines
from vrut_lite.scene.gltf_file import GltfFile, item_at, normalised
from vrut_lite.scene.gltf_schema import GltfMaterial, GltfMesh, Primitive
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.scene.vertex_colours import within_range

TOLD_STROKES = "one pixel wide, in their colours; not path traced, and without shadows"
_POINTS, _LINES, _LOOP, _STRIP, _TRIANGLES = range(5)
# Places and colours of a line's ends, and what they are made of.
_VERTEX_BYTES = 80
_WHITE = np.ones(4, np.float32)


class Strokes(NamedTuple):
    """Points (n, 1, 3), or lines by their ends (n, 2, 3), and their colours (n, 1 or 2, 4)."""

    places: NDArray[np.float64]
    rgba: NDArray[np.float32]

    def moved(self, matrix: NDArray[np.float64]) -> "Strokes":
        """The same under a matrix (4, 4)."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self._replace(places=self.places @ matrix[:3, :3].T + matrix[:3, 3])


class GltfStrokes:
    """The points and lines behind glTF's mesh numbers, each made once."""

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._made: dict[int, list[Strokes]] = {}
        self._placed_bytes = 0

    def begin(self) -> None:
        """Begin a pose: drop placed points and lines."""
        self._file.folder.budget.release(self._placed_bytes)
        self._placed_bytes = 0

    def get(self, index: int) -> list[Strokes]:
        """Points and lines of a mesh, in its axes.

        Raises:
            SceneFileError: its arrays do not hold, or are too large.
        """
        if index not in self._made:
            mesh: GltfMesh = item_at(self._file.document.meshes, index, "mesh")
            found = [one for one in mesh.primitives if one.mode < _TRIANGLES]
            self._made[index] = [self._make(one) for one in found if "POSITION" in one.attributes]
        return self._made[index]

    def take(self, strokes: Strokes) -> None:
        """Count the memory of one more place."""
        size = _VERTEX_BYTES * strokes.rgba[..., 0].size
        self._file.folder.budget.take(size, "points and lines of it")
        self._placed_bytes += size

    def _make(self, primitive: Primitive) -> Strokes:
        file = self._file
        number = primitive.attributes["POSITION"]
        drawn = number if primitive.indices is None else primitive.indices
        declared = file.accessor(number).count + 2 * file.accessor(drawn).count
        file.folder.budget.take(_VERTEX_BYTES * declared, "points and lines of it")
        for index in {number, drawn, *_colour(primitive)}:
            file.folder.budget.ask(file.accessor_bytes(index), f"accessor {index}")
        positions = self._values(number)
        if positions.shape[1] != 3 or not np.isfinite(positions).all():
            raise SceneFileError("points or lines in it have no finite positions; export it again")
        rgba = self._rgba(primitive, len(positions))
        order = _ends(primitive.mode, self._order(primitive, len(positions)))
        if order.size and (order.min() < 0 or order.max() >= len(positions)):
            raise SceneFileError("points or lines in it refer to vertices that are not there")
        return Strokes(positions[order].astype(np.float64), rgba[order])

    def _order(self, primitive: Primitive, count: int) -> NDArray[np.int64]:
        if primitive.indices is None:
            return np.arange(count)
        return self._file.array(primitive.indices)[:, 0].astype(np.int64)

    def _rgba(self, primitive: Primitive, count: int) -> NDArray[np.float32]:
        """Base colours (V, 4), by factor and vertex."""
        file, number = self._file, primitive.material
        source = (
            GltfMaterial()
            if number is None
            else item_at(file.document.materials, number, "material")
        )
        rgba = np.tile(
            np.asarray(source.pbr_metallic_roughness.base_color_factor, float), (count, 1)
        )
        for index in _colour(primitive):
            values = self._values(index, "COLOR_0")
            if len(values) != count or values.shape[1] not in (3, 4):
                raise SceneFileError("colours of points or lines in it do not fit; export it again")
            rgba[:, : values.shape[1]] *= within_range(values, file.notices)
        return np.clip(rgba, 0.0, 1.0).astype(np.float32)

    def _values(self, index: int, key: str = "POSITION") -> NDArray[np.float64]:
        stored = self._file.array(index)
        values = normalised(stored) if self._file.is_share(key, index) else stored
        return values.astype(np.float64)


def packed_strokes(strokes: list[Strokes]) -> PointsAndLines | None:
    """All of a scene's as its message; None without any."""
    parts = {}
    for name, ends in (("point", 1), ("line", 2)):
        of_kind = [one for one in strokes if one.places.shape[1] == ends]
        shape = (-1, 3) if ends == 1 else (-1, ends, 3)
        places = np.concatenate([np.empty((0, ends, 3)), *(one.places for one in of_kind)])
        rgba = np.concatenate([np.empty((0, ends, 4), np.float32), *(one.rgba for one in of_kind)])
        parts[f"{name}s_m"] = Array(places.reshape(shape))
        parts[f"{name}_rgba"] = Array(rgba.reshape(*shape[:-1], 4))
    if not any(array.values.size for array in parts.values()):
        return None
    if not all(np.isfinite(parts[name].values).all() for name in ("points_m", "lines_m")):
        raise SceneFileError("points or lines in it stand nowhere; mend their nodes")
    return PointsAndLines(**parts)


def _colour(primitive: Primitive) -> list[int]:
    return [primitive.attributes[key] for key in ("COLOR_0",) if key in primitive.attributes]


def _ends(mode: int, order: NDArray[np.int64]) -> NDArray[np.int64]:
    """The vertices of points (n, 1), or of the ends of lines (n, 2)."""
    if mode == _POINTS:
        return order[:, None]
    if mode == _LINES:
        return order[: order.size // 2 * 2].reshape(-1, 2)
    following = np.roll(order, -1) if mode == _LOOP else order[1:]
    return np.stack([order[: following.size], following], axis=1)

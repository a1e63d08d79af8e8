"""The parts of a glTF primitive that make its triangles, and the memory they take."""

from collections import Counter
from collections.abc import Hashable
from typing import NamedTuple

from vrut_lite.scene.gltf_file import GltfFile, item_at
from vrut_lite.scene.gltf_schema import GltfMaterial, Primitive
from vrut_lite.scene.gltf_skinning import Bend
from vrut_lite.scene.mesh import MESH_BYTES, geometry_bytes
from vrut_lite.scene.placed import check_places, check_triangles
from vrut_lite.scene.uv_layers import UvLayer, layers_of

TRIANGLES = 4
_READ = ("POSITION", "NORMAL", "COLOR_0")
_INDEX_BYTES = 4
# A matrix of 4 x 4 a vertex, in sets of texture coordinates.
_MATRIX_LAYERS = 8


class ShapeKey(NamedTuple):
    """Key of a geometry: primitives of one shape share triangles, whatever their materials."""

    mode: int
    attributes: tuple[tuple[str, int], ...]
    indices: int | None
    layers: tuple[UvLayer, ...]
    draco: tuple[int, tuple[tuple[str, int], ...]] | None
    targets: tuple[tuple[float, tuple[tuple[str, int], ...]], ...] = ()
    skin: int | None = None

    @property
    def bent(self) -> bool:
        """Whether a pose changes its vertices."""
        return bool(self.targets) or self.skin is not None

    def accessors(self) -> list[int]:
        """The numbers of all arrays that it reads."""
        named = [*self.attributes, *(one for _, target in self.targets for one in target)]
        return [number for _, number in named]

    def draws(self, file: GltfFile) -> int:
        """The number of indices, or of vertices where there are no indices."""
        number = dict(self.attributes)["POSITION"] if self.indices is None else self.indices
        return file.accessor(number).count

    def triangles(self, file: GltfFile) -> int:
        """How many triangles are declared."""
        draws = self.draws(file)
        return draws // 3 if self.mode == TRIANGLES else max(draws - 2, 0)

    def size_bytes(self, file: GltfFile) -> int:
        """The most bytes that its geometry holds, by what the file declares."""
        attributes = dict(self.attributes)
        return geometry_bytes(
            file.accessor(attributes["POSITION"]).count,
            self.triangles(file),
            normals="NORMAL" in attributes,
            layers=len(self.layers) + ("COLOR_0" in attributes) + self._bending_layers(),
        )

    def _bending_layers(self) -> int:
        """Memory of deformation for each vertex, in sets of texture coordinates."""
        return (_MATRIX_LAYERS if self.skin is not None else 0) + 4 * len(self.targets)


def shape_of(file: GltfFile, primitive: Primitive, bend: Bend) -> ShapeKey | None:
    """The shape of a primitive that is bent like this, or None if it has no triangles."""
    if primitive.mode < TRIANGLES or "POSITION" not in primitive.attributes:
        return None
    number = primitive.material
    source = (
        GltfMaterial() if number is None else item_at(file.document.materials, number, "material")
    )
    layers = layers_of(source)[0] or [UvLayer("TEXCOORD_0", None)]
    wanted = {*_READ, *(layer.attribute for layer in layers)}
    if bend.skin is not None:
        wanted |= {key for key in primitive.attributes if key.startswith(("JOINTS_", "WEIGHTS_"))}
    attributes = sorted((key, at) for key, at in primitive.attributes.items() if key in wanted)
    targets = tuple(
        (weight, tuple((key, target[key]) for key in ("POSITION", "NORMAL") if key in target))
        for weight, target in zip(bend.weights, primitive.targets, strict=False)
        if weight != 0.0
    )
    packed = primitive.extensions.draco
    draco = None
    if packed is not None:
        draco = (packed.buffer_view, tuple(sorted(packed.attributes.items())))
    return ShapeKey(
        primitive.mode,
        tuple(attributes),
        primitive.indices,
        tuple(layers),
        draco,
        targets,
        bend.skin,
    )


class Sizes:
    """Checks declared counts before arrays are made: a small file cannot make large ones."""

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._asked: set[Hashable] = set()

    def check(self, placed: Counter[tuple[int, Bend]]) -> None:
        """Check so many places of meshes that are bent like this."""
        file = self._file
        places = triangles = size_bytes = 0
        shapes: set[ShapeKey] = set()
        for (number, bend), times in placed.items():
            for primitive in item_at(file.document.meshes, number, "mesh").primitives:
                shape = shape_of(file, primitive, bend)
                if shape is None:
                    continue
                places += times
                triangles += times * shape.triangles(file)
                size_bytes += MESH_BYTES
                if shape in shapes:
                    continue
                shapes.add(shape)
                size_bytes += shape.size_bytes(file)
                if shape.draco is None:
                    self._ask(shape)
        check_places(places)
        check_triangles(triangles)
        file.folder.budget.check(size_bytes, "its meshes")

    def _ask(self, shape: ShapeKey) -> None:
        """Counts each accessor once, and the triangle list that is made for each shape."""
        file, budget = self._file, self._file.folder.budget
        for index in (*shape.accessors(), shape.indices):
            if index is not None and index not in self._asked:
                self._asked.add(index)
                budget.ask(file.accessor_bytes(index), f"accessor {index}")
        # Another pose of a shape replaces its triangles.
        unposed = shape._replace(targets=())
        if unposed not in self._asked:
            self._asked.add(unposed)
            budget.ask(shape.draws(file) * _INDEX_BYTES, "a list of triangles in it")

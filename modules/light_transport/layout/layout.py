"""Where the surfaces of a scene lie in its light map."""

import hashlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from light_transport.giving_up import CancelCheck, always
from light_transport.layout.ground_chart import EDGE_PX, ground_chart, ground_owners
from light_transport.layout.mesh_shapes import WIDEST_PX, MeshShape
from light_transport.layout.part_shapes import PartShapes, part_shapes
from light_transport.layout.probe_places import probe_grid
from light_transport.layout.rectangle_packing import pack
from light_transport.layout.seams import seam_texels
from light_transport.layout.texel_owners import UNUSED
from light_transport.surfaces.surfaces import Surfaces
from vrut_lite.array import Array
from vrut_lite.messages.light_map import (
    NOT_MAPPED,
    GroundChart,
    LightMapLaid,
    ProbeGrid,
)
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import Float32Array, FloatArray

SOURCE = "light_transport"
TEXELS = 150_000
# Where there are no charts, surfaces send light as if texels were so large, in radii.
_PROBES_TEXEL = 5e-3
# Version of the algorithm: kept rays of other versions do not fit.
_VERSION = 2


@dataclass(frozen=True, eq=False)
class Layout:
    """The places of the triangles (F) of `Surfaces` in the light map, and the owner of each texel.

    Attributes:
        message: the layout as posted.
        uv_px: (F, 3, 2) float32, places of corners in the map, in texels, texel middles at halves;
            exact multiples of 2^-10. The message has where they are looked up, which in charts of
            one texel's width is its middle. NaN where a triangle has no texels, and for the
            ground's, whose places `ground_chart` gives.
        owner: (height, width) int32, the triangle that a texel's middle lies in, or beside a
            chart the nearest one of it; `texel_owners.UNUSED` elsewhere.
        chart: (F,) int32, the chart of each triangle; -1 where it has no texels, and the ground's.
        seams: (S, 2) int32, see `seams.seam_texels`.
        texel_m: edge of a texel, where its part does not have finer ones, or is too long for it.
        part_texel_m: (P,) float64, edge of a texel on each part, NaN where it has none.
        charts: how many there are, the ground's too.
    """

    message: LightMapLaid
    uv_px: Float32Array
    owner: NDArray[np.int32]
    chart: NDArray[np.int32]
    seams: NDArray[np.int32]
    texel_m: float
    part_texel_m: FloatArray
    charts: int

    @property
    def texels(self) -> int:
        """How many texels are used."""
        return int(np.count_nonzero(self.owner != UNUSED))


def lay_out(
    scene: SceneOpened,
    surfaces: Surfaces,
    texel_m: float | None = None,
    texels: int = TEXELS,
    threads: int = 1,
    go_on: CancelCheck = always,
) -> Layout:
    """A light map for a scene.

    Args:
        scene: the opened scene.
        surfaces: its `surfaces_of`.
        texel_m: edge of a texel, larger if the map would have more than 400,000. None: such that
            about `texels` are used, without the ground's 9,216. Where triangles are fine, texels
            are finer.
        texels: see `texel_m`.
        threads: number of threads; the layout does not depend on it.
        go_on: asked between steps.

    Raises:
        GivenUp: by `go_on`.
    """
    shapes = part_shapes(scene.geometry, texel_m, texels, threads, go_on)
    return _placed(scene, surfaces, shapes, go_on)


def lay_out_probes(scene: SceneOpened, surfaces: Surfaces) -> Layout:
    """A light map of probes and of the ground's texels alone, which takes no time."""
    parts = len(scene.geometry.part_mesh.values)
    none = np.full(parts, NOT_MAPPED, np.int32)
    texel_m = _PROBES_TEXEL * surfaces.radius_m
    shapes = PartShapes(none, [], [], np.ones(parts, bool), texel_m)
    return _placed(scene, surfaces, shapes, always)


def _placed(
    scene: SceneOpened, surfaces: Surfaces, shapes: PartShapes, go_on: CancelCheck
) -> Layout:
    """Shapes side by side in one map, and what follows from their places."""
    sizes = [shapes.shapes[shape].size for shape in shapes.of if shape != NOT_MAPPED]
    if scene.ground is not None:
        sizes.append((EDGE_PX, EDGE_PX))
    packed = pack(np.array(sizes, np.int32).reshape(-1, 2), WIDEST_PX)
    corners = np.zeros((len(shapes.of), 2), np.int32)
    mapped = np.flatnonzero(shapes.of != NOT_MAPPED)
    corners[mapped] = packed.corners[: len(mapped)]
    owner = np.full((max(packed.size[1], 1), max(packed.size[0], 1)), UNUSED, np.int32)
    uv_px = np.full((len(surfaces.part), 3, 2), np.nan, np.float32)
    chart = np.full(len(surfaces.part), -1, np.int32)
    first = np.searchsorted(surfaces.part[: _own_triangles(surfaces)], np.arange(len(shapes.of)))
    charts = 0
    for part in mapped:
        shape, (x, y) = shapes.shapes[shapes.of[part]], corners[part]
        rows = slice(first[part], first[part] + len(shape.uv_px))
        uv_px[rows] = shape.uv_px + corners[part]
        chart[rows] = shape.chart + charts
        charts += shape.charts
        place = owner[y : y + shape.size[1], x : x + shape.size[0]]
        place[:] = np.where(shape.owner == UNUSED, UNUSED, shape.owner + first[part])
    ground = None
    if scene.ground is not None:
        x, y = map(int, packed.corners[-1])
        ground = ground_chart(scene.ground, surfaces.radius_m, (x, y))
        owner[y : y + EDGE_PX, x : x + EDGE_PX] = ground_owners(len(surfaces.part) - 2)
        charts += 1
    go_on()
    seams = seam_texels(surfaces.corners_m, surfaces.normals, uv_px, chart, owner)
    message = _message(scene, surfaces, shapes, corners, owner, ground)
    texels_m = np.array([*(shape.texel_m for shape in shapes.shapes), np.nan])
    return Layout(message, uv_px, owner, chart, seams, shapes.texel_m, texels_m[shapes.of], charts)


def _own_triangles(surfaces: Surfaces) -> int:
    """How many are the scene's, without the ground's."""
    return int(np.count_nonzero(surfaces.part >= 0))


def _message(
    scene: SceneOpened,
    surfaces: Surfaces,
    shapes: PartShapes,
    corners: NDArray[np.int32],
    owner: NDArray[np.int32],
    ground: GroundChart | None,
) -> LightMapLaid:
    vertices = [len(shape.source_vertex) for shape in shapes.shapes]
    triangles = [len(shape.triangles) for shape in shapes.shapes]
    table = np.stack(
        [shapes.meshes, _starts(vertices), vertices, _starts(triangles), triangles], axis=1
    )
    content_key = scene.content_key
    arrays = {
        "shapes": Array(table.astype(np.int64).reshape(-1, 5)),
        "source_vertex": Array(_joined(shapes.shapes, "source_vertex", np.int32, ())),
        "uv": Array(_joined(shapes.shapes, "vertex_uv", np.float32, (2,))),
        "triangles": Array(_joined(shapes.shapes, "triangles", np.int32, (3,))),
        "part_shape": Array(shapes.of.astype(np.int32)),
        "part_corner_px": Array(corners),
    }
    key = " ".join([str(_VERSION), content_key, *(array.digest for array in arrays.values())])
    return LightMapLaid(
        content_key=content_key,
        layout_key=hashlib.blake2b(key.encode(), digest_size=16).hexdigest(),
        size_px=(owner.shape[1], owner.shape[0]),
        ground=ground,
        probes=_probes(surfaces, shapes),
        source=SOURCE,
        mirrors=None,
        **arrays,
    )


def _probes(surfaces: Surfaces, shapes: PartShapes) -> ProbeGrid | None:
    """Around the parts without texels that have some surface."""
    bare = np.flatnonzero(shapes.needs_probes)
    corners = surfaces.corners_m[np.isin(surfaces.part, bare)].reshape(-1, 3) + surfaces.centre_m
    if not len(corners):
        return None
    return probe_grid(corners.min(axis=0), corners.max(axis=0), shapes.texel_m)


def _starts(counts: list[int]) -> NDArray[np.int64]:
    return np.cumsum([0, *counts], dtype=np.int64)[:-1]


def _joined(shapes: list[MeshShape], name: str, dtype: type, row: tuple[int, ...]) -> NDArray:
    arrays: list[NDArray] = [np.empty((0, *row), dtype)]
    arrays += [getattr(shape, name) for shape in shapes]
    return np.concatenate(arrays, dtype=dtype, casting="same_kind")

"""A mesh, stretched as it stands, cut into charts for texels of one size."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import kernel
from light_transport.layout.facing_groups import FacingGroups, facing_groups, merged
from light_transport.layout.rectangle_packing import pack
from light_transport.layout.seams import opposite_edges, welded
from light_transport.layout.texel_owners import texel_owners
from light_transport.layout.unwrapping import Charts, unwrapped
from vrut_lite.messages.scene_content import Mesh
from vrut_lite.numeric_types import FloatArray

# Rectangles keep within it where they can.
WIDEST_PX = 4096
# A chart is no longer.
_LONGEST_PX = WIDEST_PX - 4
# Slivers have no normal to speak of: the height of a triangle is below this share of its edge.
_SLIVER = 1e-9


@dataclass(frozen=True, eq=False)
class MeshSurface:
    """A stretched mesh and the groups of its triangles, independent of the size of texels.

    `vertices` (F, 3): the mesh's own; `corners_m` (F, 3, 3), from their lower bound; `normals`
    (F, 3), `areas_m2` (F,), `opposite` (F, 3) and `groups`: see `facing_groups`.
    """

    vertices: NDArray[np.int32]
    corners_m: FloatArray
    normals: FloatArray
    areas_m2: FloatArray
    opposite: NDArray[np.int32]
    groups: FacingGroups

    @property
    def least_texel_m(self) -> float:
        """Edge of texels with which no chart is too long for the map."""
        diagonal_m = float(np.linalg.norm(self.corners_m.max(axis=(0, 1), initial=0.0)))
        return diagonal_m / _LONGEST_PX


@dataclass(frozen=True, eq=False)
class MeshShape:
    """A surface with its charts in one rectangle.

    Attributes:
        source_vertex, vertex_uv, triangles: see `daylight.light_map.Shape`.
        chart: (F,) int32, of each triangle.
        uv_px: (F, 3, 2) float64, places of corners from the rectangle's corner; `vertex_uv` has
            where they are looked up, see `unwrapping.Charts`.
        owner: (height, width) int32, see `texel_owners`.
        charts: how many there are.
        texel_m: edge of a texel.
    """

    source_vertex: NDArray[np.int32]
    vertex_uv: FloatArray
    triangles: NDArray[np.int32]
    chart: NDArray[np.int32]
    uv_px: FloatArray
    owner: NDArray[np.int32]
    charts: int
    texel_m: float

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the rectangle."""
        return self.owner.shape[1], self.owner.shape[0]


def stretched(mesh: Mesh, stretch: FloatArray) -> MeshSurface:
    """The surface of a mesh after a linear map (3, 3)."""
    numbers, inverse = np.unique(mesh.triangles, return_inverse=True)
    vertices = np.asarray(inverse.reshape(-1, 3), np.int32)
    points = mesh.positions_m[numbers] @ stretch.T
    points = points - points.min(axis=0, initial=np.inf)
    corners = points[vertices]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(across, axis=1)
    longest2 = np.square(corners - np.roll(corners, 1, axis=1)).sum(axis=2).max(axis=1, initial=0.0)
    areas = np.where(length > _SLIVER * longest2, 0.5 * length, 0.0)
    normals = np.divide(
        across, length[:, None], out=np.zeros_like(across), where=areas[:, None] > 0.0
    )
    opposite = opposite_edges(vertices, welded(points)[vertices])
    groups = facing_groups(normals, areas, opposite, mesh.normals[mesh.triangles])
    return MeshSurface(mesh.triangles, corners, normals, areas, opposite, groups)


def charts_of(surface: MeshSurface, texel_m: float) -> Charts:
    """The charts of a surface for texels of this edge, at least its `least_texel_m`."""
    corners_px, areas_px2 = surface.corners_m / texel_m, surface.areas_m2 / texel_m**2
    groups = merged(surface.groups, corners_px, surface.normals, areas_px2, surface.opposite)
    return unwrapped(groups, corners_px, surface.opposite)


def shape_of(surface: MeshSurface, charts: Charts, texel_m: float) -> MeshShape:
    """Charts, which were made for texels of this edge, in one rectangle."""
    packed = pack(charts.sizes, WIDEST_PX)
    corners = packed.corners[charts.of][:, None]
    uv_px = charts.uv_px + corners
    owner = texel_owners(uv_px, charts.of, packed.corners, charts.sizes, packed.size)
    corner, triangles = _split_vertices(surface.vertices, charts.of, len(charts.sizes))
    return MeshShape(
        source_vertex=surface.vertices.reshape(-1)[corner],
        vertex_uv=(charts.look_up_px + corners).reshape(-1, 2)[corner],
        triangles=triangles,
        chart=charts.of,
        uv_px=uv_px,
        owner=owner,
        charts=len(charts.sizes),
        texel_m=texel_m,
    )


@kernel
def _split_vertices(vertices, chart, charts):  # type: ignore[no-untyped-def]
    """Triangles (F, 3) of vertices that charts do not share, and a corner that each copies."""
    count, most = len(vertices), -1
    # Triangles chart after chart.
    place, order = np.zeros(charts + 1, np.int64), np.empty(count, np.int64)
    for f in range(count):
        place[chart[f] + 1] += 1
        for k in range(3):
            most = max(most, vertices[f, k])
    for c in range(charts):
        place[c + 1] += place[c]
    for f in range(count):
        order[place[chart[f]]] = f
        place[chart[f]] += 1
    seen = np.full(most + 1, -1, np.int32)
    number = np.empty(most + 1, np.int32)
    corner = np.empty(3 * count, np.int32)
    triangles = np.empty((count, 3), np.int32)
    made = 0
    for f in order:
        for k in range(3):
            vertex = vertices[f, k]
            if seen[vertex] != chart[f]:
                seen[vertex], number[vertex], corner[made] = chart[f], made, 3 * f + k
                made += 1
            triangles[f, k] = number[vertex]
    return corner[:made].copy(), triangles

"""Chooses the parts of a scene that get texels, the texels' sizes, and shared shapes."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from light_transport.giving_up import CancelCheck
from light_transport.layout.mesh_shapes import (
    MeshShape,
    MeshSurface,
    charts_of,
    shape_of,
    stretched,
)
from light_transport.layout.texel_owners import UNUSED
from light_transport.layout.unwrapping import Charts
from vrut_lite.messages.light_map import NOT_MAPPED
from vrut_lite.messages.scene_content import SceneGeometry
from vrut_lite.numeric_types import BoolArray, FloatArray

_Made = TypeVar("_Made")
# Most texels of a map, for any setting.
MOST_TEXELS = 400_000
# Texels are right when this share of those that are wanted is used; their size is sought so often.
_LEAST_USED, _MOST_USED, _ROUNDS = 0.75, 1.05, 6
# How many times too many texels the first trial may have.
_FIRST_TRIAL = 4.0
# From trial to trial texels shrink to this share of their edge at most.
_FASTEST = 0.6
# A part may go without texels if its area is less than this share of them, and goes when texels
# beside borders would be more than this share of the budget.
_SPARSE, _MOST_BESIDE = 0.25, 0.6
# It goes anyway, foliage for one, if it is thinner than this share and takes more than this share
# of the budget.
_THIN, _TRIFLE = 0.02, 1e-3
# No more than this share of the scene's area goes: texels grow instead.
_MOST_BARE = 0.5
# Surfaces of so many triangles a group are modelled finely where they are to be seen finely; this
# share of the budget is theirs for a texel a triangle.
_TRIANGLES_A_GROUP, _FINE = 8, 0.6
# Linear maps that agree to this share of their largest element make one shape.
_SAME = 1e-6


@dataclass(frozen=True, eq=False)
class PartShapes:
    """Shapes (S) of parts (P).

    Attributes:
        of: (P,) int32, each part's shape; NOT_MAPPED where it has no texels.
        shapes, meshes: the shapes, and the mesh of each.
        needs_probes: (P,) bool, no texels, but some area.
        texel_m: edge of a texel.
    """

    of: NDArray[np.int32]
    shapes: list[MeshShape]
    meshes: list[int]
    needs_probes: BoolArray
    texel_m: float


@dataclass(frozen=True, eq=False)
class _Kind:
    """A mesh as it stands in `count` places, apart from how it is turned there."""

    mesh: int
    surface: MeshSurface
    area_m2: float
    count: int


class _Each(Protocol):
    def __call__(self, make: Callable[[int], _Made], count: int) -> list[_Made]: ...


def _each(
    threads: int, go_on: CancelCheck, make: Callable[[int], _Made], count: int
) -> list[_Made]:
    """Results for each number below `count`; `go_on` is called before each."""

    def asked(number: int) -> _Made:
        go_on()
        return make(number)

    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(asked, range(count)))


class _Cut:
    """The latest charts and shape of a surface.

    Texels of finely modelled surfaces keep their size while that of others is sought: cutting them
    again in each trial took 9 of the 14 s that a million triangles need.
    """

    def __init__(self, surface: MeshSurface):
        self.surface = surface
        self._texel_m = 0.0
        self._charts: Charts | None = None
        self._shape: MeshShape | None = None

    def charts(self, texel_m: float) -> Charts:
        """For texels of this edge."""
        if self._charts is None or texel_m != self._texel_m:
            self._charts, self._shape = charts_of(self.surface, texel_m), None
            self._texel_m = texel_m
        return self._charts

    def shape(self, texel_m: float) -> MeshShape:
        """For texels of this edge."""
        charts = self.charts(texel_m)
        if self._shape is None:
            self._shape = shape_of(self.surface, charts, texel_m)
        return self._shape


def part_shapes(
    geometry: SceneGeometry, texel_m: float | None, texels: int, threads: int, go_on: CancelCheck
) -> PartShapes:
    """Shapes for all parts of a scene, as `layout.lay_out` explains."""
    each = partial(_each, threads, go_on)
    kinds, of = _kinds(geometry, each)
    whole_m2 = sum(kind.area_m2 * kind.count for kind in kinds)
    if whole_m2 == 0.0:
        nothing = np.full(len(of), NOT_MAPPED, np.int32)
        return PartShapes(nothing, [], [], np.zeros(len(of), bool), texel_m or 1.0)
    most = MOST_TEXELS if texel_m else min(texels, MOST_TEXELS)
    # With those beside borders there are some 1.25 times as many as the surface is large.
    size_m = texel_m or float(np.sqrt(1.25 * whole_m2 / most))
    # A mistyped setting must not fill the memory.
    size_m = max(size_m, float(np.sqrt(whole_m2 / (_FIRST_TRIAL * most))))
    bare = np.array([kind.area_m2 == 0.0 for kind in kinds])
    cuts = [_Cut(kind.surface) for kind in kinds]
    for last in reversed(range(_ROUNDS)):
        shapes = _cut(kinds, cuts, bare, size_m, most, each)
        used = sum(
            kind.count * int(np.count_nonzero(shape.owner != UNUSED))
            for kind, shape in zip(kinds, shapes, strict=True)
            if shape is not None
        )
        enough = texel_m is not None or used == 0 or used >= _LEAST_USED * most
        if last == 0 or (enough and used <= _MOST_USED * most):
            break
        size_m *= max(float(np.sqrt(used / (0.95 * most))), _FASTEST)
    has_area = np.array([kind.area_m2 > 0.0 for kind in kinds])
    mapped = np.array([shape is not None for shape in shapes])
    number = np.where(mapped, np.cumsum(mapped) - 1, NOT_MAPPED).astype(np.int32)
    return PartShapes(
        of=number[of],
        shapes=[shape for shape in shapes if shape is not None],
        meshes=[kind.mesh for kind, shape in zip(kinds, shapes, strict=True) if shape is not None],
        needs_probes=(has_area & ~mapped)[of],
        texel_m=size_m,
    )


def _cut(
    kinds: list[_Kind],
    cuts: list[_Cut],
    bare: BoolArray,
    texel_m: float,
    budget: int,
    each: _Each,
) -> list[MeshShape | None]:
    """A shape for each kind; None for those that do without texels, which `bare` (K,) collects.

    Those in it stay there, whatever texels the others get.
    """
    sizes_m = _texel_sizes_m(kinds, texel_m, budget)
    charts: list[Charts | None] = each(
        lambda kind: None if bare[kind] else cuts[kind].charts(float(sizes_m[kind])), len(kinds)
    )
    cost = np.array([0.0 if made is None else made.texels for made in charts])
    within = np.array([kind.area_m2 for kind in kinds]) / sizes_m**2
    count = np.array([kind.count for kind in kinds])
    beside = np.maximum(cost - within, 0.0) * count
    full = np.divide(within, cost, out=np.ones_like(within), where=cost > 0.0)
    thin = (full < _THIN) & (cost * count > _TRIFLE * budget)
    excess = beside[~thin].sum() - _MOST_BESIDE * budget
    areas_m2 = count * [kind.area_m2 for kind in kinds]
    kept_m2 = areas_m2[~bare].sum() - _MOST_BARE * areas_m2.sum()
    for kind in np.argsort(full, kind="stable"):
        gives_way = thin[kind] or (excess > 0.0 and full[kind] < _SPARSE)
        if gives_way and not bare[kind] and areas_m2[kind] <= kept_m2:
            bare[kind] = True
            kept_m2 -= areas_m2[kind]
            excess -= 0.0 if thin[kind] else beside[kind]
    return each(
        lambda kind: None if bare[kind] else cuts[kind].shape(float(sizes_m[kind])), len(kinds)
    )


def _texel_sizes_m(kinds: list[_Kind], texel_m: float, budget: int) -> FloatArray:
    """The edge of a texel on each kind: smaller where a surface has finer triangles.

    A landscape's tiles and round surfaces are as fine in the map as they were modelled, if the
    budget allows. The size of triangles means nothing for surfaces in many pieces.
    """
    count = np.array([kind.count for kind in kinds])
    triangles = np.array([len(kind.surface.areas_m2) for kind in kinds])
    groups = np.array([len(kind.surface.groups.direction) for kind in kinds])
    fine = np.where(groups * _TRIANGLES_A_GROUP <= triangles, triangles, 0)
    share = min(1.0, _FINE * budget / max(int((fine * count).sum()), 1))
    least_m = [
        np.sqrt(kind.area_m2 / (share * each)) if each else texel_m
        for kind, each in zip(kinds, fine.tolist(), strict=True)
    ]
    long_m = np.array([kind.surface.least_texel_m for kind in kinds])
    return np.maximum(np.minimum(texel_m, least_m), np.maximum(long_m, 1e-3 * texel_m))


def _kinds(geometry: SceneGeometry, each: _Each) -> tuple[list[_Kind], NDArray[np.int64]]:
    """Meshes as they are stretched, and which of them each part (P,) is."""
    numbers: dict[tuple[int, ...], int] = {}
    stretches: list[tuple[int, FloatArray]] = []
    of = np.empty(len(geometry.part_mesh.values), np.int64)
    for part, mesh in enumerate(geometry.part_mesh.values.tolist()):
        stretch = _stretch(geometry.world_from_part.values[part, :3, :3])
        # Round numbers, which scales often are, lie far from where this steps.
        exponent = round(float(np.log2(max(np.abs(stretch).max(), 1e-300))))
        steps = np.round(stretch / (2.0**exponent * _SAME)).astype(np.int64)
        key = (mesh, exponent, *steps.reshape(-1).tolist())
        of[part] = numbers.setdefault(key, len(stretches))
        if of[part] == len(stretches):
            stretches.append((mesh, stretch))
    counts = np.bincount(of, minlength=len(stretches))

    def kind(number: int) -> _Kind:
        mesh, stretch = stretches[number]
        surface = stretched(geometry.mesh(mesh), stretch)
        return _Kind(mesh, surface, float(surface.areas_m2.sum()), int(counts[number]))

    return each(kind, len(stretches)), of


def _stretch(matrix: FloatArray) -> FloatArray:
    """The stretch of a linear map: its polar decomposition's symmetric factor.

    Parts that are only turned otherwise, or mirrored, share a shape.
    """
    squares = matrix.T @ matrix
    values, vectors = np.linalg.eigh(squares)
    if np.ptp(values) <= _SAME * values.max():
        return np.asarray(np.sqrt(values.mean()) * np.eye(3))
    return np.asarray((vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T)

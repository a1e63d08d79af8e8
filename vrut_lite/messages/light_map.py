"""The light map: irradiance of a scene's surfaces with occlusion and interreflection.

Its layout is posted once for a scene, its light for each hour. It excludes the key light's direct
part, which the frame draws with its shadow map.
"""

from typing import ClassVar, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import LARGEST_DEMAND, Derived
from vrut_lite.messages.late_array import LateArray
from vrut_lite.messages.limits import LARGEST_EDGE, LARGEST_VOLUME, MOST_LIGHT, check_scale
from vrut_lite.numeric_types import Float32Array, Vector

NOT_MAPPED = -1
# Slot of the module that lights surfaces; without a holder the open sky lights them.
SLOT = "light_map"
# Sizes of a demand for light that waits for a finished bake: all rays, or half of them for a still
# that traces further rays at the points of its picture (`ViewLightChanged`).
ALL_RAYS, BESIDE_POINTS = LARGEST_DEMAND, LARGEST_DEMAND - 1
_LARGEST_M = 1e10
# Largest slope of the sky's visible share with direction.
_STEEPEST = 100.0
_SHAPE_COLUMNS = 5
_FACES = 6
_SHORTEST_STEP_M = 1e-9
# Largest number of probes along an axis: their six faces lie in one texture.
_MOST_PROBES = LARGEST_VOLUME // _FACES


class Shape(NamedTuple):
    """A mesh as it is cut up for the light map: views of the layout's arrays.

    `source_vertex` (V,): the mesh's vertex that each of these copies; `uv` (V, 2): texels from the
    corner of the part's rectangle, texel centres at halves; `triangles` (F, 3): of
    these vertices, in the order of the mesh's own.
    """

    mesh: int
    source_vertex: NDArray[np.int32]
    uv: Float32Array
    triangles: NDArray[np.int32]


class GroundChart(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The ground disc's square of texels, fine in the middle and coarse far away.

    A point (x, z) that lies dx east and dz south of the disc's middle has the texel coordinates

        corner + 0.5 + (1 + asinh(sinh(warp) d / half_width_m) / warp) / 2 * (edge - 1)

    for d = dx (across) and dz (down), kept within the middles of the outermost texels.
    """

    corner_px: tuple[int, int]
    edge_px: int
    half_width_m: float
    warp: float

    @property
    def end_px(self) -> NDArray[np.int64]:
        """Past the last texel (2,), across and down."""
        return np.array(self.corner_px) + self.edge_px

    def check(self) -> None:
        """A square with some width.

        Raises:
            UserError: a field is invalid.
        """
        checks.wholes(self, "corner_px", 0, LARGEST_EDGE, most=2, least=2)
        checks.whole(self, "edge_px", 2, LARGEST_EDGE)
        checks.number(self, "half_width_m", 1e-9, _LARGEST_M)
        checks.number(self, "warp", 1e-3, 20.0)


class ProbeGrid(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Places on a regular grid along the world's axes; surfaces without texels take their light.

    The first stands at `lower_m`; `counts` are their numbers along x, y and z.
    """

    lower_m: Vector
    step_m: Vector
    counts: tuple[int, int, int]

    def check(self) -> None:
        """Two or more places along each axis.

        Raises:
            UserError: there are fewer, or too many.
        """
        checks.numbers(self, "lower_m", 3)
        checks.numbers(self, "step_m", 3)
        if min(self.step_m) < _SHORTEST_STEP_M:
            checks.refuse(self, "step_m", f"be three numbers of {_SHORTEST_STEP_M:g} or more")
        checks.wholes(self, "counts", 2, _MOST_PROBES, most=3, least=3)


class ReflectionProbes(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Parts that reflect their surroundings: each has a cube map.

    Attributes:
        part: (N,) int32, the parts of the scene.
        centre_m: (N, 3) float64, the points that the cubes are seen from, world axes.
        nearness: (N, 6, e, e) float32, inverse distance of the visible surface, in 1/m; for the
            sky, of the opening that the ray passes, or 0. Faces as in `geometry.cube_map`.
    """

    part: Array
    centre_m: Array
    nearness: Array

    def check(self) -> None:
        """Check that there are as many cubes as parts.

        Raises:
            UserError: the numbers differ.
        """
        layouts: dict[str, tuple[str, tuple[str | int, ...]]] = {
            "part": ("<i4", ("N",)),
            "centre_m": ("<f8", ("N", 3)),
            "nearness": ("<f4", ("N", _FACES, "E", "E")),
        }
        checks.arrays(self, layouts)
        _check_lengths(self, "nearness", self.nearness.shape[2:], 1, LARGEST_EDGE)

    def check_arrays(self, parts: int) -> None:
        """Check that each part is one of the scene's `parts`, named once, and numbers are finite.

        Raises:
            UserError: a part or a number is invalid.
        """
        part = self.part.values
        if np.any((part < 0) | (part >= parts)) or len(np.unique(part)) < len(part):
            raise UserError("mirrors of a LightMapLaid must name parts, each once")
        checks.contents(self, "centre_m", -_LARGEST_M, _LARGEST_M)
        checks.contents(self, "nearness", 0.0, 1.0 / _SHORTEST_STEP_M)


class LightMapLaid(Derived, frozen=True, kw_only=True):
    """The layout of a scene's light map.

    Attributes:
        content_key: the scene's (`SceneOpened.content_key`).
        layout_key: key of this layout; `SurfaceLightChanged` names its layout.
        size_px: width and height of the map.
        shapes: (S, 5) int64, a row a shape: its mesh, first row of `source_vertex` and `uv`,
            their number, first row of `triangles`, their number.
        source_vertex: (V,) int32, see `Shape`.
        uv: (V, 2) float32, see `Shape`.
        triangles: (F, 3) int32, vertex numbers that count from the shape's first.
        part_shape: (P,) int32, the shape of each of the scene's parts; -1 where it has no texels
            and takes its light from the probes.
        part_corner_px: (P, 2) int32, the corner of the part's rectangle in the map.
        ground: chart of the ground disc, where the scene has one.
        probes: None where everything has texels.
        mirrors: None where no part has a cube map.
    """

    slot: ClassVar[str | None] = SLOT

    content_key: str
    layout_key: str
    size_px: tuple[int, int]
    shapes: Array
    source_vertex: Array
    uv: Array
    triangles: Array
    part_shape: Array
    part_corner_px: Array
    ground: GroundChart | None
    probes: ProbeGrid | None
    source: str
    mirrors: ReflectionProbes | None = None

    def shape(self, number: int) -> Shape:
        """Shape of this number."""
        mesh, vertex, vertices, triangle, triangles = map(int, self.shapes.values[number])
        return Shape(
            mesh,
            self.source_vertex.values[vertex : vertex + vertices],
            self.uv.values[vertex : vertex + vertices],
            self.triangles.values[triangle : triangle + triangles],
        )

    def check(self) -> None:
        """Check sizes that a GPU can hold, and arrays whose shapes match."""
        checks.text(self, "content_key", "layout_key", "source")
        checks.wholes(self, "size_px", 1, LARGEST_EDGE, most=2, least=2)
        checks.arrays(
            self,
            {
                "shapes": ("<i8", ("S", _SHAPE_COLUMNS)),
                "source_vertex": ("<i4", ("V",)),
                "uv": ("<f4", ("V", 2)),
                "triangles": ("<i4", ("F", 3)),
                "part_shape": ("<i4", ("P",)),
                "part_corner_px": ("<i4", ("P", 2)),
            },
        )
        for name, kind in (
            ("ground", GroundChart),
            ("probes", ProbeGrid),
            ("mirrors", ReflectionProbes),
        ):
            part = getattr(self, name)
            checks.instance(self, name, (kind, type(None)))
            if part is not None:
                part.check()
        if self.ground is not None and np.any(self.ground.end_px > np.array(self.size_px)):
            checks.refuse(self, "ground", f"lie within {self.size_px} texels")

    def check_arrays(self) -> None:
        """Check that shapes and their triangles lie within the arrays, and parts name a shape.

        Raises:
            UserError: a shape or a part is invalid.
        """
        mesh, vertex, vertices, triangle, triangles = self.shapes.values.T
        _check_rows(vertex, vertices, len(self.uv.values))
        _check_rows(triangle, triangles, len(self.triangles.values))
        if np.any(mesh < 0) or np.any(self.source_vertex.values < 0):
            raise UserError("a shape of a LightMapLaid names what no mesh has")
        for number in range(len(mesh)):
            corners = self.shape(number).triangles
            if corners.size and (corners.min() < 0 or corners.max() >= vertices[number]):
                raise UserError("triangles of a LightMapLaid reach beyond their shape")
        if not np.all(np.isfinite(self.uv.values)):
            raise UserError("uv of a LightMapLaid must hold finite numbers")
        shape = self.part_shape.values
        if np.any((shape < NOT_MAPPED) | (shape >= len(mesh))):
            raise UserError("a part of a LightMapLaid names a shape that is not there")
        if self.mirrors is not None:
            self.mirrors.check_arrays(len(shape))


class SurfaceLightChanged(Derived, frozen=True, kw_only=True):
    """The light of an hour on the surfaces of a scene.

    The size of a demand for it is a number of rays per texel: light of fewer rays is computed only
    if no more can be traced.

    Attributes:
        layout_key: key of its layout.
        texels: (height, width, 4) float16, or late float32 numbers, which a card computes for
            pictures; probes and mirrors are late where texels are. RGB times `radiance_scale` is
            irradiance, linear sRGB in W m^-2: of the sky and of light from surfaces, without the
            key light's direct part; alpha is the share of the open sky's irradiance that arrives,
            0 to 1.
        probes: (nz, ny, nx, 6, 4) float16, the same on small planes that face +x, -x, +y, -y, +z
            and -z; None where the layout has no probes.
        rays: number of rays of each texel.
        sky_level: `AmbientChanged.level` of the hour; None where it is not known.
        visible_sky: (height, width, 4) float16: the share of the sky that is seen from a texel in
            direction d, world axes, is RGB . d + alpha, clamped to [0, 1]. None where unknown:
            the share of the sky's irradiance is then used.
        mirrors: (N, 6, e, e, 4) float16, the cube maps of the layout's mirrors. RGB times
            `radiance_scale` is radiance in W m^-2 sr^-1, weighted by alpha: the share of a texel
            that is neither sky nor ground beyond the map, 0 to 1. None where the layout has no
            mirrors.
    """

    slot: ClassVar[str | None] = SLOT

    layout_key: str
    texels: Array | LateArray
    probes: Array | LateArray | None
    radiance_scale: float
    rays: int
    source: str
    mirrors: Array | LateArray | None = None
    visible_sky: Array | None = None
    sky_level: float | None = None

    def check(self) -> None:
        """Arrays of these shapes."""
        if self.sky_level is not None:
            checks.number(self, "sky_level", 0.0, MOST_LIGHT)
        checks.text(self, "layout_key", "source")
        self._check_light("texels", ("H", "W", 4))
        _check_lengths(self, "texels", self.texels.shape[:2], 1, LARGEST_EDGE)
        if self.probes is not None:
            self._check_light("probes", ("Z", "Y", "X", _FACES, 4))
            _check_lengths(self, "probes", self.probes.shape[:3], 2, _MOST_PROBES)
        if self.visible_sky is not None:
            height, width = self.texels.shape[:2]
            checks.arrays(self, {"visible_sky": ("<f2", (height, width, 4))})
        if self.mirrors is not None:
            self._check_light("mirrors", ("N", _FACES, "E", "E", 4))
            _check_lengths(self, "mirrors", self.mirrors.shape[2:4], 1, LARGEST_EDGE)
        check_scale(self)
        checks.whole(self, "rays", 1, 2**40)

    def _check_light(self, name: str, shape: tuple[int | str, ...]) -> None:
        value = getattr(self, name)
        if not isinstance(value, LateArray):
            checks.arrays(self, {name: ("<f2", shape)})
        elif len(value.shape) != len(shape) or not isinstance(self.texels, LateArray):
            checks.refuse(self, name, f"be of shape {shape}, and late where texels are")

    def check_arrays(self) -> None:
        """Light within its bounds, and shares of the sky.

        Raises:
            UserError: a value lies outside its bounds.
        """
        most = MOST_LIGHT / self.radiance_scale
        for name in ("texels", "probes", "mirrors"):
            if getattr(self, name) is not None:
                checks.contents(self, name, 0.0, max(most, 1.0))
                if float(getattr(self, name).values[..., 3].max(initial=0.0)) > 1.0:
                    raise UserError(f"{name} of a SurfaceLightChanged hold shares above 1")
        if self.visible_sky is not None:
            checks.contents(self, "visible_sky", -_STEEPEST, _STEEPEST)

    def fits(self, laid: LightMapLaid) -> bool:
        """Whether this is light of that layout: by name, and by size."""
        counts = None if laid.probes is None else laid.probes.counts
        found = None if self.probes is None else self.probes.shape[2::-1]
        same_size = self.texels.shape[1::-1] == tuple(laid.size_px)
        cubes = None if laid.mirrors is None else laid.mirrors.nearness.shape
        seen = None if self.mirrors is None else self.mirrors.shape[:4]
        same_size = same_size and found == counts and cubes == seen
        return self.layout_key == laid.layout_key and same_size


def _check_rows(first: NDArray, count: NDArray, length: int) -> None:
    if np.any((first < 0) | (count < 0) | (first + count > length)):
        raise UserError("shapes of a LightMapLaid reach beyond its arrays")


def _check_lengths(
    message: object, name: str, lengths: tuple[int, ...], low: int, high: int
) -> None:
    if not all(low <= length <= high for length in lengths):
        checks.refuse(message, name, f"have edges of {low} to {high}")

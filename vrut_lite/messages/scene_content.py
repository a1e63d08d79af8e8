"""The geometry and the materials of an opened scene, as immutable arrays in a message.

All meshes lie in a few long arrays, and all texels in one: a journal then names a scene of any
size in some kilobytes, and a compiled kernel walks through it as it is.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.messages.surface_terms import TERM_COLUMNS, SurfaceTerms, from_row
from vrut_lite.numeric_types import Float32Array, FloatArray

AlphaMode = Literal["OPAQUE", "MASK", "BLEND"]
MapName = Literal[
    "base_colour",
    "metallic_roughness",
    "normal",
    "occlusion",
    "emission",
    "specular",
    "specular_colour",
    "clearcoat",
    "transmission",
    "iridescence",
    "iridescence_thickness",
]
Wrap = Literal["repeat", "clamp", "mirror"]
ALPHA_MODES: tuple[AlphaMode, ...] = get_args(AlphaMode)
MAP_NAMES: tuple[MapName, ...] = get_args(MapName)
# Maps whose texels are sRGB-encoded.
COLOUR_MAPS: tuple[MapName, ...] = ("base_colour", "emission", "specular_colour")
WRAPS: tuple[Wrap, ...] = get_args(Wrap)
NONE = -1
# Columns of `SceneGeometry.meshes`.
_MESH_COLUMNS = 8


class Mesh(NamedTuple):
    """One mesh, as views of the scene's arrays.

    positions_m (V, 3) and unit normals (V, 3) in the mesh's own axes; triangles (F, 3) of
    vertex numbers, counter-clockwise seen from outside; texture coordinates uv (V, 2), v upwards,
    and a second layer of them; colours (V, 4), linear RGBA in [0, 1], which multiply the base
    colour; the number of its material.
    """

    positions_m: FloatArray
    normals: FloatArray
    triangles: NDArray[np.int32]
    uv: FloatArray | None
    second_uv: FloatArray | None
    colours_rgba: Float32Array | None
    material: int


class SceneGeometry(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Triangle meshes, and the places (parts) where they stand.

    Meshes may share vertices, and a mesh may stand in many places.

    Attributes:
        positions_m: (V, 3) float64, metres, in the axes of the mesh.
        normals: (V, 3) float64, unit vectors in the same axes.
        uv: (U, 2) float64, texture coordinates of both layers, v upwards.
        colours_rgba: (C, 4) float32, linear, in [0, 1].
        triangles: (F, 3) int32, vertex numbers that count from the first of their mesh.
        meshes: (M, 8) int64, a row a mesh: first vertex, vertices, first triangle, triangles,
            first row of `uv`, of the second layer in `uv`, and of `colours_rgba` (-1 without it),
            and its material.
        part_mesh: (P,) int32, the mesh of each part.
        world_from_part: (P, 4, 4) float64, from the mesh's axes to the world's.
    """

    positions_m: Array
    normals: Array
    uv: Array
    colours_rgba: Array
    triangles: Array
    meshes: Array
    part_mesh: Array
    world_from_part: Array

    @property
    def mesh_count(self) -> int:
        """How many meshes there are."""
        return self.meshes.shape[0]

    def mesh(self, number: int) -> Mesh:
        """One of the meshes."""
        row = [int(value) for value in self.meshes.values[number]]
        vertex, vertices, triangle, triangles, uv, second_uv, colour, material = row

        def rows(array: Array, first: int) -> NDArray | None:
            return None if first == NONE else array.values[first : first + vertices]

        return Mesh(
            self.positions_m.values[vertex : vertex + vertices],
            self.normals.values[vertex : vertex + vertices],
            self.triangles.values[triangle : triangle + triangles],
            rows(self.uv, uv),
            rows(self.uv, second_uv),
            rows(self.colours_rgba, colour),
            material,
        )

    def world_triangles(self, part: int) -> FloatArray:
        """The corners (F, 3, 3) of a part's triangles in world axes, metres."""
        mesh = self.mesh(int(self.part_mesh.values[part]))
        matrix = self.world_from_part.values[part]
        corners = mesh.positions_m[mesh.triangles]
        return np.asarray(corners @ matrix[:3, :3].T + matrix[:3, 3])

    def check(self) -> None:
        """Arrays of the types and shapes that are named above.

        Raises:
            UserError: an array is invalid.
        """
        checks.arrays(
            self,
            {
                "positions_m": ("<f8", ("V", 3)),
                "normals": ("<f8", ("V", 3)),
                "uv": ("<f8", ("U", 2)),
                "colours_rgba": ("<f4", ("C", 4)),
                "triangles": ("<i4", ("F", 3)),
                "meshes": ("<i8", ("M", _MESH_COLUMNS)),
                "part_mesh": ("<i4", ("P",)),
                "world_from_part": ("<f8", ("P", 4, 4)),
            },
        )

    def check_arrays(self) -> None:
        """Meshes that lie within the arrays, and parts that name a mesh.

        Raises:
            UserError: a mesh or a part is invalid.
        """
        vertex, vertices, triangle, triangles, *firsts, _ = self.meshes.values.T
        ranges = [(vertex, vertices, self.positions_m), (triangle, triangles, self.triangles)]
        optional = (self.uv, self.uv, self.colours_rgba)
        for first, array in zip(firsts, optional, strict=True):
            has = first != NONE
            ranges.append((first[has], vertices[has], array))
        for first, count, array in ranges:
            if np.any((first < 0) | (count < 0) | (first + count > array.shape[0])):
                raise UserError("meshes of a SceneGeometry reach beyond its arrays")
        if np.any((self.part_mesh.values < 0) | (self.part_mesh.values >= self.mesh_count)):
            raise UserError("a part of a SceneGeometry names a mesh that is not there")


class Sampler(NamedTuple):
    """Wrapping of a map along u and along v, and whether enlarged texels show as squares.

    Several texels in a pixel are averaged, whatever the sampler.
    """

    wrap_u: Wrap = "repeat"
    wrap_v: Wrap = "repeat"
    nearest: bool = False


class MaterialMap(NamedTuple):
    """Texels (h, w, 3 or 4) uint8, row 0 at v = 1, and which layer of coordinates finds them.

    Those of `COLOUR_MAPS` are sRGB-encoded. Alpha multiplies `specular`, red multiplies
    `clearcoat` and `transmission`; the others are as in glTF's core.
    """

    texels: NDArray[np.uint8]
    uv_layer: int
    sampler: Sampler = Sampler()


@dataclass(frozen=True)
class Material:
    """A surface with glTF 2.0's metallic-roughness parameters; colours are linear sRGB.

    `emission_rgb` is in cd m^-2 as glTF gives it; maps multiply the factors.
    """

    name: str
    base_colour_rgba: FloatArray
    metallic: float
    roughness: float
    emission_rgb: FloatArray
    alpha_mode: AlphaMode
    alpha_cutoff: float
    double_sided: bool
    normal_scale: float
    occlusion_strength: float
    maps: Mapping[MapName, MaterialMap]
    terms: SurfaceTerms


class SceneMaterials(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The materials (K of them) of a scene and their images (I); see `Material` for the units.

    Attributes:
        names: uint8, UTF-8, a line a material.
        base_colour_rgba: (K, 4) float64.
        metallic, roughness, alpha_cutoff, normal_scale, occlusion_strength: (K,) float64.
        emission_rgb: (K, 3) float64.
        alpha_mode: (K,) uint8, by `ALPHA_MODES`.
        double_sided: (K,) bool.
        terms: (K, TERM_COLUMNS) float64, as `surface_terms.as_row` has them.
        map_image: (K, M) int32, images by `MAP_NAMES`, -1 without an image.
        map_uv_layer: (K, M) uint8.
        map_sampler: (K, M, 3) uint8: along u and v by `WRAPS`, and 1 for the nearest texel.
        images: (I, 4) int64: first texel in bytes, height, width, channels.
        texels: uint8, the images one after another, row by row.
    """

    names: Array
    base_colour_rgba: Array
    metallic: Array
    roughness: Array
    emission_rgb: Array
    alpha_mode: Array
    alpha_cutoff: Array
    double_sided: Array
    normal_scale: Array
    occlusion_strength: Array
    terms: Array
    map_image: Array
    map_uv_layer: Array
    map_sampler: Array
    images: Array
    texels: Array

    def all(self) -> list[Material]:
        """Every material, in order."""
        names = bytes(self.names.values).decode().split("\n")
        return [self._material(number, name) for number, name in enumerate(names)]

    def _material(self, number: int, name: str) -> Material:
        layers, samplers = self.map_uv_layer.values[number], self.map_sampler.values[number]
        images = enumerate(self.map_image.values[number])
        return Material(
            name=name,
            base_colour_rgba=self.base_colour_rgba.values[number],
            metallic=float(self.metallic.values[number]),
            roughness=float(self.roughness.values[number]),
            emission_rgb=self.emission_rgb.values[number],
            alpha_mode=ALPHA_MODES[self.alpha_mode.values[number]],
            alpha_cutoff=float(self.alpha_cutoff.values[number]),
            double_sided=bool(self.double_sided.values[number]),
            normal_scale=float(self.normal_scale.values[number]),
            occlusion_strength=float(self.occlusion_strength.values[number]),
            maps={
                MAP_NAMES[column]: MaterialMap(
                    self._image(image), int(layers[column]), _sampler(samplers[column])
                )
                for column, image in images
                if image != NONE
            },
            terms=from_row(self.terms.values[number]),
        )

    def _image(self, number: int) -> NDArray[np.uint8]:
        first, height, width, channels = (int(value) for value in self.images.values[number])
        texels = self.texels.values[first : first + height * width * channels]
        return np.asarray(texels.reshape(height, width, channels))

    def check(self) -> None:
        """Arrays of the types and shapes that are named above.

        Raises:
            UserError: an array is invalid.
        """
        factors = ("metallic", "roughness", "alpha_cutoff", "normal_scale", "occlusion_strength")
        checks.arrays(
            self,
            {
                "names": ("|u1", ("N",)),
                "base_colour_rgba": ("<f8", ("K", 4)),
                "emission_rgb": ("<f8", ("K", 3)),
                "alpha_mode": ("|u1", ("K",)),
                "double_sided": ("|b1", ("K",)),
                "map_image": ("<i4", ("K", len(MAP_NAMES))),
                "map_uv_layer": ("|u1", ("K", len(MAP_NAMES))),
                "map_sampler": ("|u1", ("K", len(MAP_NAMES), 3)),
                "terms": ("<f8", ("K", TERM_COLUMNS)),
                "images": ("<i8", ("I", 4)),
                "texels": ("|u1", ("T",)),
                **dict.fromkeys(factors, ("<f8", ("K",))),
            },
        )


def _sampler(row: NDArray[np.uint8]) -> Sampler:
    return Sampler(WRAPS[row[0]], WRAPS[row[1]], bool(row[2]))

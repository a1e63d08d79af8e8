"""A scene's triangles as light transport sees them: places, reflectance, emission."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from light_transport.surfaces.map_means import linear, shares, triangle_means
from light_transport.surfaces.terms import SentBack, sent_back
from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.scene_content import MapName, Material, Mesh
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

GROUND = -1
# Half the width of the ground's square, in radii of the scene; beyond it is open ground.
_GROUND_RADII = 4.0
_SMALLEST_RADIUS_M = 1e-6


@dataclass(frozen=True, eq=False)
class Surfaces:
    """The triangles (F) of a scene, part after part, the ground's last.

    Triangle k of a part is triangle k of its mesh. All surfaces are taken for Lambert's.

    Attributes:
        corners_m: (F, 3, 3) float64, world axes, counted from `centre_m`.
        normals: (F, 3, 3) float32, unit shading normals of the corners, world axes.
        part: (F,) int32, the scene's part, or GROUND.
        reflectance_rgb: (F, 3) float32, share of diffuse light that is sent back, coat included;
            0 for the ground, whose albedo comes with the hour.
        emitted_rgb: (F, 3) float32, radiosity in W m^-2.
        roughness: (F,) float32, of the coat or metal.
        opacity: (F,) float32, share of light that does not pass straight through.
        double_sided: (F,) bool.
        centre_m: (3,) float64, the middle of the scene's bounds.
        radius_m: half the diagonal of the scene's bounds.
    """

    corners_m: FloatArray
    normals: Float32Array
    part: NDArray[np.int32]
    reflectance_rgb: Float32Array
    emitted_rgb: Float32Array
    roughness: Float32Array
    opacity: Float32Array
    double_sided: BoolArray
    centre_m: FloatArray
    radius_m: float

    @property
    def arrays(self) -> list[NDArray]:
        """All that grow with the number of triangles."""
        return [value for value in vars(self).values() if isinstance(value, np.ndarray)]

    def without_shapes(self) -> "Surfaces":
        """Parts, colours and the frame alone, for callers with their own form of the shapes."""
        nothing = np.empty((0, 3, 3))
        return replace(
            self,
            corners_m=nothing,
            normals=nothing.astype(np.float32),
            opacity=np.empty(0, np.float32),
            double_sided=np.empty(0, bool),
        )

    def colours_of(self, triangles: NDArray[np.integer]) -> "Surfaces":
        """Some of them, `without_shapes`."""
        return replace(
            self.without_shapes(),
            part=self.part[triangles],
            reflectance_rgb=self.reflectance_rgb[triangles],
            emitted_rgb=self.emitted_rgb[triangles],
            roughness=self.roughness[triangles],
        )

    def face_normals(self) -> FloatArray:
        """Unit normals (F, 3) of the triangles, on the side of their shading normals.

        The frame has it so too; it makes mirrored parts right. 0 where a triangle has no area.
        """
        a, b, c = np.moveaxis(self.corners_m, 1, 0)
        normal = np.cross(b - a, c - a)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        unit = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
        turned = np.einsum("fi,fi->f", unit, self.normals.sum(axis=1, dtype=np.float64)) < 0.0
        unit[turned] *= -1.0
        return unit


def surfaces_of(scene: SceneOpened) -> Surfaces:
    """All triangles of a scene, and the middle of the ground disc that it stands on."""
    geometry, materials = scene.geometry, scene.materials.all()
    lower_m, upper_m = np.asarray(scene.lower_m), np.asarray(scene.upper_m)
    centre_m = 0.5 * (lower_m + upper_m)
    radius_m = max(0.5 * float(np.linalg.norm(upper_m - lower_m)), _SMALLEST_RADIUS_M)
    skins = _skins([geometry.mesh(n) for n in range(geometry.mesh_count)], materials)
    pieces = [
        _Piece(
            geometry.world_triangles(part) - centre_m,
            _moved_normals(skins[mesh].corner_normals, geometry.world_from_part.values[part]),
            part,
            skins[mesh],
        )
        for part, mesh in enumerate(geometry.part_mesh.values.tolist())
    ]
    if scene.ground is not None:
        pieces.append(_ground(scene.ground, centre_m, radius_m))
    return _joined(pieces, centre_m, radius_m)


@dataclass(frozen=True, eq=False)
class _Skin:
    """The common arrays of all parts of one mesh, as in `Surfaces`."""

    corner_normals: FloatArray
    reflectance_rgb: Float32Array
    emitted_rgb: Float32Array
    roughness: Float32Array
    opacity: Float32Array
    double_sided: bool


@dataclass(frozen=True, eq=False)
class _Piece:
    corners_m: FloatArray
    normals: Float32Array
    part: int
    skin: _Skin


def _skins(meshes: list[Mesh], materials: list[Material]) -> list[_Skin]:
    """Those of meshes.

    Meshes that are alike in material and kinds of arrays are done at once: a landscape's tiles
    share large maps.
    """
    alike: dict[tuple[bool | int, ...], list[int]] = {}
    for number, mesh in enumerate(meshes):
        layers = (mesh.uv, mesh.second_uv, mesh.colours_rgba)
        key = (mesh.material, *(layer is None for layer in layers))
        alike.setdefault(key, []).append(number)
    skins: dict[int, _Skin] = {}
    for numbers in alike.values():
        together = [meshes[number] for number in numbers]
        skin = _skin(_one_mesh(together), materials)
        ends = np.cumsum([len(mesh.triangles) for mesh in together])[:-1]
        arrays = (
            skin.corner_normals, skin.reflectance_rgb, skin.emitted_rgb, skin.roughness,
            skin.opacity,
        )  # fmt: skip
        pieces = zip(*(np.split(array, ends) for array in arrays), strict=True)
        for number, piece in zip(numbers, pieces, strict=True):
            normals, reflectance_rgb, emitted_rgb, roughness, opacity = piece
            skins[number] = _Skin(
                normals, reflectance_rgb, emitted_rgb, roughness, opacity, skin.double_sided
            )
    return [skins[number] for number in range(len(meshes))]


def _one_mesh(meshes: list[Mesh]) -> Mesh:
    """Meshes of one material one after another."""
    if len(meshes) == 1:
        return meshes[0]
    firsts = np.cumsum([0, *(len(mesh.positions_m) for mesh in meshes)])[:-1]
    moved = [mesh.triangles + np.int32(first) for mesh, first in zip(meshes, firsts, strict=True)]

    def joined(arrays: list[NDArray | None]) -> NDArray | None:
        present = [array for array in arrays if array is not None]
        return np.concatenate(present) if present else None

    return Mesh(
        np.concatenate([mesh.positions_m for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate(moved),
        joined([mesh.uv for mesh in meshes]),
        joined([mesh.second_uv for mesh in meshes]),
        joined([mesh.colours_rgba for mesh in meshes]),
        meshes[0].material,
    )


def _skin(mesh: Mesh, materials: list[Material]) -> _Skin:
    material = materials[mesh.material]
    vertex_rgba = _of_triangles(mesh)
    back, roughness = _sent_back(mesh, material, vertex_rgba[:, :3])
    return _Skin(
        mesh.normals[mesh.triangles],
        back.reflectance_rgb,
        _emitted_rgb(mesh, material),
        roughness,
        _opacity(mesh, material, vertex_rgba[:, 3]) * (1.0 - back.passing),
        material.double_sided,
    )


def _of_triangles(mesh: Mesh) -> Float32Array:
    """The mean colour (F, 4) of each triangle's vertices, 1 where they have none."""
    if mesh.colours_rgba is None:
        return np.ones((len(mesh.triangles), 4), np.float32)
    return np.asarray(mesh.colours_rgba[mesh.triangles].mean(axis=1), np.float32)


def _map_means(mesh: Mesh, material: Material, name: MapName) -> Float32Array | None:
    """Means (F, 3) of a map's colour, linear where it is a colour."""
    found = material.maps.get(name)
    if found is None:
        return None
    is_colour = name in ("base_colour", "emission")
    decode = linear if is_colour else shares
    return triangle_means(found, mesh, lambda texels: decode(texels[..., :3]))


def _sent_back(
    mesh: Mesh, material: Material, vertex_rgb: Float32Array
) -> tuple[SentBack, Float32Array]:
    """Diffuse shares of paint under its coat, of metal or of glass; and roughness (F,)."""
    colour = vertex_rgb * np.asarray(material.base_colour_rgba[:3], np.float32)
    texels = _map_means(mesh, material, "base_colour")
    if texels is not None:
        colour = colour * texels
    roughness = np.full((len(colour), 1), material.roughness)
    metallic = np.full((len(colour), 1), material.metallic)
    both = _map_means(mesh, material, "metallic_roughness")
    if both is not None:
        roughness, metallic = roughness * both[:, 1:2], metallic * both[:, 2:3]
    back = sent_back(mesh, material, colour.astype(np.float64), roughness, metallic)
    return back, np.clip(roughness[:, 0], 0.0, 1.0).astype(np.float32)


def _emitted_rgb(mesh: Mesh, material: Material) -> Float32Array:
    """pi L of glTF's cd m^-2, in W m^-2."""
    emitted = np.pi * material.emission_rgb / LUMENS_PER_WATT
    texels = _map_means(mesh, material, "emission") if np.any(emitted) else None
    by_triangle = np.ones((len(mesh.triangles), 3)) if texels is None else texels
    return np.asarray(emitted * by_triangle, np.float32)


def _opacity(mesh: Mesh, material: Material, vertex_alpha: Float32Array) -> Float32Array:
    if material.alpha_mode == "OPAQUE":
        return np.ones(len(mesh.triangles), np.float32)
    is_cut = material.alpha_mode == "MASK"
    alpha = np.float32(material.base_colour_rgba[3])

    def decode(texels: NDArray[np.uint8]) -> Float32Array:
        own = shares(texels[..., 3:]) * alpha
        return np.asarray(own >= material.alpha_cutoff, np.float32) if is_cut else own

    found = material.maps.get("base_colour")
    means = None
    if found is not None and found.texels.shape[2] == 4:
        means = triangle_means(found, mesh, decode)
    if means is not None:
        # Vertices' alpha seldom goes with a cut-out map; it then scales the map's.
        return np.asarray(np.clip(means[:, 0] * vertex_alpha, 0.0, 1.0), np.float32)
    own = alpha * vertex_alpha
    return np.asarray(
        own >= material.alpha_cutoff if is_cut else np.clip(own, 0.0, 1.0), np.float32
    )


def _moved_normals(normals: FloatArray, matrix: NDArray[np.float64]) -> Float32Array:
    """Unit normals (F, 3, 3) in the world: by the cofactors, which exist for flat matrices too."""
    a, b, c = matrix[:3, 0], matrix[:3, 1], matrix[:3, 2]
    cofactors = np.column_stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        cofactors = -cofactors
    moved = normals @ (cofactors / max(np.abs(cofactors).max(), 1e-300)).T
    length = np.linalg.norm(moved, axis=-1, keepdims=True)
    return np.asarray(moved / np.maximum(length, 1e-30), np.float32)


def _ground(ground: GroundDisc, centre_m: FloatArray, radius_m: float) -> _Piece:
    """A level square, turned up."""
    half_m = min(_GROUND_RADII * radius_m, ground.radius_m)
    x, z = ground.centre_xz_m
    west, east, north, south = x - half_m, x + half_m, z - half_m, z + half_m
    y = ground.height_m
    square = np.array([[west, y, north], [west, y, south], [east, y, south], [east, y, north]])
    up = np.tile([0.0, 1.0, 0.0], (2, 3, 1))
    black = np.zeros((2, 3), np.float32)
    matte = np.ones(2, np.float32)
    skin = _Skin(up, black, black, matte, np.ones(2, np.float32), False)
    corners_m = square[np.array([[0, 1, 2], [0, 2, 3]])] - centre_m
    return _Piece(corners_m, up.astype(np.float32), GROUND, skin)


def _joined(pieces: list[_Piece], centre_m: FloatArray, radius_m: float) -> Surfaces:
    counts = [len(piece.corners_m) for piece in pieces]
    skins = [piece.skin for piece in pieces]
    return Surfaces(
        corners_m=np.concatenate([np.empty((0, 3, 3)), *(piece.corners_m for piece in pieces)]),
        normals=np.concatenate(
            [np.empty((0, 3, 3), np.float32), *(piece.normals for piece in pieces)]
        ),
        part=np.repeat(np.array([piece.part for piece in pieces], np.int32), counts),
        reflectance_rgb=np.concatenate(
            [np.empty((0, 3), np.float32), *(skin.reflectance_rgb for skin in skins)]
        ),
        emitted_rgb=np.concatenate(
            [np.empty((0, 3), np.float32), *(skin.emitted_rgb for skin in skins)]
        ),
        roughness=np.concatenate([np.empty(0, np.float32), *(skin.roughness for skin in skins)]),
        opacity=np.concatenate([np.empty(0, np.float32), *(skin.opacity for skin in skins)]),
        double_sided=np.repeat(np.array([skin.double_sided for skin in skins], bool), counts),
        centre_m=centre_m,
        radius_m=radius_m,
    )

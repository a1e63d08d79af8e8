"""Packs a loaded scene into its message: immutable arrays."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.array import Array
from vrut_lite.messages.camera import camera_from_pose
from vrut_lite.messages.ground_disc import disc_under
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.messages.scene_content import (
    ALPHA_MODES,
    MAP_NAMES,
    NONE,
    WRAPS,
    MapName,
    Sampler,
    SceneGeometry,
    SceneMaterials,
)
from vrut_lite.messages.surface_terms import as_row
from vrut_lite.numeric_types import vector
from vrut_lite.scene.border import border_albedo
from vrut_lite.scene.ground import has_own_ground
from vrut_lite.scene.loading import LoadedScene
from vrut_lite.scene.materials import SurfaceMaterial
from vrut_lite.scene.mesh import TriangleMesh

_GLTF_NAMES: dict[MapName, str] = {
    "base_colour": "baseColorTexture",
    "metallic_roughness": "metallicRoughnessTexture",
    "normal": "normalTexture",
    "occlusion": "occlusionTexture",
    "emission": "emissiveTexture",
}
# A material's name beyond it is cut off, so that no file can swell the message.
_LONGEST_NAME = 80


class _Rows:
    """Arrays (n, columns) to be joined into one."""

    def __init__(self, columns: int, dtype: type):
        self._joined: list[NDArray[Any]] = [np.empty((0, columns), dtype)]
        self._dtype = dtype
        self.count = 0

    def add(self, rows: NDArray[Any]) -> int:
        """The number of its first row in the joined array."""
        first, self.count = self.count, self.count + len(rows)
        self._joined.append(rows)
        return first

    def array(self) -> Array:
        """All of them."""
        return Array(np.concatenate(self._joined, dtype=self._dtype, casting="same_kind"))


class _Geometry:
    """Joins the arrays of meshes; shared arrays are stored once."""

    def __init__(self) -> None:
        self._positions, self._normals = _Rows(3, np.float64), _Rows(3, np.float64)
        self._uv, self._colours = _Rows(2, np.float64), _Rows(4, np.float32)
        self._triangles = _Rows(3, np.int32)
        self._first_rows: dict[tuple[Any, ...], int] = {}
        self._table: list[tuple[int, ...]] = []

    def add(self, mesh: TriangleMesh, material: int) -> None:
        """Add a mesh with this material."""
        first = self._first_row(self._positions, mesh.vertices, mesh.normals)
        if self._normals.count == first:
            self._normals.add(mesh.normals)
        self._table.append(
            (
                first,
                len(mesh.vertices),
                self._first_row(self._triangles, mesh.faces),
                len(mesh.faces),
                self._first_row(self._uv, mesh.uv),
                self._first_row(self._uv, mesh.second_uv),
                self._first_row(self._colours, mesh.colours),
                material,
            )
        )

    def _first_row(self, rows: _Rows, values: NDArray[Any] | None, *beside: NDArray[Any]) -> int:
        """The first row of values in the joined array, the same for equal values; NONE for None.

        Kept arrays keep their memory, so that addresses identify contents.
        """
        if values is None:
            return NONE
        key = (id(rows), *(_place(part) for part in (values, *beside)))
        if key not in self._first_rows:
            self._first_rows[key] = rows.add(values)
        return self._first_rows[key]

    def joined(self, part_mesh: list[int], world_from_part: list[NDArray]) -> SceneGeometry:
        """All meshes, and their places."""
        return SceneGeometry(
            positions_m=self._positions.array(),
            normals=self._normals.array(),
            uv=self._uv.array(),
            colours_rgba=self._colours.array(),
            triangles=self._triangles.array(),
            meshes=Array(np.array(self._table, np.int64)),
            part_mesh=Array(np.array(part_mesh, np.int32)),
            world_from_part=Array(np.array(world_from_part, np.float64)),
        )


def _place(array: NDArray[Any]) -> tuple[Any, ...]:
    """Key of an array: equal for arrays of the same memory."""
    return array.__array_interface__["data"][0], array.shape, array.strides


def packed(loaded: LoadedScene) -> SceneOpened:
    """The message of a scene, with the ground under it."""
    own, camera = loaded.camera, None
    if own is not None:
        camera = camera_from_pose(own.world_from_camera, own.vertical_field_of_view_rad)
    ground = None if has_own_ground(loaded) else disc_under(loaded.lower_m, loaded.upper_m)
    meshes = list({id(place.mesh): place.mesh for place in loaded.meshes}.values())
    materials = list({id(mesh.material): mesh.material for mesh in meshes}.values())
    return SceneOpened(
        path=str(loaded.path),
        lower_m=vector(loaded.lower_m),
        upper_m=vector(loaded.upper_m),
        triangles=loaded.triangles,
        geometry=_geometry(loaded, meshes, materials),
        materials=_materials(materials),
        ground=ground,
        border_rgb=border_albedo(loaded),
        camera=camera,
        lamps=loaded.lamps,
        notices=loaded.notices,
        opened=LoadScene(
            path=str(loaded.path),
            placement=loaded.placement,
            beside=loaded.beside,
            camera=own.name if own is not None and own is not loaded.cameras[0] else "",
            luminaires=loaded.luminaires,
            variant=loaded.variant,
            glazing=loaded.glazing,
        ),
        cameras=tuple(camera.name for camera in loaded.cameras),
        variants=loaded.variants,
        points_and_lines=loaded.points_and_lines,
        animation_s=loaded.animation_s,
    )


def _geometry(
    loaded: LoadedScene, meshes: list[TriangleMesh], materials: list[SurfaceMaterial]
) -> SceneGeometry:
    geometry = _Geometry()
    material_numbers = {id(material): number for number, material in enumerate(materials)}
    for mesh in meshes:
        geometry.add(mesh, material_numbers[id(mesh.material)])
    numbers = {id(mesh): number for number, mesh in enumerate(meshes)}
    return geometry.joined(
        [numbers[id(place.mesh)] for place in loaded.meshes],
        [place.world_from_model for place in loaded.meshes],
    )


def _materials(materials: list[SurfaceMaterial]) -> SceneMaterials:
    images: list[Image.Image] = []
    numbers_of_images: dict[int, int] = {}
    maps = np.full((len(materials), len(MAP_NAMES)), NONE, np.int32)
    layers = np.zeros((len(materials), len(MAP_NAMES)), np.uint8)
    samplers = np.zeros((len(materials), len(MAP_NAMES), 3), np.uint8)
    for number, material in enumerate(materials):
        for column, name in enumerate(MAP_NAMES):
            key = _GLTF_NAMES.get(name, name)
            image = material.further_maps.get(key) or getattr(material, key, None)
            if image is not None:
                numbers_of_images.setdefault(id(image), len(images))
                maps[number, column] = numbers_of_images[id(image)]
                if maps[number, column] == len(images):
                    images.append(image)
                layers[number, column] = material.layer_of.get(key, 0)
                wrapped = material.sampler_of.get(key, Sampler())
                samplers[number, column] = (
                    WRAPS.index(wrapped.wrap_u),
                    WRAPS.index(wrapped.wrap_v),
                    wrapped.nearest,
                )
    image_table, texels = _images(images)

    def numbers(name: str, dtype: type = np.float64) -> Array:
        return Array(np.array([getattr(material, name) for material in materials], dtype))

    modes = [ALPHA_MODES.index(material.alphaMode) for material in materials]
    return SceneMaterials(
        names=Array(np.frombuffer("\n".join(map(_name, materials)).encode(), np.uint8)),
        base_colour_rgba=numbers("baseColorFactor"),
        metallic=numbers("metallicFactor"),
        roughness=numbers("roughnessFactor"),
        emission_rgb=numbers("emissiveFactor"),
        alpha_mode=Array(np.array(modes, np.uint8)),
        alpha_cutoff=numbers("alphaCutoff"),
        double_sided=numbers("doubleSided", np.bool_),
        normal_scale=numbers("normal_scale"),
        occlusion_strength=numbers("occlusion_strength"),
        terms=Array(np.array([as_row(material.terms) for material in materials])),
        map_image=Array(maps),
        map_uv_layer=Array(layers),
        map_sampler=Array(samplers),
        images=image_table,
        texels=texels,
    )


def _images(images: list[Image.Image]) -> tuple[Array, Array]:
    """The table (I, 4) of images, and their texels one after another."""
    table, texels, first = np.empty((len(images), 4), np.int64), [np.empty(0, np.uint8)], 0
    for number, image in enumerate(images):
        pixels = np.asarray(image)
        table[number] = first, *pixels.shape
        texels.append(pixels.reshape(-1))
        first += pixels.size
    return Array(table), Array(np.concatenate(texels))


def _name(material: SurfaceMaterial) -> str:
    one_line = " ".join(str(material.name or "").split())
    return one_line[:_LONGEST_NAME].encode(errors="replace").decode()

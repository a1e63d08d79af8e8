"""USD files (extra `usd`) as placed triangle meshes and cameras, at the first of their times.

Native instances and point instancers share their prototypes' meshes. A subdivision surface is shown
as its cage. usd-core reads the files itself, so that memory is counted from their sizes and then
from the arrays that are taken. Layers must lie in the scene's folder; pictures elsewhere are left
out.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.placement import (
    LEAST_METRES_PER_UNIT,
    MOST_METRES_PER_UNIT,
    Placement,
    UpAxis,
)
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.ear_clipping import ear_clipped, fans
from vrut_lite.scene.file_checks import MAX_FILE_BYTES
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.materials import SurfaceMaterial, default_material
from vrut_lite.scene.mesh import (
    MESH_BYTES,
    TriangleMesh,
    geometry_bytes,
    make_geometry,
    make_mesh,
    used_vertices,
)
from vrut_lite.scene.placed import PlacedMesh, SceneCamera, check_places, check_triangles
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.scene.usd_materials import UsdMaterials
from vrut_lite.scene.usd_shapes import SHAPES, shape_triangles
from vrut_lite.scene.vertex_colours import within_range

SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
_MISSING = (
    "it is USD, and the Python package usd-core is not installed: `pip install 'vrut-lite[usd]'`, "
    "or import it into Blender and export it as glTF"
)
# Memory of an open stage for each byte of its files, measured on text and crate files.
_STAGE_BYTES = 16
Matrix = NDArray[np.float64]


def read_usd_scene(
    path: Path, budget: SceneBudget, notices: Notices
) -> tuple[list[PlacedMesh], list[SceneCamera], Placement]:
    """Meshes and cameras in the file's axes and units, and what it says of these.

    Raises:
        SceneFileError: usd-core is missing, or the file is damaged, too large, or a layer of it
            lies outside its folder.
    """
    try:
        from pxr import Tf, Usd
    except ImportError as fault:
        raise SceneFileError(_MISSING) from fault
    size = path.stat().st_size
    if size > MAX_FILE_BYTES:
        raise SceneFileError(f"it has {size} bytes, more than the limit of {MAX_FILE_BYTES}")
    budget.take(_STAGE_BYTES * size, "its USD stage")
    budget.find(size)
    try:
        stage = Usd.Stage.Open(str(path), Usd.Stage.LoadNone)
        _check_layers(stage, path, budget)
        stage.Load()
        _check_layers(stage, path, budget)
        return _Reader(stage, path.parent, budget, notices).read()
    except (Tf.ErrorException, RuntimeError) as fault:
        # usd-core's own text is a page of its C++.
        raise SceneFileError("its USD is damaged, or lacks a layer; export it again") from fault


def _check_layers(stage: Any, path: Path, budget: SceneBudget) -> None:
    """Refuse layers that lie elsewhere."""
    folder = path.parent.resolve()
    for layer in stage.GetUsedLayers():
        if layer.anonymous:
            continue
        real = Path(layer.realPath.partition("[")[0]).resolve()
        if not real.is_relative_to(folder):
            raise SceneFileError(
                f"it names {ascii(layer.identifier)[:80]}, which leads out of the scene's folder; "
                "put that file beside the scene"
            )
        if real != path:
            budget.take(_STAGE_BYTES * real.stat().st_size, f"the layer {real.name!a}")


class _Corners(NamedTuple):
    """A mesh's corners: their vertices (n,), and triangles (F, 3) of them, each of a face (F,)."""

    vertices: NDArray[np.int64]
    triangles: NDArray[np.int64]
    face: NDArray[np.int64]

    def spread(self, values: Matrix, how: str, width: int) -> Matrix | None:
        """Values at the triangles' corners (F, 3, width); None if they are too few."""
        at = {
            "constant": np.zeros_like(self.triangles),
            "uniform": np.repeat(self.face[:, None], 3, axis=1),
            "faceVarying": self.triangles,
        }.get(how, self.vertices[self.triangles])
        fits = values.ndim == 2 and values.shape[1] == width and len(values) > at.max(initial=0)
        return np.asarray(values[at]) if fits else None


class _Reader:
    """Reads one stage."""

    def __init__(self, stage: Any, folder: Path, budget: SceneBudget, notices: Notices) -> None:
        from pxr import Usd, UsdGeom

        self._stage, self._budget, self._notices = stage, budget, notices
        self._time = Usd.TimeCode.EarliestTime()
        self._at = UsdGeom.XformCache(self._time)
        self._materials = UsdMaterials(folder, budget, notices, self._time)
        self._made: dict[str, list[TriangleMesh]] = {}
        self._triangles = 0

    def read(self) -> tuple[list[PlacedMesh], list[SceneCamera], Placement]:
        """Everything that is visible."""
        from pxr import Usd, UsdGeom

        placed: list[PlacedMesh] = []
        cameras: list[SceneCamera] = []
        proxies = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
        walk = iter(Usd.PrimRange(self._stage.GetPseudoRoot(), proxies))
        for prim in walk:
            if prim.IsA(UsdGeom.PointInstancer):
                walk.PruneChildren()
                placed += self._instances(prim)
            elif _is_surface(prim):
                placed += self._places(prim, self._matrix(prim))
            elif prim.IsA(UsdGeom.Camera):
                cameras.append(self._camera(prim))
            elif prim.IsA(UsdGeom.Gprim):
                self._notices.tell(f"USD {prim.GetTypeName()}", "not drawn")
            check_places(len(placed))
        if self._stage.GetEndTimeCode() > self._stage.GetStartTimeCode():
            self._notices.tell("USD animation", "at rest, at the first of its times")
        up: UpAxis = "z" if UsdGeom.GetStageUpAxis(self._stage) == UsdGeom.Tokens.z else "y"
        unit = float(UsdGeom.GetStageMetersPerUnit(self._stage))
        unit = float(np.clip(unit, LEAST_METRES_PER_UNIT, MOST_METRES_PER_UNIT))
        return placed, cameras, Placement(up=up, metres_per_unit=unit)

    def _matrix(self, prim: Any) -> Matrix:
        return np.array(self._at.GetLocalToWorldTransform(prim)).T

    def _instances(self, prim: Any) -> Iterator[PlacedMesh]:
        """The places of a point instancer."""
        from pxr import Usd, UsdGeom

        instancer = UsdGeom.PointInstancer(prim)
        if not _is_shown(prim):
            return
        numbers = np.array(instancer.GetProtoIndicesAttr().Get(self._time) or [], np.int64)
        found = instancer.ComputeInstanceTransformsAtTime(self._time, self._time) or []
        check_places(len(found))
        matrices = [np.array(matrix).T for matrix in found]
        if len(matrices) != len(numbers):
            self._notices.tell("point instancer with instances left out", "not drawn")
            return
        to_world = self._matrix(prim)
        for number, target in enumerate(instancer.GetPrototypesRel().GetForwardedTargets()):
            root = self._stage.GetPrimAtPath(target)
            from_root = np.linalg.inv(self._matrix(root.GetParent()))
            for part in Usd.PrimRange(root, Usd.TraverseInstanceProxies()):
                if not _is_surface(part):
                    continue
                in_prototype = from_root @ self._matrix(part)
                for place in np.flatnonzero(numbers == number):
                    yield from self._places(part, to_world @ matrices[place] @ in_prototype)

    def _places(self, prim: Any, matrix: Matrix) -> list[PlacedMesh]:
        """A mesh, one part a material, at a place."""
        if not _is_shown(prim):
            return []
        source = prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim
        key = str(source.GetPath())
        if key not in self._made:
            self._made[key] = self._meshes(source)
        return [PlacedMesh(prim.GetName(), mesh, matrix) for mesh in self._made[key]]

    def _meshes(self, prim: Any) -> list[TriangleMesh]:
        from pxr import UsdGeom

        mesh, name = UsdGeom.Mesh(prim), prim.GetName()
        is_mesh = prim.IsA(UsdGeom.Mesh)
        if is_mesh:
            points = np.array(mesh.GetPointsAttr().Get(self._time) or [], np.float64)
            points = points.reshape(-1, 3)
            counts = np.array(mesh.GetFaceVertexCountsAttr().Get(self._time) or [], np.int64)
            indices = np.array(mesh.GetFaceVertexIndicesAttr().Get(self._time) or [], np.int64)
        else:
            points, triangles = shape_triangles(prim, self._time)
            counts, indices = np.full(len(triangles), 3), triangles.reshape(-1)
        if counts.sum() != len(indices) or counts.min(initial=3) < 0:
            raise SceneFileError(f"mesh {ascii(name)[:60]} has faces without corners; export again")
        corners, face = fans(counts)
        self._triangles += len(corners)
        check_triangles(self._triangles)
        if not len(corners):
            return []
        if indices.min() >= 0 and indices.max() < len(points):
            continues = np.diff(face, prepend=-1) == 0
            corners = ear_clipped(corners, continues, lambda ring: points[indices[ring]])
        if is_mesh and mesh.GetSubdivisionSchemeAttr().Get() != UsdGeom.Tokens.none:
            self._notices.tell("USD subdivision surface", "its cage is drawn")
        if mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded:
            corners = corners[:, ::-1]
        spread = _Corners(indices, corners, face)
        normals = self._corner_values(mesh, "normals", spread, 3)
        uv = self._corner_values(mesh, "st", spread, 2)
        if is_mesh and normals is None and mesh.GetNormalsAttr().HasAuthoredValue():
            values = np.array(mesh.GetNormalsAttr().Get(self._time), np.float64)
            normals = spread.spread(values, mesh.GetNormalsInterpolation(), 3)
        displayed = self._corner_values(mesh, "displayColor", spread, 3)
        made = []
        for faces, bound in self._materials.parts(prim, len(counts)):
            chosen = np.isin(face, faces) if faces is not None else slice(None)
            part = corners[chosen]
            if not len(part):
                continue
            material, colours = bound, None
            if material is None:
                material, colours = self._displayed(displayed, chosen)
            size = geometry_bytes(0, len(part), normals=False, layers=2 + (colours is not None))
            self._budget.take(size + MESH_BYTES, f"mesh {ascii(name)[:60]}")
            arrays = {"POSITION": points}
            triangles, arrays = used_vertices(name, indices[part], arrays)
            if normals is not None or uv is not None or colours is not None:
                # Values at corners: each corner becomes a vertex.
                arrays = {"POSITION": arrays["POSITION"][triangles.reshape(-1)]}
                triangles = np.arange(triangles.size).reshape(-1, 3)
            geometry = make_geometry(
                name,
                arrays["POSITION"],
                triangles,
                self._budget,
                normals=None if normals is None else normals[chosen].reshape(-1, 3),
                uv=None if uv is None else uv[chosen].reshape(-1, 2),
                colours=colours,
            )
            made.append(make_mesh(geometry, material))
        return made

    def _displayed(
        self, displayed: Matrix | None, chosen: Any
    ) -> tuple[SurfaceMaterial, NDArray[np.float32] | None]:
        """The material of triangles without one, by their linear displayColor.

        A single colour is the material's; several are those of the corners (n, 3), which come
        beside it.
        """
        if displayed is None:
            return default_material(), None
        colours = within_range(displayed[chosen].reshape(-1, 3), self._notices)
        material = default_material(coloured=True)
        if not (colours == colours[0]).all():
            return material, colours
        return replace(material, baseColorFactor=np.append(colours[0], 1.0)), None

    def _corner_values(self, mesh: Any, name: str, corners: _Corners, width: int) -> Matrix | None:
        """A primvar at the triangles' corners (F, 3, width)."""
        from pxr import UsdGeom

        primvar = UsdGeom.PrimvarsAPI(mesh.GetPrim()).FindPrimvarWithInheritance(name)
        if not primvar or not primvar.HasValue():
            return None
        values = np.array(primvar.ComputeFlattened(self._time), np.float64)
        return corners.spread(values, primvar.GetInterpolation(), width)

    def _camera(self, prim: Any) -> SceneCamera:
        from pxr import Gf, UsdGeom

        camera = UsdGeom.Camera(prim).GetCamera(self._time)
        pose = np.array(camera.transform).T
        left, _, right = np.linalg.svd(pose[:3, :3])
        pose[:3, :3] = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
        degrees = camera.GetFieldOfView(Gf.Camera.FOVVertical)
        return SceneCamera(pose, float(np.radians(degrees)), prim.GetName()[:80])


def _is_surface(prim: Any) -> bool:
    from pxr import UsdGeom

    return bool(prim.IsA(UsdGeom.Mesh)) or prim.GetTypeName() in SHAPES


def _is_shown(prim: Any) -> bool:
    from pxr import UsdGeom

    seen = UsdGeom.Imageable(prim)
    if seen.ComputePurpose() not in (UsdGeom.Tokens.default_, UsdGeom.Tokens.render):
        return False
    return bool(seen.ComputeVisibility() != UsdGeom.Tokens.invisible)

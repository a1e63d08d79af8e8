"""The files of one scene, each read once and under one budget."""

from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from dataclasses import dataclass, field
from pathlib import Path

from vrut_lite.errors import UserError
from vrut_lite.messages.placement import Placement
from vrut_lite.scene import ifc_scene, mesh_scene, usd_scene
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.gltf_file import read_gltf_file
from vrut_lite.scene.gltf_points_and_lines import Strokes
from vrut_lite.scene.gltf_scene import GltfScene
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.lamps import PlacedLamp
from vrut_lite.scene.obj_scene import read_obj_scene
from vrut_lite.scene.placed import PlacedMesh, SceneCamera
from vrut_lite.scene.scene_file_error import SceneFileError

SUFFIXES = (
    ".glb",
    ".gltf",
    ".obj",
    *usd_scene.SUFFIXES,
    *ifc_scene.SUFFIXES,
    *mesh_scene.SUFFIXES,
)
# Formats that Blender imports or writes.
_OF_BLENDER = {".abc": "Alembic", ".blend": "a file of Blender", ".fbx": "FBX"}
_MAY_BE_TEXT = (".gltf", ".ifc", ".stl", ".ply", ".off", ".usd", ".usda")
# Placement of a glTF file by its standard.
_GLTF = Placement(up="y", metres_per_unit=1.0)


@dataclass
class SceneFile:
    """Content of one file, in its own axes and units; `says` is the placement that it states.

    `placed` are its meshes, `resting_cameras` its cameras at rest, `resting_strokes` the points and
    lines of a file that is no glTF. `is_for_printing` holds for 3MF, whose things lie
    flat on a printer's plate.
    """

    placed: list[PlacedMesh]
    resting_cameras: list[SceneCamera]
    notices: Notices
    says: Placement
    gltf: GltfScene | None = None
    resting_strokes: list[Strokes] = field(default_factory=list)
    is_for_printing: bool = False

    @property
    def duration_s(self) -> float:
        """How long its animations last; 0 without any."""
        return 0.0 if self.gltf is None else self.gltf.duration_s

    def posed(self, time_s: float | None) -> list[PlacedMesh]:
        """Its meshes at a time of its animations, which repeat."""
        time_s = self._wrapped_s(time_s)
        if time_s is None or self.gltf is None:
            return self.placed
        return self.gltf.posed(time_s)

    @property
    def variants(self) -> list[str]:
        """The names of its materials' variants."""
        return [] if self.gltf is None else self.gltf.variants

    def cameras(self, time_s: float | None) -> list[SceneCamera]:
        """Its cameras at a time of its animations."""
        time_s = self._wrapped_s(time_s)
        if time_s is None or self.gltf is None:
            return self.resting_cameras
        return self.gltf.cameras(time_s)

    def strokes(self, time_s: float | None) -> list[Strokes]:
        """Its points and lines at a time of its animations."""
        if self.gltf is None:
            return self.resting_strokes
        return self.gltf.strokes(self._wrapped_s(time_s))

    def lamps(self, time_s: float | None) -> list[PlacedLamp]:
        """Its lamps at a time of its animations."""
        return [] if self.gltf is None else self.gltf.lamps(self._wrapped_s(time_s))

    def _wrapped_s(self, time_s: float | None) -> float | None:
        if time_s is None or self.duration_s <= 0.0:
            return None
        at_the_end = time_s > 0.0 and time_s % self.duration_s == 0.0
        return self.duration_s if at_the_end else time_s % self.duration_s


@dataclass
class SceneFiles:
    """Files by their paths, with the materials of a variant where they have it."""

    budget: SceneBudget
    variant: str = ""
    _read: dict[Path, SceneFile] = field(default_factory=dict)

    def get(self, path: Path) -> SceneFile:
        """The content of a file.

        Raises:
            UserError: the file cannot be read; the sentence names it.
        """
        try:
            _check_path(path)
            real = path.resolve()
            if real not in self._read:
                self._read[real] = _read_file(real, self.budget, self.variant)
            return self._read[real]
        except SceneFileError as fault:
            raise UserError(f"cannot open the scene {path}: {fault}") from fault


def _read_file(real: Path, budget: SceneBudget, variant: str) -> SceneFile:
    notices = Notices()
    _check_text(real)
    if real.suffix.lower() == ".obj":
        placed, strokes = read_obj_scene(real, budget, notices)
        file = SceneFile(placed, [], notices, Placement(), resting_strokes=strokes)
    elif real.suffix.lower() in usd_scene.SUFFIXES:
        file = SceneFile(*_usd(real, budget, notices))
    elif real.suffix.lower() in ifc_scene.SUFFIXES:
        placed, says = ifc_scene.read_ifc_scene(real, budget, notices)
        file = SceneFile(placed, [], notices, says)
    elif real.suffix.lower() in mesh_scene.SUFFIXES:
        placed, says = mesh_scene.read_mesh_scene(real, budget, notices)
        is_for_printing = real.suffix.lower() == ".3mf"
        file = SceneFile(placed, [], notices, says, is_for_printing=is_for_printing)
    else:
        gltf = GltfScene(read_gltf_file(real, budget, notices, variant))
        file = SceneFile(gltf.posed(None), gltf.cameras(None), notices, _GLTF, gltf)
    if not any(len(place.mesh.faces) for place in file.placed):
        told = f" ({'; '.join(notices.lines())})" if notices.lines() else ""
        raise SceneFileError(f"it has no triangles{told}; export the scene with its meshes")
    return file


def _usd(
    real: Path, budget: SceneBudget, notices: Notices
) -> tuple[list[PlacedMesh], list[SceneCamera], Notices, Placement]:
    placed, cameras, says = usd_scene.read_usd_scene(real, budget, notices)
    return placed, cameras, notices, says


def _check_path(path: Path) -> None:
    try:
        if path.is_dir():
            raise SceneFileError("it is a folder; name the scene file in it")
        if not path.exists():
            raise SceneFileError("there is no such file; check its name")
        if not path.is_file():
            raise SceneFileError("it is not a regular file; name a scene file")
    except (OSError, ValueError) as fault:
        if isinstance(fault, SceneFileError):
            raise
        raise SceneFileError(f"its path cannot be used ({fault}); check its name") from fault
    suffix = path.resolve().suffix.lower()
    if suffix in _OF_BLENDER:
        raise SceneFileError(
            f"it is {_OF_BLENDER[suffix]}, which is not read; open it in Blender, or in the "
            "program that wrote it, and export it as glTF"
        )
    if suffix not in SUFFIXES:
        raise SceneFileError(
            f"its name does not end in {', '.join(SUFFIXES)}; export it as one of these"
        )


def _check_text(real: Path) -> None:
    """Refuse text in UTF-16; COLLADA says its encoding, and the reader of OBJ knows it."""
    try:
        with real.open("rb") as file:
            mark = file.read(2)
    except OSError:
        return  # The reader names it.
    if real.suffix.lower() in _MAY_BE_TEXT and mark in (BOM_UTF16_LE, BOM_UTF16_BE):
        raise SceneFileError("it is text in UTF-16; save it in UTF-8, or export it again")

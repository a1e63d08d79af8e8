"""Opens scene files (glTF, GLB, OBJ, USD) as placed meshes in metres, without GL."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite.messages.glazing import Glazing
from vrut_lite.messages.lamps import SceneLamps
from vrut_lite.messages.placement import PlacedFile, Placement, UpAxis
from vrut_lite.messages.points_and_lines import PointsAndLines
from vrut_lite.scene.axes_and_units import (
    ground_top,
    guess_metres_per_unit,
    guess_up,
    has_floor_across_y,
    is_board,
    stands_on_edge,
)
from vrut_lite.scene.budget import SceneBudget, budget_of_environment
from vrut_lite.scene.choices import chosen_camera, chosen_variant
from vrut_lite.scene.file_checks import SceneFolder
from vrut_lite.scene.glazing import glazed
from vrut_lite.scene.gltf_points_and_lines import Strokes, packed_strokes
from vrut_lite.scene.lamps import PlacedLamp, packed_lamps, with_luminaires
from vrut_lite.scene.luminaire_file import read_luminaire
from vrut_lite.scene.mesh import TriangleMesh, mirrored
from vrut_lite.scene.photometry import Photometry
from vrut_lite.scene.placed import PlacedMesh, SceneCamera, box_of, check_places, check_triangles
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.scene.scene_files import SceneFile, SceneFiles

MAX_REACH_M = 1e7
# Triangles of a file whose stated axis is compared with its shape: 0.1 s.
_MOST_TRIED = 200_000
_UNIT_NAMES = {1.0: "metres", 0.01: "centimetres", 0.001: "millimetres"}
_AS_IT_SAYS = Placement()
_NO_LUMINAIRES: Mapping[str, str] = MappingProxyType({})
_NO_GLAZING: Mapping[str, Glazing] = MappingProxyType({})
_SAY_ANIMATION = "--animation SECONDS or clock, or Animation in the Scene panel"


@dataclass(frozen=True)
class LoadedScene:
    """A scene in world axes: metres, +Y up, east +X, north -Z.

    `lower_m` and `upper_m` (3,) bound all triangles; `triangles` counts those of shared meshes
    once for each place. `camera` is the chosen one of `cameras`. `notices` are import warnings on
    unsupported parts and guesses; `placement` and `beside` are the requested ones with guesses
    filled in; `luminaires`, `glazing` and `variant`, one of `variants`, are the requested ones.
    `animation_s` is the length of the animations.
    """

    path: Path
    meshes: tuple[PlacedMesh, ...]
    lower_m: NDArray[np.float64]
    upper_m: NDArray[np.float64]
    triangles: int
    camera: SceneCamera | None
    cameras: tuple[SceneCamera, ...] = ()
    lamps: SceneLamps | None = None
    luminaires: tuple[tuple[str, str], ...] = ()
    glazing: tuple[tuple[str, Glazing], ...] = ()
    notices: tuple[str, ...] = ()
    placement: Placement = _AS_IT_SAYS
    beside: tuple[PlacedFile, ...] = ()
    animation_s: float = 0.0
    variant: str = ""
    variants: tuple[str, ...] = ()
    points_and_lines: PointsAndLines | None = None


class OpenScene:
    """Scene files that stay in memory, for one pose of their animations after another.

    `budget` limits memory; by default it comes from the environment. Axes and units that a
    placement leaves open are the file's own, or guessed. `camera` names a camera, or counts from 1,
    and so does `variant` among the materials' variants. `luminaires` are paths of IES and
    EULUMDAT files by the names of lamps; `glazing` says which materials are glass.

    Raises:
        UserError: in one sentence, if a file is damaged, too large or empty, or more than a
            picture or material library of it is missing or outside its folder.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        budget: SceneBudget | None = None,
        *,
        placement: Placement = _AS_IT_SAYS,
        beside: Sequence[PlacedFile] = (),
        camera: str = "",
        luminaires: Mapping[str, str] = _NO_LUMINAIRES,
        variant: str = "",
        glazing: Mapping[str, Glazing] = _NO_GLAZING,
    ) -> None:
        self._path, self._camera = Path(path), camera
        self._files = SceneFiles(budget or budget_of_environment(), variant)
        self._luminaires, self._glazing = luminaires, glazing
        self._photometries = self._read_luminaires()
        main = PlacedFile(scene=str(path), placement=placement)
        self._asked = [(one, self._files.get(Path(one.scene))) for one in (main, *beside)]
        names = (name for _, file in self._asked for name in file.variants)
        self._variants = tuple(dict.fromkeys(names))
        self._variant = self._found_variant(variant)
        self._filled = [_filled(one.placement, file) for one, file in self._asked]

    @property
    def duration_s(self) -> float:
        """How long the longest animation of its files lasts; 0 without any."""
        return max(file.duration_s for _, file in self._asked)

    def at(self, time_s: float | None = None) -> LoadedScene:
        """The scene at a time of its animations, or at rest.

        Raises:
            UserError: it is too large, or there is no such camera.
        """
        try:
            stood = [
                _stand(one, file, placement, time_s)
                for (one, file), placement in zip(self._asked, self._filled, strict=True)
            ]
            scene = _joined(self._path, stood, self._files.budget, self._camera, self.duration_s)
            lamps = [lamp for one in stood for lamp in one.lamps]
            lamps = with_luminaires(lamps, self._photometries)
            return replace(
                scene,
                lamps=packed_lamps(lamps),
                luminaires=tuple(self._luminaires.items()),
                meshes=glazed(scene.meshes, self._glazing),
                glazing=tuple(self._glazing.items()),
                variant=self._variant,
                variants=self._variants,
                points_and_lines=packed_strokes([s for one in stood for s in one.strokes]),
            )
        except SceneFileError as fault:
            raise UserError(f"cannot open the scene {self._path}: {fault}") from fault

    def _found_variant(self, asked: str) -> str:
        try:
            return chosen_variant(self._variants, asked)
        except SceneFileError as fault:
            raise UserError(f"cannot open the scene {self._path}: {fault}") from fault

    def _read_luminaires(self) -> dict[str, Photometry]:
        """Photometries by the names of lamps; a file may lie in any folder."""
        read: dict[str, Photometry] = {}
        for name, path in self._luminaires.items():
            try:
                folder = SceneFolder(Path(path).parent, self._files.budget)
                read[name] = read_luminaire(folder.read(Path(path))).photometry()
            except SceneFileError as fault:
                raise UserError(f"cannot read the luminaire {path}: {fault}") from fault
        return read


def load_scene(
    path: str | os.PathLike[str], budget: SceneBudget | None = None, **how: Any
) -> LoadedScene:
    """A scene with its materials, textures and cameras, at rest; `how` as `OpenScene` takes it."""
    return OpenScene(path, budget, **how).at()


@dataclass(frozen=True)
class _Stood:
    """A file as it stands in the world."""

    asked: PlacedFile
    placed: list[PlacedMesh]
    cameras: list[SceneCamera]
    lamps: list[PlacedLamp]
    strokes: list[Strokes]
    notices: list[str]
    says_unit: bool


def _stand(
    asked: PlacedFile, file: SceneFile, placement: Placement, time_s: float | None
) -> _Stood:
    """Place what a file holds."""
    matrix = placement.world_from_file()
    placed, cameras, lamps = file.posed(time_s), file.cameras(time_s), file.lamps(time_s)
    strokes = file.strokes(time_s)
    lines = [*file.notices.lines(), *_told_guesses(asked.placement, placement, file)]
    if time_s is None and file.duration_s > 0.0:
        lines.append(f"animations of {file.duration_s:.3g} s: at rest ({_SAY_ANIMATION})")
    if not np.array_equal(matrix, np.eye(4)):
        with np.errstate(over="ignore", invalid="ignore"):
            placed = [replace(p, world_from_model=matrix @ p.world_from_model) for p in placed]
        cameras = [camera.moved(matrix) for camera in cameras]
        lamps = [lamp.moved(matrix) for lamp in lamps]
        strokes = [one.moved(matrix) for one in strokes]
    says_unit = asked.placement.metres_per_unit is None and file.says.metres_per_unit is not None
    filled = msgspec.structs.replace(asked, placement=placement)
    return _Stood(filled, placed, cameras, lamps, strokes, lines, says_unit)


def _filled(asked: Placement, file: SceneFile) -> Placement:
    """The placement with what it leaves open: said by the file, or guessed."""
    up = asked.up or file.says.up or guess_up(file.placed)
    unit = asked.metres_per_unit or file.says.metres_per_unit
    if unit is None:
        upright = msgspec.structs.replace(asked, up=up, metres_per_unit=1.0, heading_deg=0.0)
        unit = guess_metres_per_unit(*_extents(file.placed, upright.world_from_file()))
    return msgspec.structs.replace(asked, up=up, metres_per_unit=unit)


def _told_guesses(asked: Placement, filled: Placement, file: SceneFile) -> list[str]:
    """Lines on guesses that change the scene, and on an axis that may be another."""
    lines = []
    if asked.up is None and file.says.up is None:
        if filled.up != "y":
            lines.append(
                "taken to stand along +Z, where it has a floor (else --up y, or Up in the Scene "
                "panel)"
            )
        elif stands_on_edge(file.placed):
            lines.append("flat and upright (else --up z, or Up in the Scene panel)")
    elif asked.up is None and (other := _other_axis(file)) is not None:
        lines.append(
            f"upright by the file's own axis, and its largest level area is across "
            f"{other.upper()} (else --up {other}, or Up in the Scene panel)"
        )
    unit = filled.metres_per_unit
    if asked.metres_per_unit is None and file.says.metres_per_unit is None and unit != 1.0:
        name = _UNIT_NAMES[unit or 1.0]
        lines.append(
            f"taken to be in {name} (else --metres-per-unit 1, or Unit in the Scene panel)"
        )
    return lines


def _other_axis(file: SceneFile) -> UpAxis | None:
    """The axis that has a floor where the file states the other; large files are not asked."""
    triangles = sum(len(place.mesh.faces) for place in file.placed)
    if triangles > _MOST_TRIED:
        return None
    if file.is_for_printing:
        return "y" if has_floor_across_y(file.placed) else None
    if file.says.up == "y" and guess_up(file.placed) == "z" and not is_board(file.placed):
        return "z"
    return None


def _joined(
    path: Path, stood: list[_Stood], budget: SceneBudget, camera: str, animation_s: float
) -> LoadedScene:
    placed = [place for one in stood for place in one.placed]
    triangles = sum(len(place.mesh.faces) for place in placed)
    check_places(len(placed))
    check_triangles(triangles)
    lower_m, upper_m = _bounds(placed)
    cameras = [camera for one in stood for camera in one.cameras]
    return LoadedScene(
        path=path,
        meshes=tuple(_wound_outwards(placed, budget)),
        lower_m=lower_m,
        upper_m=upper_m,
        triangles=triangles,
        camera=chosen_camera(cameras, camera),
        cameras=tuple(cameras),
        notices=(*_lines(stood), *_told_height(stood, upper_m - lower_m)),
        placement=stood[0].asked.placement,
        beside=tuple(one.asked for one in stood[1:]),
        animation_s=animation_s,
    )


def _lines(stood: list[_Stood]) -> tuple[str, ...]:
    """The notices, each file's once; of several files each under its name."""
    if len(stood) == 1:
        return tuple(stood[0].notices)
    named = [f"{Path(one.asked.scene).name}: {line}" for one in stood for line in one.notices]
    return tuple(dict.fromkeys(named))


def _told_height(stood: list[_Stood], extent_m: NDArray[np.float64]) -> list[str]:
    """A line where files that say their unit themselves are so high that they may mean another."""
    if not all(one.says_unit for one in stood) or guess_metres_per_unit(extent_m) == 1.0:
        return []
    return [
        f"{extent_m[1]:,.0f} m high, by the file's own unit (else "
        "--metres-per-unit 0.01, or Unit in the Scene panel)"
    ]


def _wound_outwards(placed: list[PlacedMesh], budget: SceneBudget) -> list[PlacedMesh]:
    """Reverse the triangles that a mirroring matrix turns inside out (glTF 2.0, section 3.7.4)."""
    turned: dict[int, TriangleMesh] = {}
    result = []
    for place in placed:
        if np.linalg.det(place.world_from_model[:3, :3]) < 0:
            if id(place.mesh) not in turned:
                turned[id(place.mesh)] = mirrored(place.mesh, budget)
            place = replace(place, mesh=turned[id(place.mesh)])
        result.append(place)
    return result


def _bounds(placed: list[PlacedMesh]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    with np.errstate(over="ignore", invalid="ignore"):
        corners = [box_of(_moved(place, place.world_from_model)) for place in placed]
    lower_m = np.min([pair[0] for pair in corners], axis=0)
    upper_m = np.max([pair[1] for pair in corners], axis=0)
    reach_m = np.max(np.abs([lower_m, upper_m]))
    if not reach_m <= MAX_REACH_M:
        raise SceneFileError(
            f"it reaches {reach_m:.3g} m from its origin, above the limit of {MAX_REACH_M:.0e} m; "
            "scenes are in metres"
        )
    return lower_m, upper_m


def _extents(
    placed: list[PlacedMesh], matrix: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Extents (3,) of meshes under a further matrix, and of the objects on their ground."""
    with np.errstate(over="ignore", invalid="ignore"):
        moved = [_moved(place, matrix @ place.world_from_model) for place in placed]
        lower, upper = _box_of_all(moved)
        above = [points[points[:, 1] > ground_top(lower, upper)] for points in moved]
        low, high = _box_of_all([points for points in above if len(points)] or moved)
        return upper - lower, high - low


def _box_of_all(
    parts: list[NDArray[np.float64]],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    lows, highs = zip(*(box_of(points) for points in parts), strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def _moved(place: PlacedMesh, matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(place.mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3])

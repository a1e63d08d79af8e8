"""The scene: the file to open, its content, and the light and air that it needs."""

import hashlib
from typing import ClassVar

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.kernel.messages import Derived, Input
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.glazing import Glazing
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.lamps import SceneLamps
from vrut_lite.messages.placement import PlacedFile, Placement
from vrut_lite.messages.points_and_lines import PointsAndLines
from vrut_lite.messages.scene_content import SceneGeometry, SceneMaterials
from vrut_lite.numeric_types import Vector

MOST_FILES = 1000


class LoadScene(Input, frozen=True, kw_only=True):
    """Open this scene file, and others beside it, each placed.

    `camera` is the name of one of the file's cameras, or its number from 1; empty for the first.
    `luminaires` are names of lamps and paths of their IES files. `variant` is one of the file's
    variants of materials, in the same way as `camera`; empty for the default ones. `glazing` gives
    the glass of materials by name.
    """

    is_barrier: ClassVar[bool] = True

    path: str
    placement: Placement = Placement()
    beside: tuple[PlacedFile, ...] = ()
    camera: str = ""
    luminaires: tuple[tuple[str, str], ...] = ()
    variant: str = ""
    glazing: tuple[tuple[str, Glazing], ...] = ()

    def check(self) -> None:
        """Paths and placements; the content of files is checked on opening."""
        checks.text(self, "path", "camera", "variant")
        checks.instance(self, "placement", Placement)
        self.placement.check()
        if not (isinstance(self.beside, tuple) and len(self.beside) <= MOST_FILES):
            checks.refuse(self, "beside", f"be at most {MOST_FILES} files")
        for file in self.beside:
            if not isinstance(file, PlacedFile):
                checks.refuse(self, "beside", "be files with their placements")
            file.check()
        checks.pairs_of_texts(self, "luminaires")
        glazing = self.glazing if isinstance(self.glazing, tuple) else (None,)
        if not all(
            isinstance(pair, tuple)
            and len(pair) == 2
            and isinstance(pair[0], str)
            and isinstance(pair[1], Glazing)
            for pair in glazing
        ):
            checks.refuse(self, "glazing", "be names of materials with their glass")


class SceneOpened(Derived, frozen=True, kw_only=True):
    """An opened scene: its bounds in metres, world axes, and its content.

    `triangles` counts those of all parts. `ground` is the disc below the scene, None if the file
    has a ground; `camera` is the file's first camera; `lamps` is None without lamps. `notices` are
    import warnings, a line each. `opened` is the request, with the guessed parts of its placement
    filled in; `cameras` are the names of the file's cameras, `variants` those of its materials'
    variants; `animation_s` is the length of its animations, 0 without any. `points_and_lines` is
    None without any. `border_rgb` is the mean albedo of the open ground at the scene's border, None
    where it ends in something else.
    """

    path: str
    lower_m: Vector
    upper_m: Vector
    triangles: int
    geometry: SceneGeometry
    materials: SceneMaterials
    ground: GroundDisc | None
    camera: MoveCamera | None
    lamps: SceneLamps | None = None
    notices: tuple[str, ...] = ()
    opened: LoadScene | None = None
    cameras: tuple[str, ...] = ()
    variants: tuple[str, ...] = ()
    points_and_lines: PointsAndLines | None = None
    animation_s: float = 0.0
    border_rgb: Vector | None = None

    @property
    def content_key(self) -> str:
        """Hexadecimal BLAKE2b-128 of geometry, materials and lamps, without the file's name.

        The arrays are digested when this or a journal first asks, some 1 GB a second.
        """
        digest = hashlib.blake2b(digest_size=16)
        for part in filter(None, (self.geometry, self.materials, self.lamps)):
            for name in part.__struct_fields__:
                array: Array = getattr(part, name)
                digest.update(array.digest.encode())
        return digest.hexdigest()

    def check(self) -> None:
        """Check bounds, a count, and arrays whose shapes match."""
        checks.text(self, "path")
        checks.numbers(self, "lower_m", 3)
        checks.numbers(self, "upper_m", 3)
        checks.whole(self, "triangles", 0, 2**63)
        if self.border_rgb is not None:
            checks.light(self, "border_rgb", 1.0)
        checks.instance(self, "geometry", SceneGeometry)
        checks.instance(self, "materials", SceneMaterials)
        self.geometry.check()
        self.materials.check()
        checks.instance(self, "ground", (GroundDisc, type(None)))
        checks.instance(self, "camera", (MoveCamera, type(None)))
        if self.camera is not None:
            self.camera.check()
        checks.instance(self, "lamps", (SceneLamps, type(None)))
        if self.lamps is not None:
            self.lamps.check()
        checks.instance(self, "points_and_lines", (PointsAndLines, type(None)))
        if self.points_and_lines is not None:
            self.points_and_lines.check()
        checks.lines(self, "notices")
        checks.lines(self, "cameras")
        checks.lines(self, "variants")
        checks.number(self, "animation_s", 0.0)
        checks.instance(self, "opened", (LoadScene, type(None)))
        if self.opened is not None:
            self.opened.check()

    def check_arrays(self) -> None:
        """Arrays that refer to each other within their lengths."""
        self.geometry.check_arrays()
        if self.lamps is not None:
            self.lamps.check_arrays()
        if self.points_and_lines is not None:
            self.points_and_lines.check_arrays()


class SceneNeeds(Derived, frozen=True, kw_only=True):
    """The light and the air that the scene needs; producers compute nothing else.

    `air_reach_m`: distance (m) from the eye to the farthest surface that is seen through air; 0
    without such a surface. `eye_height_m`: the eye's y, also of a camera that a scene brings.
    """

    sky_in_view: bool
    visible_faces: tuple[int, ...]
    receives_light: bool
    air_reach_m: float = 0.0
    eye_height_m: float = 0.0

    def check(self) -> None:
        """Faces of a cube, and lengths."""
        checks.flag(self, "sky_in_view", "receives_light")
        checks.wholes(self, "visible_faces", 0, 5, most=6)
        checks.number(self, "air_reach_m", 0.0)
        checks.number(self, "eye_height_m")

"""The scene: which file to open, what was in it, and what it needs of light and air."""

import hashlib

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.ground_disc import GroundDisc
from vrut_lite.daylight.scene_content import SceneGeometry, SceneMaterials
from vrut_lite.kernel.messages import Derived, Input
from vrut_lite.numeric_types import Vector


class LoadScene(Input, frozen=True, kw_only=True):
    """Open this scene file."""

    path: str

    def check(self) -> None:
        """The file itself tells the rest."""
        checks.text(self, "path")


class SceneOpened(Derived, frozen=True, kw_only=True):
    """A scene is open: its bounds in metres, world axes, and all that is in it.

    `triangles` counts them where they stand. `ground` is the disc that it stands on, None if it
    brings a ground of its own; `camera` the first that the file brings.
    """

    path: str
    lower_m: Vector
    upper_m: Vector
    triangles: int
    geometry: SceneGeometry
    materials: SceneMaterials
    ground: GroundDisc | None
    camera: MoveCamera | None

    @property
    def content_key(self) -> str:
        """Hexadecimal BLAKE2b-128 of geometry and materials, whatever the file is called.

        The arrays are digested when this or a journal first asks, some 1 GB a second.
        """
        digest = hashlib.blake2b(digest_size=16)
        for part in (self.geometry, self.materials):
            for name in part.__struct_fields__:
                array: Array = getattr(part, name)
                digest.update(array.digest.encode())
        return digest.hexdigest()

    def check(self) -> None:
        """Bounds, a count, and arrays that go with each other."""
        checks.text(self, "path")
        checks.numbers(self, "lower_m", 3)
        checks.numbers(self, "upper_m", 3)
        checks.whole(self, "triangles", 0, 2**63)
        checks.instance(self, "geometry", SceneGeometry)
        checks.instance(self, "materials", SceneMaterials)
        self.geometry.check()
        self.materials.check()
        checks.instance(self, "ground", (GroundDisc, type(None)))
        checks.instance(self, "camera", (MoveCamera, type(None)))
        if self.camera is not None:
            self.camera.check()

    def check_arrays(self) -> None:
        """Arrays that refer to each other within their lengths."""
        self.geometry.check_arrays()


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

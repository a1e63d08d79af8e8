"""The scene: which file is open, and what it needs of light and air."""

from vrut_lite import checks
from vrut_lite.kernel.messages import Derived, Input
from vrut_lite.numeric_types import Vector


class LoadScene(Input, frozen=True, kw_only=True):
    """Open this scene file."""

    path: str

    def check(self) -> None:
        """The file itself tells the rest."""
        checks.text(self, "path")


class SceneLoaded(Derived, frozen=True, kw_only=True):
    """A scene is open; its bounds in metres, world axes."""

    path: str
    lower_m: Vector
    upper_m: Vector
    triangles: int

    def check(self) -> None:
        """Bounds and a count."""
        checks.text(self, "path")
        checks.numbers(self, "lower_m", 3)
        checks.numbers(self, "upper_m", 3)
        checks.whole(self, "triangles", 0, 2**63)


class SceneNeeds(Derived, frozen=True, kw_only=True):
    """What the scene asks of light: producers compute nothing else.

    `air_reach_m`: how far from the eye things stand between which and the eye air is to be
    drawn; 0 where none is. `eye_height_m`: the eye's y, also of a camera that a scene brings.
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

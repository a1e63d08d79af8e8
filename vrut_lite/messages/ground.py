"""The ground around the scene; every sky follows it unless its settings name an albedo.

A sky may have a setting of `OWN_ALBEDOS`: unset, it follows the host's ground, a number is a grey
ground of that sky alone.
"""

from functools import lru_cache
from typing import Literal, get_args

from vrut_lite import checks
from vrut_lite.atmosphere.ground_reflectance import GREY, GROUNDS, GroundReflectance
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Input
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.tolerance import Remembers
from vrut_lite.numeric_types import Vector
from vrut_lite.plain_numbers import plain_float

OWN_ALBEDOS = ("albedo", "photo_albedo")
# The colour at the scene's border, grey without one; grey; no ground disc, grey in the sky's light.
SCENE_BORDER, PLAIN_GREY, NO_DISC = "scene", "grey", "none"
GroundName = Literal[
    "scene", "grey", "grass", "soil", "sand", "paving", "snow", "water", "none"
]  # fmt: skip
GROUND_NAMES: tuple[str, ...] = get_args(GroundName)


class SetGround(Input, frozen=True, kw_only=True):
    """The ground below sky and scene, by name.

    `albedo` is its luminous albedo in sunlight, with the hue of the name; None leaves it as
    measured, and 0.1 for grey.
    """

    ground: GroundName = "grey"
    albedo: float | None = None

    @property
    def text(self) -> str:
        """As a project file has it: `NAME`, or `NAME,ALBEDO`."""
        return self.ground if self.albedo is None else f"{self.ground},{self.albedo:g}"

    def reflectance(self, border_rgb: Vector | None) -> GroundReflectance:
        """Reflectance of the ground, for a scene with this colour at its border."""
        return _reflectance(self.ground, self.albedo, border_rgb)

    def check(self) -> None:
        """A known ground, which reflects no more than it receives."""
        checks.choice(self, "ground", GROUND_NAMES, of="the scene")
        if self.albedo is not None:
            checks.number(self, "albedo", 0.0, 1.0, of="ground")


# The same object for equal grounds keeps its colour.
@lru_cache(maxsize=16)
def _reflectance(name: str, albedo: float | None, border_rgb: Vector | None) -> GroundReflectance:
    found = GREY
    if name in GROUNDS:
        found = GroundReflectance.named(name)
    elif name == SCENE_BORDER and border_rgb is not None:
        found = GroundReflectance.of_rgb(border_rgb)
    return found if albedo is None else found.with_albedo(albedo)


# The default of a kernel; projects begin with `SCENE_BORDER`.
DEFAULT_GROUND = SetGround()


def parse_ground(text: str) -> SetGround:
    """Parses `NAME` or `NAME,ALBEDO`; raises UserError for an unknown ground."""
    name, comma, number = text.strip().partition(",")
    try:
        albedo = plain_float(number) if comma else None
    except ValueError:
        raise UserError(f"ground {text}: its albedo is no number: say snow or snow,0.6") from None
    ground = SetGround(ground=name.strip(), albedo=albedo)  # type: ignore[arg-type]
    ground.check()
    return ground


def ground_of(kernel: Remembers) -> GroundReflectance:
    """Reflectance of the ground that was set last, around the scene that was opened last."""
    said, scene = kernel.last(SetGround) or DEFAULT_GROUND, kernel.last(SceneOpened)
    return said.reflectance(None if scene is None else scene.border_rgb)

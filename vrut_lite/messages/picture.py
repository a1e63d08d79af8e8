"""The picture: its size, how radiance becomes colours in it, and clicks in it."""

from typing import ClassVar, Literal, get_args

from vrut_lite import checks
from vrut_lite.kernel.messages import Input
from vrut_lite.numeric_types import Vector

ToneMap = Literal["agx", "exponential", "none"]
NightLook = Literal["eye", "exposure"]
LARGEST_PICTURE_PX = 16384
# Stops of exposure whose powers of two stay finite in 32 bits.
_MOST_STOPS = 100.0
# Colour temperatures that the eye accepts as white, and how far from the daylight locus.
LOWEST_K, HIGHEST_K, MOST_DUV = 1700.0, 25_000.0, 0.05


class Resize(Input, frozen=True, kw_only=True):
    """The picture's size in pixels."""

    revises: ClassVar[bool] = False

    width_px: int
    height_px: int

    def check(self) -> None:
        """A picture that can be drawn."""
        checks.whole(self, "width_px", 1, LARGEST_PICTURE_PX)
        checks.whole(self, "height_px", 1, LARGEST_PICTURE_PX)


class SetExposure(Input, frozen=True, kw_only=True):
    """The picture's exposure, white balance and tone map.

    Automatic exposure, or a fixed EV100; the compensation brightens by so many stops. Light of
    `white_temperature_k`, moved off the daylight locus by `white_duv` (towards green), is shown
    white; 6504 K leaves colours as they are. By night the picture looks as an eye sees it, or as a
    long exposure with its colours (`pictures/night_eye.py`). `glare` 1 shows the light that an eye
    scatters around bright sources (`pictures/glare.py`), 0 none.
    """

    revises: ClassVar[bool] = False

    mode: Literal["auto", "manual"] = "auto"
    ev100: float = 15.0
    compensation_ev: float = 0.0
    tone_map: ToneMap = "agx"
    white_temperature_k: float = 6504.0
    white_duv: float = 0.0
    night_look: NightLook = "eye"
    glare: float = 0.0

    def check(self) -> None:
        """Stops of which powers of two stay finite, and white that is near daylight."""
        checks.choice(self, "mode", ("auto", "manual"))
        checks.number(self, "ev100", -_MOST_STOPS, _MOST_STOPS)
        checks.number(self, "compensation_ev", -_MOST_STOPS, _MOST_STOPS)
        checks.choice(self, "tone_map", get_args(ToneMap))
        checks.number(self, "white_temperature_k", LOWEST_K, HIGHEST_K)
        checks.number(self, "white_duv", -MOST_DUV, MOST_DUV)
        checks.choice(self, "night_look", get_args(NightLook))
        checks.number(self, "glare", 0.0, 1.0)


class PictureClicked(Input, frozen=True, kw_only=True):
    """A click on a surface in the picture; the window sends it while a module demands it.

    position_m and the unit normal, towards the eye, in world axes; the material by the name that
    the scene's file gives it, "ground" for the ground around the scene; linear sRGB radiance
    towards the eye in W m^-2 sr^-1, as the picture shows it.
    """

    revises: ClassVar[bool] = False

    position_m: Vector
    normal: Vector
    material: str
    radiance_rgb: Vector

    def key(self) -> None:
        """Every click counts."""

    def check(self) -> None:
        """A point, a unit vector, a name and a finite colour."""
        checks.numbers(self, "position_m", 3)
        checks.direction(self, "normal")
        checks.text(self, "material")
        checks.numbers(self, "radiance_rgb", 3)

"""The light of the night: moonlight, the glow of the moonless sky, stars, and the moon's disc."""

import math
from datetime import datetime
from typing import ClassVar

import msgspec

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.limits import MOST_LIGHT
from vrut_lite.messages.sky import NO_LAMPS
from vrut_lite.messages.sun import SunMoved
from vrut_lite.numeric_types import Vector

SLOT = "night"
NO_ECLIPSE: Vector = (1.0, 1.0, 1.0)
_WIDEST_RAD = 0.25 * math.pi
# Light at the edge of the Earth's umbra, relative to its middle.
EDGE_OVER_MIDDLE = 30.0
# Number of heights on the moon's disc, lowest to highest, with the transmittance of the air there.
THROUGH_PLACES = 9


class MoonLight(msgspec.Struct, frozen=True, kw_only=True):
    """The moon as a source of light.

    Attributes:
        place: its direction, in the fields of the sun's message.
        irradiance_rgb: above the air, on a plane that faces it, linear sRGB, W m^-2.
        of_sunlight_rgb: the same as a share of the sun's at one astronomical unit.
        angular_radius_rad: angular radius of its disc.
        lit_fraction: share of the disc that the sun lights.
        waxes: whether that share grows with time.
    """

    place: SunMoved
    irradiance_rgb: Vector
    of_sunlight_rgb: Vector
    angular_radius_rad: float
    lit_fraction: float
    waxes: bool

    def check(self) -> None:
        """A place, and some light.

        Raises:
            UserError: a field is invalid.
        """
        checks.instance(self, "place", SunMoved)
        self.place.check()
        checks.light(self, "irradiance_rgb", MOST_LIGHT)
        checks.light(self, "of_sunlight_rgb", 1.0)
        checks.number(self, "angular_radius_rad", 1e-6, _WIDEST_RAD)
        checks.number(self, "lit_fraction", 0.0, 1.0)
        checks.flag(self, "waxes")


class NightLightChanged(Derived, frozen=True, kw_only=True):
    """Moonlight, and the glow of the sky without sun and moon.

    Skies add both to the sun's light. `glow_rgb` (rows, columns, 3) float32: linear sRGB radiance
    behind the air, W m^-2 sr^-1; None by day. Row r lies at the elevation (r + 0.5) / rows times
    90 deg, column c at the azimuth (c + 0.5) / columns times 360 deg in world axes (from -Z,
    clockwise from above). `moon` is None where it is too low to light anything.
    `instant` is the clock's.
    `sun_left_rgb` is the share of the sun's light that the moon leaves in an eclipse. `lamps_rgb`
    is the radiance of the lands around by their lamps, seen from above: it lights clouds.
    """

    slot: ClassVar[str | None] = SLOT

    instant: datetime
    moon: MoonLight | None
    glow_rgb: Array | None
    source: str
    sun_left_rgb: Vector = NO_ECLIPSE
    lamps_rgb: Vector = NO_LAMPS

    def check(self) -> None:
        """A moon, and a map of the hemisphere."""
        checks.instant(self, "instant")
        checks.instance(self, "moon", (MoonLight, type(None)))
        if self.moon is not None:
            self.moon.check()
        if self.glow_rgb is not None:
            checks.arrays(self, {"glow_rgb": ("<f4", ("rows", "columns", 3))})
        checks.light(self, "sun_left_rgb", 1.0)
        checks.light(self, "lamps_rgb", MOST_LIGHT)
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Radiance, which is finite."""
        if self.glow_rgb is not None:
            checks.contents(self, "glow_rgb", 0.0, MOST_LIGHT)


class StarsChanged(Derived, frozen=True, kw_only=True):
    """Stars and planets that the planet does not hide from the eye, points, brightest first.

    direction (n, 3) float32: apparent, in world axes. irradiance_rgb (n, 3) float32: behind the
    air, on a plane that faces the star, linear sRGB, W m^-2.
    """

    slot: ClassVar[str | None] = SLOT

    direction: Array
    irradiance_rgb: Array
    source: str

    def check(self) -> None:
        """As many directions as lights."""
        same = "<f4", ("stars", 3)
        checks.arrays(self, {"direction": same, "irradiance_rgb": same})
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Unit vectors, and light that is finite."""
        if self.direction.shape[0]:
            checks.contents(self, "direction", -1.001, 1.001)
            checks.contents(self, "irradiance_rgb", 0.0, MOST_LIGHT)


class EarthShadow(msgspec.Struct, frozen=True, kw_only=True):
    """The Earth's shadow where the moon is, as a place sees it.

    Sunlight is undimmed outside `penumbra_rad` of `direction`. Within `umbra_rad` the share
    `umbra_rgb` of it remains at the middle, `EDGE_OVER_MIDDLE` times as much at the edge.
    """

    direction: Vector
    umbra_rad: float
    penumbra_rad: float
    umbra_rgb: Vector

    def check(self) -> None:
        """Two circles, and a share of light."""
        checks.direction(self, "direction")
        checks.number(self, "umbra_rad", 1e-6, _WIDEST_RAD)
        checks.number(self, "penumbra_rad", self.umbra_rad, _WIDEST_RAD)
        checks.light(self, "umbra_rgb", 1.0)


class MoonDiscChanged(Derived, frozen=True, kw_only=True):
    """The moon's disc: a sphere lit by the sun after Lommel and Seeliger.

    Radiance is `lit_rgb` albedo mu0 / (mu0 + mu) plus `dark_rgb` albedo, W m^-2 sr^-1: mu0 and mu
    are the cosines of sun and eye at the surface. `through_rgb` (3 * `THROUGH_PLACES` numbers) is
    the transmittance of the air before it, from its lowest place to its highest; empty without air.
    albedo (rows, columns) float32 is relative, its rows from the moon's north, its columns from
    longitude -180 deg to the east.
    `axes` (9 numbers, row by row) are the moon's own in world axes: x to the mean Earth, z north.
    `flattening` is the disc's height over its width: refraction raises the lower limb more.
    `sun_left_rgb` is below 1 while the moon hides a part of the sun. `shadow` is the Earth's, near
    a full moon that it reaches. `horizon_rad` is the horizon's elevation, below 0 for an eye aloft;
    it hides the disc below.
    """

    slot: ClassVar[str | None] = SLOT

    direction: Vector
    angular_radius_rad: float
    flattening: float
    to_sun: Vector
    axes: tuple[float, ...]
    lit_rgb: Vector
    dark_rgb: Vector
    albedo: Array
    source: str
    sun_left_rgb: Vector = NO_ECLIPSE
    shadow: EarthShadow | None = None
    horizon_rad: float = 0.0
    through_rgb: tuple[float, ...] = ()

    def check(self) -> None:
        """A disc in the sky."""
        checks.instance(self, "shadow", (EarthShadow, type(None)))
        if self.shadow is not None:
            self.shadow.check()
        checks.direction(self, "direction")
        checks.direction(self, "to_sun")
        checks.number(self, "angular_radius_rad", 1e-6, _WIDEST_RAD)
        checks.number(self, "flattening", 0.1, 1.0)
        checks.numbers(self, "axes", 9)
        checks.light(self, "lit_rgb", MOST_LIGHT)
        checks.light(self, "dark_rgb", MOST_LIGHT)
        checks.arrays(self, {"albedo": ("<f4", ("rows", "columns"))})
        checks.light(self, "sun_left_rgb", 1.0)
        checks.number(self, "horizon_rad", -0.5 * math.pi, 0.0)
        if self.through_rgb != ():
            checks.numbers(self, "through_rgb", 3 * THROUGH_PLACES)
        checks.text(self, "source")

    def check_arrays(self) -> None:
        """Albedo, which is finite."""
        checks.contents(self, "albedo", 0.0, MOST_LIGHT)

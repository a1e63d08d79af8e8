"""The sun's direction, and the key light: the light that casts shadows."""

import math
from typing import ClassVar, Literal, get_args

from vrut_lite import checks
from vrut_lite.atmosphere.haze_layer import HazeLayer
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.limits import MOST_LIGHT
from vrut_lite.numeric_types import Vector

Body = Literal["sun", "moon"]
# A full turn, and straight up, with room for rounding.
_TURN_RAD, _UP_RAD = 6.3, 1.58
# As the frame's shader has them.
_MOST_LIMB_TERMS = 6


class SunMoved(Derived, frozen=True, kw_only=True):
    """The sun's direction, apparent, in world axes, pointing to the sun."""

    slot: ClassVar[str | None] = "sun"

    direction: Vector
    azimuth_rad: float
    elevation_rad: float
    apparent_elevation_rad: float
    visible_disc_fraction: float

    def check(self) -> None:
        """Angles, and a share of the disc."""
        checks.direction(self, "direction")
        checks.number(self, "azimuth_rad", -_TURN_RAD, _TURN_RAD)
        checks.number(self, "elevation_rad", -_UP_RAD, _UP_RAD)
        checks.number(self, "apparent_elevation_rad", -_UP_RAD, _UP_RAD)
        checks.number(self, "visible_disc_fraction", 0.0, 1.0)


def sun_moved(
    azimuth_rad: float,
    elevation_rad: float,
    apparent_elevation_rad: float,
    visible_disc_fraction: float,
    north_offset_rad: float,
) -> SunMoved:
    """The message of a sun, azimuth from north; `north_offset_rad` is the azimuth of -Z."""
    seen = direction_from_angles(azimuth_rad, apparent_elevation_rad)
    x, y, z = world_from_enu(seen, north_offset_rad).tolist()
    return SunMoved(
        direction=(x, y, z),
        azimuth_rad=float(azimuth_rad),
        elevation_rad=float(elevation_rad),
        apparent_elevation_rad=float(apparent_elevation_rad),
        visible_disc_fraction=float(visible_disc_fraction),
    )


class KeyLightChanged(Derived, frozen=True, kw_only=True):
    """The light that casts shadows: irradiance (W m^-2, linear sRGB) on a plane that faces it.

    `body`: the sun, or at night the moon.

    `limb_darkening_rgb` holds, per channel, a polynomial in cos psi (constant first), of
    which the mean over the disc is 1: radiance = irradiance / solid angle * polynomial.

    `haze` is the haze profile that dims it besides clear air, so that sunlight above the ground can
    be computed.
    """

    slot: ClassVar[str | None] = "sky"

    direction: Vector
    irradiance_rgb: Vector
    angular_radius_rad: float
    limb_darkening_rgb: tuple[tuple[float, ...], ...]
    source: str
    body: Body = "sun"
    haze: tuple[HazeLayer, ...] = ()

    @property
    def even_radius_rad(self) -> float:
        """Radius of an evenly bright disc whose penumbras are as wide as this one's.

        Both discs have the same mean square of the distance from the middle, x: the mean over the
        disc of cos^n psi is 2 / (n + 2), with psi's sine x; that of x^2 cos^n psi is
        2 / (n + 2) - 2 / (n + 4).
        """
        light = squared = 0.0
        for terms in self.limb_darkening_rgb:
            for n, term in enumerate(terms):
                light += term * 2.0 / (n + 2)
                squared += term * (2.0 / (n + 2) - 2.0 / (n + 4))
        return self.angular_radius_rad * math.sqrt(max(2.0 * squared / light, 0.0))

    def check(self) -> None:
        """A disc in the sky, and polynomials of as many terms as are drawn."""
        checks.direction(self, "direction")
        checks.light(self, "irradiance_rgb", MOST_LIGHT)
        checks.number(self, "angular_radius_rad", 1e-6, 0.5 * math.pi)
        checks.polynomials(self, "limb_darkening_rgb", 3, _MOST_LIMB_TERMS)
        checks.text(self, "source")
        checks.choice(self, "body", get_args(Body))
        checks.instance(self, "haze", tuple)
        for layer in self.haze:
            if not isinstance(layer, HazeLayer):
                checks.refuse(self, "haze", "be of HazeLayer")
            layer.check()

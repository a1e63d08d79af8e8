"""The moon, and the sun beside it, as seen by an eye above a place."""

import math
from datetime import datetime
from typing import NamedTuple

import msgspec

from night_sky.disc import disc_of
from night_sky.earth_shadow import earth_shadow
from night_sky.eclipse import sun_left
from night_sky.moon import Moon, moon_at
from night_sky.night_air import NightAir
from night_sky.sky_axes import Watch, sun_elevation_rad, watch
from vrut_lite.messages.night import EarthShadow, MoonDiscChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.numeric_types import Vector

# Above this elevation of the sun there is neither glow nor star to be seen from the ground.
_DAY_DEG = 0.6


class Sight(NamedTuple):
    """`shadow`: the Earth's, where it reaches the moon. `sun_left_rgb`: of the sun's light."""

    at: Watch
    moon: Moon
    shadow: EarthShadow | None
    sun_left_rgb: Vector
    by_day: bool
    eye_height_m: float

    def disc(self, air: NightAir, source: str) -> MoonDiscChanged:
        """The moon's disc behind the air before this eye."""
        disc = disc_of(self.moon, air, source, self.eye_height_m)
        return msgspec.structs.replace(disc, sun_left_rgb=self.sun_left_rgb, shadow=self.shadow)


def sight(instant: datetime, place: SetPlace, danjon: float, eye_height_m: float = 0.0) -> Sight:
    """The sight at an aware instant; `danjon` is the brightness of an eclipsed moon, 0 to 4."""
    where = place.latitude_deg, place.longitude_deg, place.altitude_m + eye_height_m
    at = watch(instant, *where, place.north_offset_rad)
    moon = moon_at(at, eye_height_m)
    red, green, blue = (float(share) for share in sun_left(at))
    return Sight(
        at,
        moon,
        earth_shadow(at, moon, danjon, eye_height_m),
        (red, green, blue),
        math.degrees(sun_elevation_rad(at)) > _DAY_DEG,
        eye_height_m,
    )

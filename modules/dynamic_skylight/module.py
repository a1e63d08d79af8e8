"""DynamicSkyLight on the bus: from clock and place to the sun, from the sun to sky and light.

It may hold the slots `sun` and `sky`, either without the other; for a slot that it does not
hold it does nothing.
"""

from collections.abc import Callable

import numpy as np

from dynamic_skylight.daylight import Daylight
from dynamic_skylight.settings import DynamicSkyLightSettings
from dynamic_skylight.sun.disc import MEAN_ANGULAR_RADIUS_RAD
from dynamic_skylight.sun.position import sun_position
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.geometry.frames import world_from_enu
from vrut_lite.kernel.array import Array
from vrut_lite.kernel.messages import (
    AmbientChanged,
    BackgroundChanged,
    Demand,
    Derived,
    SetClock,
    SetPlace,
    SlotChanged,
    SunLightChanged,
    SunMoved,
    Vector,
)
from vrut_lite.kernel.module import Link, Manifest, Module, handles

NAME = "dynamic_skylight"
DEFAULT_SIZE = 256
Recipe = tuple[object, ...]


class DynamicSkyLight(Module):
    """The sun's position and the Hosek-Wilkie sky.

    The ledger counts, for each message type by name: done, and skipped as "unwanted" or
    "unchanged" (the inputs are those of what was posted last).
    """

    manifest = Manifest(
        name=NAME, title="DynamicSkyLight", version="0.1.0", provides=("sun", "sky")
    )
    settings_type = DynamicSkyLightSettings
    settings: DynamicSkyLightSettings

    def __init__(self, link: Link, settings: DynamicSkyLightSettings):
        super().__init__(link, settings)
        self._posted: dict[type[Derived], Recipe] = {}
        self._daylight: Daylight | None = None

    @handles(SetClock)
    @handles(SetPlace)
    def inputs_changed(self, _message: SetClock | SetPlace) -> None:
        """The hour or the place changed: so may the sun."""
        self._move_sun()

    @handles(SlotChanged)
    def slot_changed(self, message: SlotChanged) -> None:
        """Another holder's messages came between: say everything of the slot again."""
        if message.name == "sun":
            self._posted.pop(SunMoved, None)
            self._move_sun()
        elif message.name == "sky":
            for kind in (BackgroundChanged, SunLightChanged, AmbientChanged):
                self._posted.pop(kind, None)
            self._light_sky()

    @handles(SunMoved)
    @handles(Demand)
    def sky_needed(self, _message: SunMoved | Demand) -> None:
        """The sun moved, or someone wants what nobody wanted before."""
        self._light_sky()

    def settings_changed(self, name: str) -> None:
        """A setting has a new value: work out again what depends on it."""
        if name == "sun_method":
            self._move_sun()
        else:
            self._light_sky()

    def _move_sun(self) -> None:
        clock, place = self.link.last(SetClock), self.link.last(SetPlace)
        if clock is None or place is None or not self.link.holds("sun"):
            return
        recipe = (clock, place, self.settings.sun_method)
        self._post_if_new(SunMoved, recipe, lambda: self._sun_moved(clock, place))

    def _sun_moved(self, clock: SetClock, place: SetPlace) -> SunMoved:
        sun = sun_position(
            clock.instant,
            place.latitude_deg,
            place.longitude_deg,
            self.settings.sun_method,
            altitude_m=place.altitude_m,
        )
        return SunMoved(
            direction=_vector(world_from_enu(sun.direction, place.north_offset_rad)),
            azimuth_rad=sun.azimuth_rad,
            elevation_rad=sun.elevation_rad,
            apparent_elevation_rad=sun.apparent_elevation_rad,
            visible_disc_fraction=sun.visible_disc_fraction,
        )

    def _light_sky(self) -> None:
        sun = self.link.last(SunMoved)
        if sun is None or not self.link.holds("sky"):
            return
        daylight = self._daylight_of(sun)
        demand = self._demand(BackgroundChanged)
        if demand is not None:
            size = demand.size if demand.size > 1 else DEFAULT_SIZE
            self._post_if_new(
                BackgroundChanged, (daylight, size), lambda: _background(daylight, size)
            )
        if self._demand(SunLightChanged) is not None:
            self._post_if_new(
                SunLightChanged, (daylight, sun.direction), lambda: _sun_light(daylight, sun)
            )
        if self._demand(AmbientChanged) is not None:
            self._post_if_new(AmbientChanged, (daylight,), lambda: _ambient(daylight))

    def _daylight_of(self, sun: SunMoved) -> Daylight:
        """The hour's light; the same object, with all it has worked out, for the same hour."""
        x, _, z = sun.direction
        daylight = Daylight(
            turbidity=self.settings.turbidity,
            albedo=self.settings.albedo,
            sun_colour=self.settings.sun_colour,
            apparent_elevation_rad=sun.apparent_elevation_rad,
            sun_azimuth_rad=float(np.arctan2(x, -z)),
            visible_disc_fraction=sun.visible_disc_fraction,
        )
        if daylight != self._daylight:
            self._daylight = daylight
        return self._daylight or daylight

    def _demand(self, kind: type[Derived]) -> Demand | None:
        demand = self.link.wanted(kind)
        if demand is None:
            self.ledger.skip(f"{kind.__name__} unwanted")
        return demand

    def _post_if_new(
        self, kind: type[Derived], recipe: Recipe, make: Callable[[], Derived]
    ) -> None:
        if self._posted.get(kind) == recipe:
            self.ledger.skip(f"{kind.__name__} unchanged")
            return
        self.link.post(make())
        self._posted[kind] = recipe
        self.ledger.did(kind.__name__)


def _background(daylight: Daylight, size: int) -> BackgroundChanged:
    values, scale = encode_float16(daylight.background(size))
    return BackgroundChanged(cube=Array(values), radiance_scale=scale, source=NAME)


def _sun_light(daylight: Daylight, sun: SunMoved) -> SunLightChanged:
    return SunLightChanged(
        direction=sun.direction,
        irradiance_rgb=_vector(daylight.sun.irradiance_rgb),
        angular_radius_rad=MEAN_ANGULAR_RADIUS_RAD,
        limb_darkening_rgb=daylight.sun.limb_darkening_rgb,
        source=NAME,
    )


def _ambient(daylight: Daylight) -> AmbientChanged:
    coefficients = daylight.ambient().astype(np.float32)
    return AmbientChanged(irradiance_sh_rgb=Array(coefficients), source=NAME)


def _vector(values: np.ndarray) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z

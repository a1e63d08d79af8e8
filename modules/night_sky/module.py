"""The night on the bus: from clock and place to moonlight, glow, stars and the moon's disc.

Skies add the light (`sky_at_night.py`); the frame and panoramas draw stars and disc. By day there
is the moon alone. Nothing is computed where the setting `night` is off or nobody wants light of the
sky.
"""

import math
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from night_sky.settings import NightSkySettings
from vrut_lite.array import Array
from vrut_lite.daylight.haze import SetHaze, haze_of
from vrut_lite.daylight.moon_path import MoonPathChanged
from vrut_lite.daylight.night import (
    SLOT,
    MoonDiscChanged,
    MoonLight,
    NightLightChanged,
    StarsChanged,
)
from vrut_lite.daylight.night_glow import map_directions
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.sky_module import PRODUCTS
from vrut_lite.daylight.sun import SunMoved
from vrut_lite.kernel.messages import ClockMoved, Demand, Derived, SlotChanged
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.numeric_types import FloatArray, Vector

if TYPE_CHECKING:
    from night_sky.moon import Moon
    from night_sky.night_air import NightAir
    from night_sky.sky_axes import Watch

NAME = "night_sky"
_DRAWN: tuple[type, ...] = StarsChanged, MoonDiscChanged, MoonPathChanged
_DEMANDED = {kind.__name__ for kind in (*_DRAWN, *PRODUCTS)}
# Rows and columns of the glow's map, and how long one serves: a quarter of a texel.
_ROWS, _COLUMNS = 45, 90
_GLOW_SERVES = timedelta(minutes=4)
# Above this elevation of the sun there is neither glow nor star to be seen.
_DAY_DEG = 0.6
# Below this elevation the moon lights nothing: a hundredth of the moonless night.
_MOON_GONE_DEG = -8.0
# Sine of the elevation below which nothing is raised over the horizon.
_HIDDEN_SINE = -0.012
# Irradiance (W m^-2) behind the air below which a star is not told: magnitude 10.
_FAINTEST = 4e-13


class NightSky(Module):
    """Holds the slot `night`.

    The ledger counts "moon", "path", "glow" and "stars" made, and skips "night: off", "night:
    unwanted", "glow: turned unseen" and "stars: unwanted".
    """

    manifest = Manifest(name=NAME, title="Night sky", version="0.1.0", provides=(SLOT,))
    settings_type = NightSkySettings
    settings: NightSkySettings

    def __init__(self, link: Link, settings: NightSkySettings):
        super().__init__(link, settings)
        self._told = False
        self._glow_of: tuple[object, ...] = ()
        self._glow_at: datetime | None = None
        self._glow: Array | None = None
        self._air_of: SetHaze | None = None
        self._air: NightAir | None = None
        self._path_of: tuple[object, ...] = ()

    @handles(ClockMoved)
    @handles(SetPlace)
    @handles(SetHaze)
    @handles(SlotChanged)
    def inputs_changed(self, _message: ClockMoved | SetPlace | SetHaze | SlotChanged) -> None:
        """Another hour, place or air."""
        self._update()

    @handles(Demand)
    def on_demand(self, message: Demand) -> None:
        """The first who wants light; other messages' demands change no night."""
        if message.message in _DEMANDED:
            self._update()

    def settings_changed(self, name: str) -> None:
        """Tell the night anew."""
        self._update()

    def _update(self) -> None:
        clock, place = self.link.last(ClockMoved), self.link.last(SetPlace)
        if clock is None or place is None or not self.link.holds(SLOT):
            return
        if not self.settings.night:
            self.ledger.skip("night: off")
            if self._told:
                self._told = False
                self._post(
                    NightLightChanged(instant=clock.instant, moon=None, glow_rgb=None, source=NAME)
                )
                self._post(_no_stars())
            self._tell_path(clock.instant, None)
            return
        self._tell_path(clock.instant, place)
        if all(self.link.wanted(kind) is None for kind in PRODUCTS):
            self.ledger.skip("night: unwanted")
            return
        # Imported when needed: whoever only lists modules needs no ephemeris.
        from night_sky.disc import disc_of
        from night_sky.earth_shadow import earth_shadow, light_left
        from night_sky.eclipse import sun_left
        from night_sky.moon import moon_at
        from night_sky.sky_axes import sun_elevation_rad, watch

        self._told = True
        where = place.latitude_deg, place.longitude_deg, place.altitude_m, place.north_offset_rad
        at = watch(clock.instant, *where)
        air = self._present_air()
        moon = moon_at(at)
        by_day = math.degrees(sun_elevation_rad(at)) > _DAY_DEG
        shadow = earth_shadow(at, moon, self.settings.danjon)
        light = moon_light(moon, place.north_offset_rad, light_left(moon, shadow))
        left = _vector(sun_left(at))
        self.ledger.did("moon")
        self._post(
            NightLightChanged(
                instant=clock.instant,
                moon=light,
                glow_rgb=None if by_day else self._present_glow(clock.instant, at, air, where),
                source=NAME,
                sun_left_rgb=left,
            )
        )
        if light is not None and self.link.wanted(MoonDiscChanged) is not None:
            disc = disc_of(moon, air.through(np.array(moon.direction[1])), NAME)
            self._post(msgspec.structs.replace(disc, sun_left_rgb=left, shadow=shadow))
        if self.link.wanted(StarsChanged) is None:
            self.ledger.skip("stars: unwanted")
        elif by_day or not self.settings.show_stars:
            self.ledger.skip("stars: by day, or off")
            self._post(_no_stars())
        else:
            self._post(stars_seen(at, air))
            self.ledger.did("stars")

    def _tell_path(self, instant: datetime, place: SetPlace | None) -> None:
        """Post the moon's path of a date and a place; one without places where there is no night.

        Nothing is posted where nobody wants it, or where it is known.
        """
        made_of = instant.astimezone(UTC).date(), place
        if self.link.wanted(MoonPathChanged) is None or made_of == self._path_of:
            return
        self._path_of = made_of
        if place is None:
            none = Array(np.zeros((0, 3), np.float32))
            self._post(
                MoonPathChanged(
                    start=instant, step_s=1.0, direction=none, rises_s=(), sets_s=(), source=NAME
                )
            )
            return
        from night_sky.path import moon_path

        self._post(moon_path(instant, place, NAME))
        self.ledger.did("path")

    def _present_air(self) -> "NightAir":
        from night_sky.night_air import night_air

        haze = haze_of(self.link)
        if self._air is None or haze != self._air_of:
            self._air_of, self._air = haze, night_air(haze)
        return self._air

    def _present_glow(
        self, instant: datetime, at: "Watch", air: "NightAir", where: tuple[float, ...]
    ) -> Array:
        from night_sky.glow import Sources, glow

        sources = Sources(self.settings.solar_flux_sfu, self.settings.zenith_magnitude)
        made_of = where, sources, self._air_of
        turned = self._glow_at is None or abs(instant - self._glow_at) >= _GLOW_SERVES
        if self._glow is None or turned or made_of != self._glow_of:
            light = glow(map_directions(_ROWS, _COLUMNS), at, air, sources)
            self._glow = Array(np.maximum(light, 0.0).astype(np.float32))
            self._glow_at, self._glow_of = instant, made_of
            self.ledger.did("glow")
        else:
            self.ledger.skip("glow: turned unseen")
        return self._glow

    def _post(self, message: Derived) -> None:
        self.link.post(message)


def moon_light(
    moon: "Moon", north_offset_rad: float, left_rgb: FloatArray | float = 1.0
) -> MoonLight | None:
    """The moon as a source of light, with what the Earth's shadow leaves of it; None where it is
    too low to be one."""
    from night_sky.moon_light import irradiance_rgb, sun_rgb

    true = math.asin(min(max(float(moon.true_direction[1]), -1.0), 1.0))
    if math.degrees(true) < _MOON_GONE_DEG:
        return None
    light = irradiance_rgb(moon.phase) * left_rgb
    x, y, z = _vector(moon.direction)
    return MoonLight(
        place=SunMoved(
            direction=(x, y, z),
            azimuth_rad=(math.atan2(x, -z) + north_offset_rad) % (2.0 * math.pi),
            elevation_rad=true,
            apparent_elevation_rad=math.asin(min(max(y, -1.0), 1.0)),
            visible_disc_fraction=moon.visible_disc_fraction,
        ),
        irradiance_rgb=_vector(light),
        of_sunlight_rgb=_vector(light / sun_rgb()),
        angular_radius_rad=moon.angular_radius_rad,
        lit_fraction=moon.lit_fraction,
        waxes=moon.phase.sun_longitude_rad > 0.0,
    )


def stars_seen(at: "Watch", air: "NightAir") -> StarsChanged:
    """Stars and planets above the horizon, behind the air, brightest first."""
    from night_sky.planets import planets_at
    from night_sky.sky_axes import refracted
    from night_sky.stars import stars_at

    found = [stars_at(at), planets_at(at)]
    direction = np.concatenate([some.direction for some in found])
    # Those that refraction may raise over the horizon.
    near = direction[:, 1] > _HIDDEN_SINE
    direction = refracted(direction[near])
    light = np.concatenate([some.irradiance_rgb for some in found])[near]
    light *= air.through(direction[:, 1])
    seen = (direction[:, 1] > 0.0) & (light[:, 1] > _FAINTEST)
    light, direction = light[seen], direction[seen]
    order = np.argsort(-light[:, 1], kind="stable")
    return StarsChanged(
        direction=Array(direction[order].astype(np.float32)),
        irradiance_rgb=Array(light[order].astype(np.float32)),
        source=NAME,
    )


def _no_stars() -> StarsChanged:
    none = Array(np.zeros((0, 3), np.float32))
    return StarsChanged(direction=none, irradiance_rgb=none, source=NAME)


def _vector(values: FloatArray) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z

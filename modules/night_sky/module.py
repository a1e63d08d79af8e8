"""The night on the bus: from clock and place to moonlight, glow, stars and the moon's disc.

Skies add the light (`sky_at_night.py`), which is the ground's; the frame and panoramas draw stars
and disc, which are what the eye sees, from aloft too. By day there is the moon alone, and above the
air the stars. Nothing is computed where the setting `night` is off or nobody wants light of the
sky.
"""

import math
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from night_sky.earth_shadow import light_left
from night_sky.glow import GlowSources, glow, lamps_from_above
from night_sky.moon_light import irradiance_rgb, sun_rgb
from night_sky.night_air import night_air
from night_sky.path import moon_path
from night_sky.planets import planets_at
from night_sky.settings import NightSkySettings
from night_sky.sight import sight
from night_sky.sky_axes import refracted
from night_sky.stars import stars_at
from vrut_lite import __version__
from vrut_lite.array import Array
from vrut_lite.atmosphere.refraction import dip_rad, eye_aloft_m, horizon_elevation
from vrut_lite.kernel.messages import ClockMoved, Demand, Derived, SlotChanged
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.haze import SetHaze, haze_of
from vrut_lite.messages.moon_path import MoonPathChanged
from vrut_lite.messages.night import (
    NO_ECLIPSE,
    SLOT,
    MoonDiscChanged,
    MoonLight,
    NightLightChanged,
    StarsChanged,
)
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneNeeds
from vrut_lite.messages.sky import NO_LAMPS
from vrut_lite.messages.sun import SunMoved
from vrut_lite.numeric_types import FloatArray, Vector, vector
from vrut_lite.sky.eye import eye_height_m
from vrut_lite.sky.night_glow import map_directions
from vrut_lite.sky.sky_module import PRODUCTS

if TYPE_CHECKING:
    from night_sky.glow import GlowSources
    from night_sky.moon import Moon
    from night_sky.night_air import NightAir
    from night_sky.sight import Sight
    from night_sky.sky_axes import Watch

NAME = "night_sky"
_DRAWN: tuple[type, ...] = StarsChanged, MoonDiscChanged, MoonPathChanged
_DEMANDED = {kind.__name__ for kind in (*_DRAWN, *PRODUCTS)}
# Rows and columns of the glow's map, and how long one serves: a quarter of a texel.
_ROWS, _COLUMNS = 45, 90
_GLOW_SERVES_DAYS = 4.0 / 1440.0
# Below this elevation the moon lights nothing: a hundredth of the moonless night.
_MOON_GONE_DEG = -8.0
# How far below the horizon a body may be that refraction raises over it, in units of the sine.
_HIDDEN_SINE = 0.002
# From this height up stars are seen by day.
_SPACE_M = 100_000.0
# An eye whose height changes by a smaller share sees the same: its horizon moves by 0.5 %.
_UNSEEN_SHARE = 0.01
# Irradiance (W m^-2) behind the air below which a star is not told: magnitude 10.
_FAINTEST = 4e-13


class NightSky(Module):
    """Holds the slot `night`.

    The counters count "moon", "path", "glow" and "stars" made, and skips "night: off", "night:
    unwanted", "glow: turned unseen" and "stars: unwanted".
    """

    manifest = Manifest(name=NAME, title="Night sky", version=__version__, provides=(SLOT,))
    settings_type = NightSkySettings
    settings: NightSkySettings

    def __init__(self, link: Link, settings: NightSkySettings):
        super().__init__(link, settings)
        self._told = False
        self._glow_of: tuple[object, ...] = ()
        self._glow_at: float | None = None
        self._glow: Array | None = None
        self._air_of: SetHaze | None = None
        # By the eye's height, which is 0 near the ground.
        self._air: dict[float, NightAir] = {}
        self._eye_m = 0.0
        self._disc_shown = False
        self._path_of: tuple[object, ...] = ()

    @handles(ClockMoved)
    @handles(SetPlace)
    @handles(SetHaze)
    @handles(SlotChanged)
    def inputs_changed(self, _message: ClockMoved | SetPlace | SetHaze | SlotChanged) -> None:
        """Another hour, place or air."""
        self._update()

    @handles(MoveCamera)
    @handles(SceneNeeds)
    def view_changed(self, _message: MoveCamera | SceneNeeds) -> None:
        """Another eye sees stars and disc elsewhere; what lights the ground stays."""
        eye_m = eye_aloft_m(eye_height_m(self.link))
        if abs(eye_m - self._eye_m) > _UNSEEN_SHARE * self._eye_m:
            self._eye_m = eye_m
            clock, place = self.link.last(ClockMoved), self.link.last(SetPlace)
            if self._told and clock is not None and place is not None:
                self._tell_points(self._present_sight(clock.instant, place))

    @handles(Demand)
    def on_demand(self, message: Demand) -> None:
        """The first who wants light; other messages' demands change no night."""
        if message.message in _DEMANDED:
            self._update()

    def settings_changed(self, name: str) -> None:
        """Post the night of the new settings."""
        self._update()

    def _update(self) -> None:
        clock, place = self.link.last(ClockMoved), self.link.last(SetPlace)
        if clock is None or place is None or not self.link.holds(SLOT):
            return
        if not self.settings.night:
            self.counters.skip("night: off")
            if self._told:
                self._told = False
                self._post(
                    NightLightChanged(instant=clock.instant, moon=None, glow_rgb=None, source=NAME)
                )
                self._post(_no_stars())
                self._hide_disc()
            self._tell_path(clock.instant, None)
            return
        self._tell_path(clock.instant, place)
        if all(self.link.wanted(kind) is None for kind in PRODUCTS):
            self.counters.skip("night: unwanted")
            return
        self._told = True
        where = place.latitude_deg, place.longitude_deg, place.altitude_m, place.north_offset_rad
        below = sight(clock.instant, place, self.settings.danjon)
        lit = light_left(below.moon, below.shadow)
        light = moon_light(below.moon, place.north_offset_rad, lit)
        self.counters.did("moon")
        self._post(
            NightLightChanged(
                instant=clock.instant,
                moon=light,
                glow_rgb=None if below.by_day else self._present_glow(below.at, where),
                source=NAME,
                sun_left_rgb=below.sun_left_rgb,
                lamps_rgb=NO_LAMPS if below.by_day else self._lamps_rgb(),
            )
        )
        self._tell_points(self._present_sight(clock.instant, place) if self._eye_m else below)

    def _present_sight(self, instant: datetime, place: SetPlace) -> "Sight":
        return sight(instant, place, self.settings.danjon, self._eye_m)

    def _tell_points(self, seen: "Sight") -> None:
        """Post the moon's disc and the stars as the eye sees them."""
        air = self._present_air(self._eye_m)
        shown = seen.moon.visible_disc_fraction > 0.0
        if (shown or self._disc_shown) and self.link.wanted(MoonDiscChanged) is not None:
            self._disc_shown = shown
            self._post(seen.disc(air, NAME))
        if self.link.wanted(StarsChanged) is None:
            self.counters.skip("stars: unwanted")
        elif not self.settings.show_stars or (seen.by_day and self._eye_m < _SPACE_M):
            self.counters.skip("stars: by day, or off")
            self._post(_no_stars())
        else:
            self._post(stars_seen(seen.at, air, self._eye_m))
            self.counters.did("stars")

    def _hide_disc(self) -> None:
        """Post the disc below the horizon, if it is shown."""
        disc = self.link.last(MoonDiscChanged)
        if self._disc_shown and disc is not None:
            self._disc_shown = False
            hidden = msgspec.structs.replace(
                disc, direction=(0.0, -1.0, 0.0), sun_left_rgb=NO_ECLIPSE
            )
            self._post(hidden)

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
        self._post(moon_path(instant, place, NAME))
        self.counters.did("path")

    def _present_air(self, eye_m: float = 0.0) -> "NightAir":
        """The air before an eye; the ground's is kept beside it."""
        haze = haze_of(self.link)
        if haze != self._air_of:
            self._air_of, self._air = haze, {}
        if eye_m not in self._air:
            ground = {0.0: self._air[0.0]} if 0.0 in self._air else {}
            self._air = {**ground, eye_m: night_air(haze, eye_m)}
        return self._air[eye_m]

    @property
    def _sources(self) -> "GlowSources":
        return GlowSources(self.settings.solar_flux_sfu, self.settings.zenith_magnitude)

    def _lamps_rgb(self) -> Vector:
        red, green, blue = lamps_from_above(haze_of(self.link), self._sources).tolist()
        return red, green, blue

    def _present_glow(self, at: "Watch", where: tuple[float, ...]) -> Array:
        sources = self._sources
        made_of = where, sources, self._air_of
        air, days = self._present_air(), at.time.ut
        turned = self._glow_at is None or abs(days - self._glow_at) >= _GLOW_SERVES_DAYS
        if self._glow is None or turned or made_of != self._glow_of:
            light = glow(map_directions(_ROWS, _COLUMNS), at, air, sources)
            self._glow = Array(np.maximum(light, 0.0).astype(np.float32))
            self._glow_at, self._glow_of = days, made_of
            self.counters.did("glow")
        else:
            self.counters.skip("glow: turned unseen")
        return self._glow

    def _post(self, message: Derived) -> None:
        self.link.post(message)


def moon_light(
    moon: "Moon", north_offset_rad: float, left_rgb: FloatArray | float = 1.0
) -> MoonLight | None:
    """The moon as a source of light, with what the Earth's shadow leaves of it; None where it is
    too low to be one."""
    true = math.asin(min(max(float(moon.true_direction[1]), -1.0), 1.0))
    if math.degrees(true) < _MOON_GONE_DEG:
        return None
    light = irradiance_rgb(moon.phase) * left_rgb
    x, y, z = vector(moon.direction)
    return MoonLight(
        place=SunMoved(
            direction=(x, y, z),
            azimuth_rad=(math.atan2(x, -z) + north_offset_rad) % (2.0 * math.pi),
            elevation_rad=true,
            apparent_elevation_rad=math.asin(min(max(y, -1.0), 1.0)),
            visible_disc_fraction=moon.visible_disc_fraction,
        ),
        irradiance_rgb=vector(light),
        of_sunlight_rgb=vector(light / sun_rgb()),
        angular_radius_rad=moon.angular_radius_rad,
        lit_fraction=moon.lit_fraction,
        waxes=moon.phase.sun_longitude_rad > 0.0,
    )


def stars_seen(at: "Watch", air: "NightAir", eye_height_m: float = 0.0) -> StarsChanged:
    """Stars and planets over an eye's horizon, behind the air before it, brightest first."""
    found = [stars_at(at), planets_at(at)]
    direction = np.concatenate([some.direction for some in found])
    # Those that refraction may raise over the horizon.
    near = direction[:, 1] > math.sin(horizon_elevation(eye_height_m)) - _HIDDEN_SINE
    direction = refracted(direction[near], eye_height_m)
    light = np.concatenate([some.irradiance_rgb for some in found])[near]
    light *= air.through(direction[:, 1])
    horizon_sine = -math.sin(dip_rad(eye_height_m))
    seen = (direction[:, 1] > horizon_sine) & (light[:, 1] > _FAINTEST)
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

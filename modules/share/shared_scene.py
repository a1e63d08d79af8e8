"""A scene and its sky by messages, without a window: what a page is computed from."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import NamedTuple

import astronomy
import msgspec
import numpy as np
from light_transport.public import Illumination, hour_of
from numpy.typing import ArrayLike

from share.frozen_clouds import FrozenClouds
from share.page_night import Glow
from share.page_stars import Sighting
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.geometry.cube_map import reduce_cube
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.headless import Project, SceneKernel, require_sun
from vrut_lite.kernel.messages import Demand, EnableModule, SetSetting
from vrut_lite.messages.air import AirChanged, AirVolume
from vrut_lite.messages.clouds import CloudLayer, CloudsChanged
from vrut_lite.messages.night import (
    MoonDiscChanged,
    MoonLight,
    NightLightChanged,
    StarsChanged,
)
from vrut_lite.messages.sky_light import SkyGlowAdded
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector
from vrut_lite.sky.night_glow import glow_cube
from vrut_lite.sky.sky_at_night import night_share, sun_share
from vrut_lite.sky.sky_layer import Viewpoint, sky_layers
from vrut_lite.sky.suns import suns_at

# Edge (texels) of the cube maps from which tables of the sky are read.
_CUBE = 128
# Edge of the cube maps of clouds, as of those that light the scene: 1.6 s of CPU, not 4.3.
_CLOUDY_CUBE = 64
_CONSUMER = "share"
# Geometric elevation of the sun below which its light is gone (`sky_at_night.py`).
SUN_GONE_RAD = float(np.radians(-19.0))
# Geometric elevation of the sun below which no twilight is left.
_DARK_RAD = float(np.radians(-18.0))
_NEW_MOONS = 12
# Number of nights in which stars are looked at, and elevation of the sun below which they are.
_SIGHTINGS, _STARS_RAD = 12, float(np.radians(-10.0))
# Number of days that are searched for a sky without moonlight.
_TRIES = 13
_BLACK = (0.0, 0.0, 0.0)
_HOUR_S = 3600.0
# Time after which clouds that follow the weather are others.
_APART = timedelta(hours=7)
# Steps in which a year is searched.
_DAYS, _STEPS, _STEP_S = 365, 96, 900.0


@dataclass(frozen=True, eq=False)
class SunSky:
    """The sky by the sun alone; linear sRGB, world axes.

    Attributes:
        true_rad, apparent_rad: elevation of the sun without and with refraction.
        azimuth_rad: of the sun in world axes, from -Z clockwise from above.
        cube: (6, n, n, 3) float32, radiance in W m^-2 sr^-1.
        key_rgb: irradiance of the sun behind the air, on a plane that faces it, W m^-2.
        ground_rgb: radiance of open ground, W m^-2 sr^-1.
        albedo_rgb: of open ground.
        air: before surfaces; None where the sky makes none, or the scene is to be seen without.
    """

    true_rad: float
    apparent_rad: float
    azimuth_rad: float
    cube: Float32Array
    key_rgb: FloatArray
    ground_rgb: FloatArray
    albedo_rgb: FloatArray
    air: AirVolume | None = None


class Disc(NamedTuple):
    """Radius of the sun's disc, and polynomials of its limb darkening (3, n)."""

    angular_radius_rad: float
    limb_darkening_rgb: tuple[tuple[float, ...], ...]


class SharedScene(SceneKernel):
    """A scene whose skies are asked one by one."""

    def __init__(self, project: Project):
        """Open the scene.

        Raises:
            UserError: the project has an invalid value, or its scene cannot be read.
        """
        super().__init__(project, _CONSUMER, cube_px=_CUBE, background_px=_CUBE)
        self._project, self._start, self._has_air = project, project.instant(), project.air

    @property
    def disc(self) -> Disc:
        """The sun's disc."""
        key = self.kernel.last(KeyLightChanged)
        assert key is not None
        return Disc(key.angular_radius_rad, key.limb_darkening_rgb)

    def hour(self, instant: datetime, clouds: FrozenClouds | None) -> Illumination:
        """The light of an hour as the scene has it, behind clouds that were frozen."""
        self.go_to(instant)
        light = self.light
        if clouds is not None:
            assert light.radiance is not None
            cube = reduce_cube(light.radiance.cube.values, _CLOUDY_CUBE).astype(np.float16)
            radiance = msgspec.structs.replace(light.radiance, cube=Array(cube))
            light = msgspec.structs.replace(light, radiance=radiance)
            light = clouds.light_under(light, _CLOUDY_CUBE)
        return hour_of(light)

    # --- the sun's sky ------------------------------------------------------------------------

    def sun_skies(self, heights_rad: FloatArray) -> list[SunSky]:
        """Skies by the sun alone, by rising height; heights (n,) that it never has are left out."""
        found = []
        self._show_air(self._has_air)
        for instants in self._instants_of(heights_rad):
            sky = self._moonless_sky(instants)
            if sky is not None:
                found.append(sky)
        self._show_air(False)
        return sorted(found, key=lambda sky: sky.true_rad)

    def _show_air(self, on: bool) -> None:
        """Let the sky compute air, or spare it."""
        self.kernel.inject(SetSetting(module="scene", name="air", value=on))
        self.settle()

    def _moonless_sky(self, instants: Iterator[datetime]) -> SunSky | None:
        """The sky of the first instant without moonlight."""
        for instant in instants:
            self.go_to(instant)
            night = self.kernel.last(NightLightChanged)
            if night is None or night.moon is None or night_share(require_sun(self.kernel)) == 0.0:
                return self._sun_sky()
        return None

    def afternoon_sky(self) -> SunSky:
        """The sky of an afternoon of the year's highest sun, by sun and night."""
        seconds, heights = self._suns_of_year()
        noon = int(np.argmax(heights))
        half = noon + int(np.argmax(heights[noon : noon + _STEPS // 2] < 0.5 * heights[noon]))
        self.go_to(datetime.fromtimestamp(float(seconds[half]), UTC))
        return self._sun_sky()

    def freeze_clouds(self) -> FrozenClouds | None:
        """The clouds of the project's instant, which are then gone from the scene's own skies.

        Raises:
            UserError: they change with the hour by more than their wind.
        """
        found, key = self.kernel.last(CloudsChanged), self.light.key_light
        if found is None:
            return None
        self._check_stay(found)
        if not found.layers:
            return None
        for name in self._project.settings.get(found.source, {}):
            default = getattr(self.kernel.seats[found.source].module_type.settings_type(), name)
            self.kernel.inject(SetSetting(module=found.source, name=name, value=default))
        self.settle()
        layer = next(each for each in sky_layers().values() if each.hears is CloudsChanged)
        lower, upper = self.scene.lower_m, self.scene.upper_m
        ground_m = lower[1] if self.scene.ground is None else self.scene.ground.height_m
        middle_m = 0.5 * (lower[0] + upper[0]), max(ground_m, 0.0), 0.5 * (lower[2] + upper[2])
        half_width_m = 0.5 * max(upper[0] - lower[0], upper[2] - lower[2])
        return FrozenClouds(layer, found, Viewpoint(middle_m, middle_m, half_width_m), key)

    def _check_stay(self, clouds: CloudsChanged) -> None:
        """Check that clouds are the same some hours later, but for their wind."""
        self.go_to(self._start + _APART)
        later = self.kernel.last(CloudsChanged)
        if later is None or _without_drift(later) != _without_drift(clouds):
            raise UserError(
                "a page needs clouds that stay the same all day, and these follow the weather: "
                "choose them by --genus, or leave the weather out"
            )

    def without_glows(self) -> tuple[str, ...]:
        """Modules that add a glow to the sky, such as an aurora, which are now off."""
        found = self.kernel.last(SkyGlowAdded)
        if found is None or found.glow_rgb is None:
            return ()
        self._enable(found.source, enabled=False)
        return (found.source,)

    def _enable(self, module: str, enabled: bool) -> None:
        if module:
            self.kernel.inject(EnableModule(module=module, enabled=enabled))
            self.settle()

    def _sun_sky(self) -> SunSky:
        """The present sky without the night's glow."""
        sun, light = require_sun(self.kernel), self.light
        hour, sky = hour_of(light), light.radiance
        assert sky is not None
        x, _, z = sun.direction
        lit = light.key_light.body == "sun" and sun.visible_disc_fraction > 0.0
        cube = decode_float16(sky.cube.values, sky.radiance_scale)
        ground = np.asarray(hour.ground_radiance_rgb, float)
        albedo = np.asarray(hour.ground_albedo_rgb, float)
        night = self.kernel.last(NightLightChanged)
        if night is not None and night.glow_rgb is not None:
            # A sky without a module of the night includes a glow, which is subtracted.
            share = night_share(sun)
            glow = np.float32(share) * glow_cube(night.glow_rgb, cube.shape[1], _BLACK)
            ground = ground - albedo / np.pi * horizontal_irradiance(glow)
            cube = cube - glow
        air = self.kernel.last(AirChanged)
        return SunSky(
            true_rad=sun.elevation_rad,
            apparent_rad=sun.apparent_elevation_rad,
            azimuth_rad=float(np.arctan2(x, -z)),
            cube=np.maximum(cube, 0.0).astype(np.float32),
            key_rgb=np.asarray(hour.key_irradiance_rgb, float) * float(lit),
            ground_rgb=np.maximum(ground, 0.0),
            albedo_rgb=albedo,
            air=None if air is None else air.volume,
        )

    def _suns_of_year(self) -> tuple[FloatArray, FloatArray]:
        """Seconds (n,) since 1970 of the year's quarters of hours, and the sun's heights then."""
        first = datetime(self._start.year, 1, 1, tzinfo=UTC).timestamp()
        seconds = first + _STEP_S * np.arange(_DAYS * _STEPS)
        return np.asarray(seconds, float), self._heights_at(seconds)

    def _heights_at(self, seconds: ArrayLike) -> FloatArray:
        place = self.place
        where = place.latitude_deg, place.longitude_deg, place.altitude_m
        return suns_at(seconds, *where).elevation_rad

    def _instants_of(self, heights_rad: FloatArray) -> Iterator[Iterator[datetime]]:
        """For each height that the sun has in the year, instants at which it stands there."""
        seconds, heights = self._suns_of_year()
        # The greatest height too: skies above it would be held.
        for wanted in (*heights_rad, float(heights.max()) - 1e-4):
            over = heights > wanted
            crossed = np.flatnonzero(over[1:] != over[:-1])
            if not len(crossed):
                continue
            # The fastest crossings: the others may graze the height.
            slope = np.abs(heights[crossed + 1] - heights[crossed])
            fast = crossed[slope >= 0.7 * slope.max()]
            chosen = fast[np.linspace(0, len(fast) - 1, min(len(fast), _TRIES)).astype(int)]
            yield (
                datetime.fromtimestamp(self._crossing(seconds[step], not over[step], wanted), UTC)
                for step in chosen
            )

    def _crossing(self, low: float, rises: bool, wanted: float) -> float:
        """Seconds within a step from `low` on at which the sun passes a height."""
        high = low + _STEP_S
        for _ in range(24):
            middle = 0.5 * (low + high)
            if (self._heights_at(middle) > wanted) == rises:
                high = middle
            else:
                low = middle
        return float(low)

    def bodies(self) -> tuple[list[tuple[float, float, FloatArray]], float]:
        """Sun and moon of the present hour, and the share of the night's light.

        Each body has its geometric elevation, its azimuth from north, and its share (3,) of the
        light of a sun in its place.
        """
        sun, night = require_sun(self.kernel), self.kernel.last(NightLightChanged)
        found = [(sun.elevation_rad, sun.azimuth_rad, np.full(3, sun_share(sun)))]
        share = 0.0 if night is None else night_share(sun)
        if night is not None and night.moon is not None:
            moon = night.moon
            light = share * np.asarray(moon.of_sunlight_rgb)
            found.append((moon.place.elevation_rad, moon.place.azimuth_rad, light))
        return found, share

    # --- the night ----------------------------------------------------------------------------

    def moonless_glows(self) -> list[Glow]:
        """Glows of the darkest hours of the year's new moons at which no twilight is left.

        Where twilight never ends the darkest hour alone; none where no module makes a night.
        """
        hours = sorted(self._moonless_hours())
        dark = [hour for hour in hours if hour[0] < _DARK_RAD] or hours[:1]
        found = []
        for _, seconds in dark:
            self.go_to(datetime.fromtimestamp(seconds, UTC))
            night = self.kernel.last(NightLightChanged)
            if night is not None and night.glow_rgb is not None:
                found.append(Glow(seconds, np.asarray(night.glow_rgb.values)))
        return found

    def _moonless_hours(self) -> Iterator[tuple[float, float]]:
        """Height of the sun at the darkest hour of each new moon of the year, and its seconds."""
        place = self.place
        after = astronomy.Time.Make(self._start.year, 1, 1, 0, 0, 0)
        for _ in range(_NEW_MOONS):
            moon = astronomy.SearchMoonPhase(0.0, after, 40.0)
            after = moon.AddDays(20.0)
            day = moon.Utc().replace(tzinfo=UTC).timestamp()
            seconds = day + _HOUR_S * np.arange(-12.0, 12.0, 0.5)
            height = suns_at(seconds, place.latitude_deg, place.longitude_deg).elevation_rad
            yield float(height.min()), float(seconds[np.argmin(height)])

    def star_sightings(self) -> Iterator[Sighting]:
        """Stars in the darkest hour of each twelfth of the year."""
        self.kernel.inject(Demand(consumer=_CONSUMER, message=StarsChanged.__name__, size=None))
        seconds, heights = self._suns_of_year()
        for part in np.array_split(np.arange(len(seconds)), _SIGHTINGS):
            darkest = part[np.argmin(heights[part])]
            self.go_to(datetime.fromtimestamp(float(seconds[darkest]), UTC))
            stars = self.kernel.last(StarsChanged)
            if stars is not None and heights[darkest] < _STARS_RAD:
                yield Sighting(
                    float(seconds[darkest]), stars.direction.values, stars.irradiance_rgb.values
                )
        self.kernel.inject(Demand(consumer=_CONSUMER, message=StarsChanged.__name__, size=0))

    def moons(self) -> tuple[list[MoonLight], Float32Array | None]:
        """The moon's light through a month, where it is up by night, and its `albedo`."""
        first = self._start.astimezone(UTC).replace(hour=0, minute=0)
        found = []
        disc = MoonDiscChanged.__name__
        self.kernel.inject(Demand(consumer=_CONSUMER, message=disc, size=None))
        for day in range(30):
            for hour in range(0, 24, 4):
                self.go_to(first + timedelta(days=day, hours=hour))
                night = self.kernel.last(NightLightChanged)
                if night is not None and night.moon is not None:
                    found.append(night.moon)
                    break
        self.kernel.inject(Demand(consumer=_CONSUMER, message=disc, size=0))
        seen = self.kernel.last(MoonDiscChanged)
        return found, None if seen is None else np.asarray(seen.albedo.values)


def _without_drift(clouds: CloudsChanged) -> list[CloudLayer]:
    return [msgspec.structs.replace(layer, drift_m=(0.0, 0.0)) for layer in clouds.layers]


def direction_of(azimuth_rad: float, elevation_rad: float) -> Vector:
    """Unit vector in world axes; azimuth from -Z, clockwise from above."""
    level = float(np.cos(elevation_rad))
    return (
        level * float(np.sin(azimuth_rad)),
        float(np.sin(elevation_rad)),
        -level * float(np.cos(azimuth_rad)),
    )

"""A scene and its sky by messages, without a window: what a page is computed from."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import NamedTuple

import astronomy
import msgspec
import numpy as np
from light_transport.public import Illumination, hour_of

from vrut_lite.errors import ModuleFailed
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.headless import (
    FaultCollector,
    Project,
    SceneManager,
    daylight_inputs,
    open_kernel,
    require_sun,
    setting_inputs,
    view_inputs,
)
from vrut_lite.kernel.messages import Demand, EnableModule, SetClock
from vrut_lite.messages.night import MoonLight, NightLightChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector
from vrut_lite.sky.sky_at_night import night_share, sun_share
from vrut_lite.sky.suns import suns_at

# Edge (texels) of the cube maps from which tables of the sky are read.
_CUBE = 128
_CONSUMER = "share"
# Geometric elevation of the sun below which its light is gone (`sky_at_night.py`).
SUN_GONE_RAD = float(np.radians(-19.0))
_HOUR_S = 3600.0
_DAYS, _STEPS = 365, 96


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
    """

    true_rad: float
    apparent_rad: float
    azimuth_rad: float
    cube: Float32Array
    key_rgb: FloatArray
    ground_rgb: FloatArray
    albedo_rgb: FloatArray


class Disc(NamedTuple):
    """Radius of the sun's disc, and polynomials of its limb darkening (3, n)."""

    angular_radius_rad: float
    limb_darkening_rgb: tuple[tuple[float, ...], ...]


class SharedScene:
    """A kernel that has opened a project's scene; skies are asked of it one by one."""

    def __init__(self, project: Project):
        """Open the scene.

        Raises:
            UserError: the project has an invalid value, or its scene cannot be read.
        """
        self._kernel = open_kernel()
        self._faults = FaultCollector(self._kernel)
        self._start = project.instant()
        try:
            # No light map and no air: the page has its own.
            self._kernel.add_module(SceneManager, cube_size=_CUBE, lights_surfaces=False)
            for kind in (SkyRadianceChanged, SkyLightChanged):
                self._kernel.inject(Demand(consumer=_CONSUMER, message=kind.__name__, size=_CUBE))
            for message in (
                *setting_inputs(msgspec.structs.replace(project, air=False), self._kernel),
                *daylight_inputs(project),
                *view_inputs(project),
            ):
                self._kernel.inject(message)
            self._settle()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """End background jobs."""
        self._kernel.close()

    @property
    def scene(self) -> SceneOpened:
        """The opened scene."""
        found = self._kernel.last(SceneOpened)
        if found is None:
            raise ModuleFailed("no scene is open")
        return found

    @property
    def place(self) -> SetPlace:
        """Where the scene stands."""
        found = self._kernel.last(SetPlace)
        assert found is not None
        return found

    @property
    def light(self) -> SkyLightChanged:
        """All light of the present sky."""
        require_sun(self._kernel)
        found = self._kernel.last(SkyLightChanged)
        if found is None or found.radiance is None:
            raise ModuleFailed("no module makes a sky: see `vrut-lite modules`")
        return found

    @property
    def disc(self) -> Disc:
        """The sun's disc."""
        key = self._kernel.last(KeyLightChanged)
        assert key is not None
        return Disc(key.angular_radius_rad, key.limb_darkening_rgb)

    def go_to(self, instant: datetime) -> None:
        """Another hour."""
        self._kernel.inject(SetClock(instant=instant))
        self._settle()

    def hour(self, instant: datetime) -> Illumination:
        """The light of an hour as the scene has it."""
        self.go_to(instant)
        return hour_of(self.light)

    def _settle(self) -> None:
        self._kernel.pump_until_idle()
        self._faults.raise_first()

    # --- the sun's sky ------------------------------------------------------------------------

    def sun_skies(self, heights_rad: FloatArray) -> list[SunSky]:
        """Skies by the sun alone, by rising height; heights (n,) that it never has are left out."""
        night = self._kernel.last(NightLightChanged)
        source = "" if night is None else night.source
        self._enable(source, enabled=False)
        found = [self._sun_sky(instant) for instant in self._instants_of(heights_rad)]
        self._enable(source, enabled=True)
        return sorted(found, key=lambda sky: sky.true_rad)

    def _enable(self, module: str, enabled: bool) -> None:
        if module:
            self._kernel.inject(EnableModule(module=module, enabled=enabled))
            self._settle()

    def _sun_sky(self, instant: datetime) -> SunSky:
        self.go_to(instant)
        sun, light = require_sun(self._kernel), self.light
        hour = hour_of(light)
        assert light.radiance is not None
        x, _, z = sun.direction
        lit = light.key_light.body == "sun" and sun.visible_disc_fraction > 0.0
        return SunSky(
            true_rad=sun.elevation_rad,
            apparent_rad=sun.apparent_elevation_rad,
            azimuth_rad=float(np.arctan2(x, -z)),
            cube=np.maximum(decode_float16(light.radiance.cube.values, light.radiance.radiance_scale), 0),
            key_rgb=np.asarray(hour.key_irradiance_rgb, float) * float(lit),
            ground_rgb=np.asarray(hour.ground_radiance_rgb, float),
            albedo_rgb=np.asarray(hour.ground_albedo_rgb, float),
        )

    def _instants_of(self, heights_rad: FloatArray) -> Iterator[datetime]:
        """Instants of the year at which the sun stands at these heights, before noon or after."""
        first = datetime(self._start.year, 1, 1, tzinfo=UTC).timestamp()
        seconds = first + 900.0 * np.arange(_DAYS * _STEPS)
        place = self.place
        where = place.latitude_deg, place.longitude_deg, place.altitude_m
        heights = suns_at(seconds, *where).elevation_rad
        # The greatest height too: skies above it would be held.
        for wanted in (*heights_rad, float(heights.max()) - 1e-4):
            over = heights > wanted
            crossed = np.flatnonzero(over[1:] != over[:-1])
            if not len(crossed):
                continue
            # The fastest crossing: the others may graze the height.
            slope = np.abs(heights[crossed + 1] - heights[crossed])
            low = seconds[crossed[np.argmax(slope)]]
            high, rises = low + 900.0, not over[crossed[np.argmax(slope)]]
            for _ in range(24):
                middle = 0.5 * (low + high)
                if (suns_at(middle, *where).elevation_rad > wanted) == rises:
                    high = middle
                else:
                    low = middle
            yield datetime.fromtimestamp(low, UTC)

    def bodies(self) -> tuple[list[tuple[float, float, FloatArray]], float]:
        """Sun and moon of the present hour, and the share of the night's light.

        Each body has its geometric elevation, its azimuth from north, and its share (3,) of the
        light of a sun in its place.
        """
        sun, night = require_sun(self._kernel), self._kernel.last(NightLightChanged)
        found = [(sun.elevation_rad, sun.azimuth_rad, np.full(3, sun_share(sun)))]
        share = 0.0 if night is None else night_share(sun)
        if night is not None and night.moon is not None:
            moon = night.moon
            light = share * np.asarray(moon.of_sunlight_rgb)
            found.append((moon.place.elevation_rad, moon.place.azimuth_rad, light))
        return found, share

    # --- the night ----------------------------------------------------------------------------

    def moonless_glow(self) -> Float32Array | None:
        """The glow (rows, columns, 3) of a dark night, laid out as `NightLightChanged.glow_rgb`.

        At midnight of the year's darkest new moon; None where no module makes a night.
        """
        moons = []
        after = astronomy.Time.Make(self._start.year, 1, 1, 0, 0, 0)
        for _ in range(13):
            found = astronomy.SearchMoonPhase(0.0, after, 40.0)
            if found is None:
                break
            moons.append(found)
            after = found.AddDays(20.0)
        place = self.place
        best: tuple[float, float] = (np.inf, 0.0)
        for moon in moons:
            day = moon.Utc().replace(tzinfo=UTC).timestamp()
            seconds = day + _HOUR_S * np.arange(-12.0, 12.0, 0.5)
            height = suns_at(seconds, place.latitude_deg, place.longitude_deg).elevation_rad
            best = min(best, (float(height.min()), float(seconds[np.argmin(height)])))
        self.go_to(datetime.fromtimestamp(best[1], UTC))
        night = self._kernel.last(NightLightChanged)
        if night is None or night.glow_rgb is None:
            return None
        return np.asarray(night.glow_rgb.values, np.float32)

    def moons(self) -> list[MoonLight]:
        """The moon's light through a month, where it is up by night."""
        first = self._start.astimezone(UTC).replace(hour=0, minute=0)
        found = []
        for day in range(30):
            for hour in range(0, 24, 4):
                self.go_to(first + timedelta(days=day, hours=hour))
                night = self._kernel.last(NightLightChanged)
                if night is not None and night.moon is not None:
                    found.append(night.moon)
                    break
        return found


def direction_of(azimuth_rad: float, elevation_rad: float) -> Vector:
    """Unit vector in world axes; azimuth from -Z, clockwise from above."""
    level = float(np.cos(elevation_rad))
    return (
        level * float(np.sin(azimuth_rad)),
        float(np.sin(elevation_rad)),
        -level * float(np.cos(azimuth_rad)),
    )

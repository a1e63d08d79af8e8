"""The module `weather_sky`: the sky, and the sun, of the hours of a weather file.

With a file an hour has one sky and one sun, that of the middle of its sunlit part; the picture
changes from hour to hour as the file does. Without one the sun follows the clock.

The file's light has its clouds in it. Where layers of clouds are shown, the sky behind them is the
cloudless one of the season (`clear_year.py`). `CloudinessChanged` carries the hour's cloudiness.
"""

import logging

import numpy as np

from vrut_lite import __version__
from vrut_lite.kernel.messages import ClockMoved
from vrut_lite.kernel.module import Link, Manifest, handles
from vrut_lite.messages.cloudiness import CloudinessChanged
from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import sun_moved
from vrut_lite.messages.weather import SetWeather
from vrut_lite.sky.sky_module import SkyModule
from vrut_lite.sky.sky_of_hour import SkyInputs
from vrut_lite.sky.suns import middle_of_sunlit, suns_at
from weather_sky.clear_year import ClearYear
from weather_sky.conditions import Conditions
from weather_sky.light import WeatherLight, haze_before
from weather_sky.settings import WeatherSettings
from weather_sky.tolerance import WeatherQuality, quality_for

NAME = "weather_sky"
# Without a file: 2 cm of water vapour, Perez's own usual value.
_USUAL_DEW_POINT_C = 11.0
_HOUR_S = 3600.0
_log = logging.getLogger(__name__)


class WeatherSky(SkyModule):
    """CIE's and Perez's skies, by a year of measurements or by settings."""

    manifest = Manifest(
        name=NAME, title="Sky of the weather", version=__version__, provides=("sun", "sky")
    )
    settings_type = WeatherSettings
    settings: WeatherSettings

    def __init__(self, link: Link, settings: WeatherSettings):
        super().__init__(link, settings)
        # A file and its clear skies; the cloudiness posted last.
        self._clear: tuple[SetWeather, ClearYear] | None = None
        self._told: CloudinessChanged | None = None
        # The file, or None for settings, whose hour outside Perez's model was reported.
        self._told_outside: tuple[SetWeather | None] | None = None

    # --- the sky -------------------------------------------------------------------------

    def quality(self, tolerance: float) -> WeatherQuality:
        """Sizes for a smooth sky."""
        return quality_for(tolerance)

    def light(self, hour: SkyInputs, quality: WeatherQuality, prepared: None) -> WeatherLight:
        """The sky of the settings, of the file's hour, or a clear one, in this order."""
        clock, weather, own = self.link.last(ClockMoved), self._weather, self.settings
        direct, diffuse = own.direct_normal_w_m2, own.diffuse_horizontal_w_m2
        dew_point, day = own.dew_point_deg_c, 150
        if clock is not None:
            day = clock.instant.timetuple().tm_yday
            if weather is not None:
                measured = weather.hour_at(clock.instant)
                shone = measured.direct_normal_w_m2, measured.diffuse_horizontal_w_m2
                if self._behind_clouds:
                    row = weather.row_at(clock.instant)
                    clear = self._clear_year(weather).irradiances(
                        row, hour.sun.apparent_elevation_rad
                    )
                    shone = float(clear[0]), float(clear[1])
                direct = shone[0] if direct is None else direct
                diffuse = shone[1] if diffuse is None else diffuse
                dew_point = measured.dew_point_c if dew_point is None else dew_point
        conditions = Conditions(
            kind=own.distribution,
            direct_normal_w_m2=direct,
            diffuse_horizontal_w_m2=diffuse,
            dew_point_c=_USUAL_DEW_POINT_C if dew_point is None else dew_point,
            day_of_year=day,
            apparent_elevation_rad=hour.sun.apparent_elevation_rad,
            visible_disc_fraction=hour.sun.visible_disc_fraction,
        )
        self._tell_outside(conditions)
        haze = haze_before(self.haze, conditions) if self._behind_clouds else self.haze
        ground = self.ground_unless(own.albedo)
        return WeatherLight(conditions, hour.sun.direction, ground.rgb, haze)

    def _tell_outside(self, conditions: Conditions) -> None:
        """Tell the first hour of a file, or of the settings, that Perez's model does not reach."""
        if not conditions.outside_perez or self._told_outside == (self._weather,):
            return
        self._told_outside = (self._weather,)
        direct, diffuse = conditions.irradiances_w_m2
        _log.warning(
            "%s: %.0f W/m² direct and %.0f W/m² diffuse under a sun %.0f° high lie outside Perez's "
            "sky: its nearest shape stands in, with this light (said once)",
            NAME, direct, diffuse, np.degrees(conditions.apparent_elevation_rad),
        )  # fmt: skip

    @property
    def _weather(self) -> SetWeather | None:
        return self.link.last(SetWeather)

    @property
    def _behind_clouds(self) -> bool:
        clouds = self.link.last(CloudsChanged)
        return clouds is not None and bool(clouds.layers)

    def _clear_year(self, weather: SetWeather) -> ClearYear:
        """The clear skies of the file, made once."""
        if self._clear is None or self._clear[0] is not weather:
            self._clear = weather, ClearYear(weather)
        return self._clear[1]

    @handles(SetWeather)
    def weather_set(self, _message: SetWeather) -> None:
        """Another year: another sun, and another sky."""
        self._tell_cloudiness()
        self.move_sun()
        self._update()

    @handles(CloudsChanged)
    def clouds_changed(self, _message: CloudsChanged) -> None:
        """Clouds that come or go change the sky behind them; clouds that move do not."""
        if self._weather is not None:
            self._update()

    def _tell_cloudiness(self) -> None:
        """Tell how cloudy the hour is, where a file knows it, once for an hour."""
        clock, weather = self.link.last(ClockMoved), self._weather
        if clock is None or weather is None:
            return
        told = self._clear_year(weather).cloudiness(weather.row_at(clock.instant), NAME)
        if told != self._told:
            self.link.post(told)
            self._told = told

    # --- the sun -------------------------------------------------------------------------

    @handles(ClockMoved)
    @handles(SetPlace)
    def hour_changed(self, _message: ClockMoved | SetPlace) -> None:
        """The hour or the place changed: so may sun and sky. A sun that moves brings its sky."""
        self._tell_cloudiness()
        before = self._sun_of
        self.move_sun()
        if self._sun_of == before:
            self._update()

    def move_sun(self) -> None:
        """Tell the sun of the hour, if it is another."""
        clock, place = self.link.last(ClockMoved), self.link.last(SetPlace)
        if clock is None or place is None or not self.link.holds("sun"):
            return
        seconds, weather = clock.instant.timestamp(), self._weather
        where = place.latitude_deg, place.longitude_deg, place.altitude_m
        if weather is not None:
            # Hours of the file's standard time, which may be off by half an hour or a quarter.
            since = (seconds + weather.utc_offset_h * _HOUR_S) % _HOUR_S
            seconds = float(middle_of_sunlit(seconds - since, *where))
        found = suns_at(seconds, *where)
        self._post_sun(
            (seconds, place),
            lambda: sun_moved(
                float(found.azimuth_rad),
                float(found.elevation_rad),
                float(found.apparent_elevation_rad),
                float(found.disc_fraction),
                place.north_offset_rad,
            ),
        )

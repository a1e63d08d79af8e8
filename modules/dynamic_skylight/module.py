"""DynamicSkyLight on the bus: from clock and place to the sun, from the sun to sky and light.

It may hold the slots `sun` and `sky`, either without the other; for a slot that it does not hold it
does nothing. `SkyModule` serves the slot `sky`.

All six faces are made also when the camera sees two: glossy surfaces mirror the others, and the
message has other readers than the camera. Half of the sphere is ground and costs a fill.
"""

import msgspec

from dynamic_skylight.daylight import Daylight
from dynamic_skylight.light import NAME, HosekWilkieLight
from dynamic_skylight.settings import DynamicSkyLightSettings
from dynamic_skylight.sun.position import position_at
from dynamic_skylight.tolerance import HosekWilkieQuality, quality_for
from vrut_lite import __version__
from vrut_lite.atmosphere.aerosol import (
    LEAST_TURBIDITY,
    MOST_TURBIDITY,
    optical_depth_of_turbidity,
)
from vrut_lite.atmosphere.equal_haze import equal_sky
from vrut_lite.kernel.messages import ClockMoved
from vrut_lite.kernel.module import Manifest, handles
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import SunMoved, sun_moved
from vrut_lite.sky.sky_module import SkyModule
from vrut_lite.sky.sky_of_hour import SkyInputs


class DynamicSkyLight(SkyModule):
    """The sun's position and the Hosek-Wilkie sky."""

    manifest = Manifest(
        name=NAME,
        title="Clear sky (fast)",
        version=__version__,
        provides=("sun", "sky"),
    )
    settings_type = DynamicSkyLightSettings
    settings: DynamicSkyLightSettings

    # --- the sky -------------------------------------------------------------------------

    def quality(self, tolerance: float) -> HosekWilkieQuality:
        """Sizes by the measured fronts."""
        return quality_for(tolerance)

    def light(
        self, hour: SkyInputs, quality: HosekWilkieQuality, prepared: None
    ) -> HosekWilkieLight:
        """Formula and twilight table; neither knows how high the place lies."""
        haze, elevation_rad = self._haze, hour.sun.apparent_elevation_rad
        turbidity, level = min(max(haze.turbidity, LEAST_TURBIDITY), MOST_TURBIDITY), 1.0
        if self.settings.sky_level == "equal-haze":
            turbidity, level = equal_sky(haze.optical_depth_550, elevation_rad)
        ground = self.ground_unless(self.settings.albedo)
        daylight = Daylight(
            turbidity=turbidity,
            level=level,
            haze=haze,
            albedo=ground.rgb,
            sun_colour=self.settings.sun_colour,
            apparent_elevation_rad=elevation_rad,
            sun_azimuth_rad=hour.sun_azimuth_rad,
            visible_disc_fraction=hour.sun.visible_disc_fraction,
            light_size=quality.light_size,
            starlight=not hour.night_apart,
        )
        return HosekWilkieLight(daylight, hour.sun.direction, ground)

    @property
    def _haze(self) -> SetHaze:
        """The place's haze, or as much of it as its own turbidity says on Preetham's scale."""
        if self.settings.turbidity is None:
            return self.haze
        depth = float(optical_depth_of_turbidity(self.settings.turbidity))
        return msgspec.structs.replace(self.haze, optical_depth_550=depth)

    def settings_changed(self, name: str) -> None:
        """Work out again what depends on the setting."""
        if name == "sun_method":
            self.move_sun()
        else:
            super().settings_changed(name)

    # --- the sun -------------------------------------------------------------------------

    @handles(ClockMoved)
    @handles(SetPlace)
    def hour_changed(self, _message: ClockMoved | SetPlace) -> None:
        """The hour or the place changed: so may the sun."""
        self.move_sun()

    def move_sun(self) -> None:
        """Tell the sun of the clock's instant, if it is another."""
        clock, place = self.link.last(ClockMoved), self.link.last(SetPlace)
        if clock is None or place is None or not self.link.holds("sun"):
            return
        method = self.settings.sun_method

        def sun() -> SunMoved:
            # The kernel has checked the place, and knows more years than the ephemeris is good for.
            where = place.latitude_deg, place.longitude_deg, method, place.altitude_m
            found = position_at(clock.instant, *where)
            return sun_moved(
                found.azimuth_rad,
                found.elevation_rad,
                found.apparent_elevation_rad,
                found.visible_disc_fraction,
                place.north_offset_rad,
            )

        self._post_sun((clock, place, method), sun)

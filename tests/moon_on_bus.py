"""A sky on a real kernel under a sun, a moon and a glow that a test places."""

import math
from datetime import UTC, datetime

import msgspec
import numpy as np
from directions import towards

from vrut_lite.array import Array
from vrut_lite.kernel.messages import Input
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.air import AirChanged, AirVolume
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.night import MoonLight, NightLightChanged
from vrut_lite.messages.sun import SunMoved
from vrut_lite.sky.sky_module import SkyModule
from vrut_lite.testing.sky_on_bus import SkyOnBus

FULL_MOON = 2.5e-6
_RADIUS_RAD = 0.00465


class PlaceMoon(Input, frozen=True, kw_only=True):
    """A moon at an elevation and an azimuth, with a share of the sun's light; none below -8 deg."""

    elevation_deg: float = -90.0
    azimuth_deg: float = 0.0
    share: float = FULL_MOON
    sun_left: float = 1.0
    glow: float = 0.0


class MoonAndGlow(Module):
    """Stands in for the night's module; the glow is even."""

    manifest = Manifest(
        name="moon_and_glow", title="Moon and glow", version="1", provides=("night",)
    )

    @handles(PlaceMoon)
    def place(self, moon: PlaceMoon) -> None:
        """Tell the night."""
        light = MoonLight(
            place=body_at(moon.elevation_deg, moon.azimuth_deg),
            irradiance_rgb=(1e-3,) * 3,
            of_sunlight_rgb=(moon.share,) * 3,
            angular_radius_rad=_RADIUS_RAD,
            lit_fraction=1.0,
            waxes=True,
        )
        self.link.post(
            NightLightChanged(
                instant=datetime(2026, 1, 1, tzinfo=UTC),
                moon=light if moon.elevation_deg >= -8.0 else None,
                glow_rgb=Array(np.full((9, 18, 3), moon.glow, np.float32)),
                source=self.manifest.name,
                sun_left_rgb=(moon.sun_left,) * 3,
            )
        )


def body_at(elevation_deg: float, azimuth_deg: float) -> SunMoved:
    """A body of the sun's size, without refraction."""
    elevation, azimuth = math.radians(elevation_deg), math.radians(azimuth_deg)
    x, y, z = towards(elevation_deg, azimuth_deg).tolist()
    return SunMoved(
        direction=(x, y, z),
        azimuth_rad=azimuth,
        elevation_rad=elevation,
        apparent_elevation_rad=elevation,
        visible_disc_fraction=min(max(0.5 + 0.5 * elevation / _RADIUS_RAD, 0.0), 1.0),
    )


class SkyUnderMoon(SkyOnBus):
    """A sky with things at 100 km from an eye at 2 m."""

    def __init__(self, module_type: type[SkyModule], depth_550: float):
        super().__init__(module_type)
        self.kernel.add_module(MoonAndGlow)
        self.tell(SetHaze(optical_depth_550=depth_550))
        self.eye(2.0, 1e5)
        self.sun(5.0)
        self.want(AirChanged)

    def air(self, sun_deg: float, moon: PlaceMoon, sun_azimuth_deg: float = 0.0) -> AirVolume:
        """The air of an hour."""
        self.tell(moon)
        self.sun(sun_deg, sun_azimuth_deg)
        volume = self.last(AirChanged).volume
        assert volume is not None
        assert not self.faults
        return volume


def moved(moon: PlaceMoon, **changes: float) -> PlaceMoon:
    """The moon with other fields."""
    return msgspec.structs.replace(moon, **changes)

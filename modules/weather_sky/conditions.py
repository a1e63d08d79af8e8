"""Light of an hour: illuminances of sun and sky, and the sky's luminance distribution."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from vrut_lite.atmosphere.cie_skies import OVERCAST, SUNLESS, general_sky
from vrut_lite.atmosphere.sky_distribution import Distribution, Overcast
from weather_sky.clear_year import meinel
from weather_sky.perez import LOWEST_SUN_RAD, AllWeather, all_weather, precipitable_water_cm
from weather_sky.twilight import twilight_alone, twilight_lux

Kind = Literal[
    "perez",
    "cie-1", "cie-2", "cie-3", "cie-4", "cie-5", "cie-6", "cie-7", "cie-8",
    "cie-9", "cie-10", "cie-11", "cie-12", "cie-13", "cie-14", "cie-15",
    "cie-overcast",
]  # fmt: skip
KINDS: tuple[str, ...] = get_args(Kind)


@dataclass(frozen=True)
class Conditions:
    """One hour's weather; irradiances are broadband, W m^-2.

    `direct_normal_w_m2` faces the sun, `diffuse_horizontal_w_m2` is the sky's on level ground;
    where both are None nothing was measured and a closed form stands in, of a clear sky or, below
    the overcast skies of CIE, of cloud.
    """

    kind: Kind
    direct_normal_w_m2: float | None
    diffuse_horizontal_w_m2: float | None
    dew_point_c: float
    day_of_year: int
    apparent_elevation_rad: float
    visible_disc_fraction: float

    @cached_property
    def sun_zenith_rad(self) -> float:
        """The sun's, where its light is described."""
        return float(np.clip(0.5 * np.pi - self.apparent_elevation_rad, 0.0, LOWEST_SUN_RAD))

    @property
    def hides_sun(self) -> bool:
        """Whether the sky is one of CIE's behind which no sun is seen."""
        return self.kind in ("cie-overcast", *(f"cie-{n}" for n in range(1, SUNLESS + 1)))

    @property
    def _measured(self) -> bool:
        return self.direct_normal_w_m2 is not None or self.diffuse_horizontal_w_m2 is not None

    @cached_property
    def irradiances_w_m2(self) -> tuple[float, float]:
        """Direct normal and diffuse horizontal: the measured ones, or of a clear sky."""
        direct, diffuse = map(float, meinel(self.apparent_elevation_rad, self.day_of_year))
        if self.hides_sun:
            direct = 0.0
        if self.direct_normal_w_m2 is not None:
            direct = self.direct_normal_w_m2
        if self.diffuse_horizontal_w_m2 is not None:
            diffuse = self.diffuse_horizontal_w_m2
        return direct, diffuse

    @cached_property
    def state(self) -> AllWeather:
        """Perez's clearness and brightness; those of the faintest sky where it is dark."""
        direct, diffuse = self.irradiances_w_m2
        faint = max(diffuse, 1e-3)
        return all_weather(direct, faint, self.sun_zenith_rad, self.day_of_year)

    @cached_property
    def at_night(self) -> bool:
        """Whether twilight alone shines: the sun is down, or so low that both lights round to 0."""
        return bool(twilight_alone(self.apparent_elevation_rad, *self.irradiances_w_m2))

    @property
    def outside_perez(self) -> bool:
        """Whether the shape is that of another brightness than the hour's: Perez's fit ends."""
        if self.kind != "perez" or self.at_night or self.irradiances_w_m2[1] <= 0.0:
            return False
        return bool(self.state.is_outside)

    @cached_property
    def direct_lux(self) -> float:
        """Illuminance (lx) by the visible part of the sun on a plane that faces it."""
        direct = self.irradiances_w_m2[0] if self.visible_disc_fraction > 0.0 else 0.0
        efficacy = float(self.state.direct_efficacy(self._water_cm))
        shown = 1.0 if self._measured else self.visible_disc_fraction
        return direct * efficacy * shown

    @cached_property
    def diffuse_lux(self) -> float:
        """Diffuse horizontal illuminance (lx)."""
        if self.at_night:
            return float(twilight_lux(self.apparent_elevation_rad))
        if self.hides_sun and not self._measured:
            # Krochmann's overcast sky (1963).
            return 300.0 + 21_000.0 * float(np.cos(self.sun_zenith_rad))
        return self.irradiances_w_m2[1] * float(self.state.diffuse_efficacy(self._water_cm))

    @cached_property
    def distribution(self) -> Distribution | Overcast:
        """How the sky's luminance is spread; evenly at night."""
        if self.at_night:
            return general_sky(5)
        if self.kind == "perez":
            return self.state.distribution()
        if self.kind == "cie-overcast":
            return OVERCAST
        return general_sky(int(self.kind.removeprefix("cie-")))

    @property
    def _water_cm(self) -> float:
        return float(precipitable_water_cm(self.dew_point_c))

"""Bruneton's sky with one physical change of the atmosphere at a time.

The study's aerosol was taken from the day of the measurements, so that an error against them
is in-sample. Each change here mends one thing that the published atmosphere leaves out or
guesses, with nothing adjusted to that sky; what comes of it is reported, better or worse.
"""

from collections.abc import Callable
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from bruneton_sky import Atmosphere

from vrut_lite.atmosphere.gases import ozone_absorption
from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.day import KIDER, MeasuredDay
from vrut_lite_lab.study.models.bruneton import Bruneton
from vrut_lite_lab.study.models.model import SkyModel

# All orders beyond the 12th together are less than 1e-5 of the study's light.
_ALL_ORDERS = 12
# Bruneton 2017: in a tent with its top at 25 km.
_OZONE_ALTITUDE_M = (10_000.0, 25_000.0, 40_000.0)
_OZONE_LAYER_M = 15_000.0
# Single scattering albedo of aerosol over Greenbelt, Maryland: 0.98 at 440 nm, 0.97 at 670 nm
# (Dubovik et al. 2002, J. Atmos. Sci. 59, table 1).
_AEROSOL_ALBEDO = 0.975
# Mean cosine of what AERONET retrieved over Egbert, Ontario, 330 km from Ithaca, on 27 May 2013:
# 0.643 at 442 nm, 0.595 at 674 nm.
_AEROSOL_MEAN_COSINE = 0.62


class Change(NamedTuple):
    """One change: in words, and the sky with it."""

    title: str
    sky: Callable[[], SkyModel]


def with_ozone(air: Atmosphere, day: MeasuredDay = KIDER) -> Atmosphere:
    """The air with a day's ozone, which absorbs orange light."""
    absorption = ozone_absorption(air.wavelength_nm, day.ozone_du, _OZONE_LAYER_M)
    return replace(
        air,
        absorption_extinction=tuple(absorption),
        absorber_altitude_m=_OZONE_ALTITUDE_M,
        absorber_density=(0.0, 1.0, 0.0),
    )


def with_sun_of_the_day(air: Atmosphere, day: MeasuredDay = KIDER) -> Atmosphere:
    """The air under the sun as far away as it was; its tabulated light is that at 1 au."""
    sun = np.asarray(air.solar_irradiance) / day.sun_distance**2
    return replace(air, solar_irradiance=tuple(sun))


def with_whiter_aerosol(air: Atmosphere) -> Atmosphere:
    """The air with aerosol of albedo 0.975, as east of there, and not 0.8."""
    scattering = np.asarray(air.mie_extinction) * _AEROSOL_ALBEDO
    return replace(air, mie_scattering=tuple(scattering))


def with_rounder_aerosol(air: Atmosphere) -> Atmosphere:
    """The air with aerosol that scatters less forward, as measured 330 km away on that day.

    Henyey and Greenstein's function, of which g is the mean cosine.
    """
    return replace(air, mie_phase="henyey-greenstein", mie_g=_AEROSOL_MEAN_COSINE)


def _bruneton(name: str, title: str, *changes: Callable[[Atmosphere], Atmosphere]) -> Bruneton:
    air = STUDY.bruneton_atmosphere()
    for change in changes:
        air = change(air)
    return Bruneton(air, name=f"bruneton-{name}", title=f"Bruneton 2008, {title}")


CHANGES: MappingProxyType[str, Change] = MappingProxyType(
    {
        "ozone": Change("300 DU of ozone", lambda: _bruneton("ozone", "ozone", with_ozone)),
        "sun-distance": Change(
            "sun at its distance of the day",
            lambda: _bruneton("sun-distance", "sun of the day", with_sun_of_the_day),
        ),
        "orders": Change(
            "all orders of scattering",
            lambda: Bruneton(
                orders=_ALL_ORDERS, name="bruneton-orders", title="Bruneton 2008, all orders"
            ),
        ),
        "aerosol-albedo": Change(
            "aerosol albedo 0.975",
            lambda: _bruneton("aerosol-albedo", "whiter aerosol", with_whiter_aerosol),
        ),
        "aerosol-phase": Change(
            "aerosol's mean cosine 0.62",
            lambda: _bruneton("aerosol-phase", "rounder aerosol", with_rounder_aerosol),
        ),
    }
)

"""What can be set, and the atmosphere that it makes."""

from dataclasses import replace
from functools import lru_cache
from typing import Annotated

import msgspec

from bruneton_sky.aerosol import ANGSTROM_EXPONENT, optical_depth_of_turbidity
from bruneton_sky.atmosphere import Atmosphere
from vrut_lite.geometry.colour import solar_irradiance


class BrunetonSkySettings(msgspec.Struct, frozen=True):
    """Settings of the Bruneton sky."""

    turbidity: Annotated[
        float,
        msgspec.Meta(ge=1, le=10, description="haze, on Preetham's scale; 3 is AOD(550) = 0.20"),
    ] = 3.0
    albedo: Annotated[
        float, msgspec.Meta(ge=0, le=1, description="part of the light that the ground reflects")
    ] = 0.1
    ozone: Annotated[bool, msgspec.Meta(description="an ozone layer from 10 to 40 km")] = True
    mie_g: Annotated[
        float, msgspec.Meta(ge=0, le=0.95, description="how far haze scatters forward")
    ] = 0.8


@lru_cache(maxsize=8)
def atmosphere_of(settings: BrunetonSkySettings) -> Atmosphere:
    """Bruneton's demonstration atmosphere with the haze, ground and ozone of the settings.

    Its solar spectrum is the host's (ASTM G-173), up to 7 % from the demonstration's, so that
    every sky and sun shares one scale.
    """
    earth = Atmosphere.earth(ozone=settings.ozone)
    spectrum = tuple(solar_irradiance(earth.wavelength_nm).tolist())
    earth = replace(
        earth, solar_irradiance=spectrum, ground_albedo=(settings.albedo,) * len(spectrum)
    )
    depth = float(optical_depth_of_turbidity(settings.turbidity))
    return earth.with_aerosol(depth, ANGSTROM_EXPONENT, mie_g=settings.mie_g)

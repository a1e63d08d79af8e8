"""Atmospheres by name, at any wavelengths.

`earth_standard` is the real Earth's air, which the module shows by default. The presets by name are
published airs, with the molecules of their publications: those of Bruneton's demonstration are 8
to 13 % too thick. All share the host's solar spectrum (ASTM G-173), so that
their skies share one scale; `Atmosphere.earth` alone keeps the demonstration's, up to 7 % from it.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from vrut_lite.arguments import as_flag, as_numbers, shown
from vrut_lite.atmosphere.aerosol import optical_depth_of_turbidity
from vrut_lite.atmosphere.clear_air import (
    DEPOLARISATION,
    NITROGEN_DIOXIDE_DU,
    REFRACTIVITY,
    SCALE_HEIGHT_M,
    SCALE_HEIGHTS_ABOVE,
    TOP_ALTITUDE_M,
    WATER_CM,
    molecules_per_m,
    nitrogen_dioxide_per_m,
    oxygen_pairs_per_m,
    ozone_per_m,
)
from vrut_lite.atmosphere.gases import ozone_absorption, rayleigh_scattering
from vrut_lite.geometry.colour import solar_irradiance

RGB_NM = (680.0, 550.0, 440.0)
# Among the best triples on a grid of 10 nm for a 3-sample colour near the CIE integral over 40
# wavelengths, sun from 60 to 0 degrees, clear air and haze. Ozone absorbs orange, of which
# 680 nm knows nothing: there a low sun's sky gets far too red. Four wavelengths do much
# better: `vrut_lite.geometry.colour.SKYLIGHT_NM`.
COLOUR_NM = (630.0, 540.0, 450.0)
# The solar spectrum's ends, and the ozone's.
_KNOWN_NM = (360.0, 830.0)
HAZY_TURBIDITY = 6.0
# Lower, the sun leaves less than a tenth of the light of a moonless night.
LOWEST_SUN_DEG = -18.5
# Widest band (nm) that a wavelength stands for.
WIDE_BAND_NM = 50.0
# Bruneton's 2017 demonstration: Rayleigh at 1 micrometre in 1/m, 300 Dobson units in a tent
# whose integral is 15 km.
_RAYLEIGH_AT_1_UM, _OZONE_DU, _TENT_M = 1.24062e-6, 300.0, 15_000.0
_MARS_SUN_DISTANCE_AU = 1.5237
_MARS_REFRACTIVITY = 3.37e-6


def earth_spectral(wavelength_nm: ArrayLike = RGB_NM, ozone: bool = True) -> Atmosphere:
    """Bruneton's 2017 demonstration atmosphere at any wavelengths in nm.

    Rayleigh scattering as wavelength^-4, grey aerosol, measured ozone cross sections, grey
    ground; at 680, 550 and 440 nm it is `Atmosphere.earth` but for the solar spectrum and ozone,
    whose means of 10 nm the demonstration takes for values at their lower ends.

    Raises:
        ValueError: wavelengths are outside 360 to 830 nm, where sun and ozone are known, or do not
            rise or fall throughout.
    """
    ozone = as_flag("ozone", ozone)
    wavelength = _wavelengths(wavelength_nm)
    absorption = ozone_absorption(wavelength, _OZONE_DU if ozone else 0.0, _TENT_M)
    earth, count = Atmosphere.earth(ozone=ozone), wavelength.size
    return replace(
        earth,
        wavelength_nm=tuple(wavelength),
        solar_irradiance=tuple(solar_irradiance(wavelength)),
        rayleigh_scattering=tuple(_RAYLEIGH_AT_1_UM * (wavelength / 1000.0) ** -4.0),
        mie_scattering=earth.mie_scattering[:1] * count,
        mie_extinction=earth.mie_extinction[:1] * count,
        absorption_extinction=tuple(absorption),
        ground_albedo=earth.ground_albedo[:1] * count,
    )


def earth_clear(wavelength_nm: ArrayLike = RGB_NM) -> Atmosphere:
    """The air of Bruneton's 2017 demonstration: aerosol optical depth 0.0053."""
    return earth_spectral(wavelength_nm)


def earth_hazy(wavelength_nm: ArrayLike = RGB_NM) -> Atmosphere:
    """The same with the aerosol of Preetham's turbidity 6: optical depth 0.50 at 550 nm."""
    depth = float(optical_depth_of_turbidity(HAZY_TURBIDITY))
    return earth_spectral(wavelength_nm).with_aerosol(depth)


def earth_2008(wavelength_nm: ArrayLike = RGB_NM) -> Atmosphere:
    """The air of Bruneton and Neyret 2008 as their published program has it: no ozone.

    Rayleigh 5.8, 13.5 and 33.1 per 1000 km with scale height 8 km, as wavelength^-4 between,
    Mie scattering 4 per 1000 km of albedo 0.9 with scale height 1.2 km and g = 0.8, sun down
    to mu_s = -0.2.
    """
    wavelength = _wavelengths(wavelength_nm)
    printed = np.array([5.8e-6, 1.35e-5, 3.31e-5])
    rayleigh = wavelength**-4.0 * _between_rgb(wavelength, printed / np.power(RGB_NM, -4.0))
    return replace(
        earth_spectral(wavelength, ozone=False),
        rayleigh_scattering=tuple(rayleigh),
        mie_scattering=(4e-6,) * wavelength.size,
        mie_extinction=(4e-6 / 0.9,) * wavelength.size,
        mu_s_min=-0.2,
    )


def earth_standard(
    wavelength_nm: ArrayLike = RGB_NM, nitrogen_dioxide_du: float = NITROGEN_DIOXIDE_DU
) -> Atmosphere:
    """The real Earth's air (`vrut_lite.atmosphere.clear_air`) for suns to 18.5 degrees down.

    Its aerosol, ground and radius are the demonstration's. Each wavelength stands for all that are
    nearer to it than to others, up to 50 nm: narrow bands of oxygen have their mean there.
    """
    wavelength = _wavelengths(wavelength_nm)
    above_m, height_m = (tuple(part) for part in zip(*SCALE_HEIGHTS_ABOVE, strict=True))
    step_nm = np.abs(np.diff(wavelength)).mean() if wavelength.size > 1 else WIDE_BAND_NM
    band_nm = min(float(step_nm), WIDE_BAND_NM)
    return replace(
        earth_spectral(wavelength),
        top_altitude_m=TOP_ALTITUDE_M,
        mu_s_min=math.sin(math.radians(LOWEST_SUN_DEG)),
        rayleigh_scattering=tuple(molecules_per_m(wavelength)),
        rayleigh_scale_height_m=SCALE_HEIGHT_M,
        rayleigh_above_m=above_m,
        rayleigh_above_scale_height_m=height_m,
        rayleigh_depolarisation=DEPOLARISATION,
        absorption_extinction=tuple(ozone_per_m(wavelength)),
        gas_absorption=tuple(nitrogen_dioxide_per_m(wavelength, nitrogen_dioxide_du)),
        pair_absorption=tuple(oxygen_pairs_per_m(wavelength, band_nm)),
        water_vapour_cm=WATER_CM,
        refractivity=REFRACTIVITY,
    )


def earth_twilight(wavelength_nm: ArrayLike = RGB_NM) -> Atmosphere:
    """The demonstration's air up to 120 km, where the light of a sun 12 degrees down comes from."""
    return replace(earth_spectral(wavelength_nm), top_altitude_m=TOP_ALTITUDE_M)


def mars_like(wavelength_nm: ArrayLike = RGB_NM) -> Atmosphere:
    """Carbon dioxide with well-mixed dust of optical depth 0.5: a butterscotch sky.

    Radius, scale height and distance are NASA's (Mars fact sheet). The gas has n = 1.00000337
    and 2.05e23 molecules per m^3 at the ground, depolarisation 0.09 (Costa, Bock, Emmart,
    Hansen, Ynnerman and Silva 2021, "Interactive Visualization of Atmospheric Effects for
    Celestial Bodies", brought to the pressure of Mars). Albedo and asymmetry of the dust come
    from Mie's theory for their refractive index 1.52 - (0.001, 0.006, 0.013) i and particles
    of effective radius 1.6 micrometres (Tomasko et al. 1999), effective variance 0.2; that
    theory makes its extinction grey within 4 %. Asymmetry is one number here, the red one, so
    the blue glow around a low sun is missing. The ground's rust is of our choosing. Dust and
    ground are known at 680, 550 and 440 nm: between, albedo is linear, beyond it is constant.
    """
    wavelength = _wavelengths(wavelength_nm)
    albedo = _between_rgb(wavelength, np.array([0.97, 0.83, 0.69]))
    scale_height_m, dust_optical_depth = 11_100.0, 0.5
    extinction = dust_optical_depth / scale_height_m
    index = 1.0 + _MARS_REFRACTIVITY
    gas = rayleigh_scattering(wavelength, index, 2.05e23, depolarisation=0.09)
    return Atmosphere(
        wavelength_nm=tuple(wavelength),
        solar_irradiance=tuple(solar_irradiance(wavelength) / _MARS_SUN_DISTANCE_AU**2),
        ground_radius_m=3_389_500.0,
        top_altitude_m=100_000.0,
        rayleigh_scattering=tuple(gas),
        rayleigh_scale_height_m=scale_height_m,
        refractivity=_MARS_REFRACTIVITY,
        mie_scattering=tuple(extinction * albedo),
        mie_extinction=(extinction,) * wavelength.size,
        mie_scale_height_m=scale_height_m,
        mie_g=0.72,
        mie_phase="henyey-greenstein",
        absorption_extinction=(0.0,) * wavelength.size,
        absorber_altitude_m=(0.0, 1.0),
        absorber_density=(0.0, 0.0),
        ground_albedo=tuple(_between_rgb(wavelength, np.array([0.30, 0.14, 0.07]))),
        sun_angular_radius_rad=0.004675 / _MARS_SUN_DISTANCE_AU,
        mu_s_min=Atmosphere.earth().mu_s_min,
    )


def _wavelengths(wavelength_nm: ArrayLike) -> NDArray[np.float64]:
    """Wavelengths (C,) that the spectra of sun and ozone reach."""
    return np.atleast_1d(as_numbers("wavelength_nm", wavelength_nm, *_KNOWN_NM, "nm"))


def _between_rgb(
    wavelength_nm: NDArray[np.float64], at_rgb: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Values at RGB_NM, interpolated linearly and constant outside."""
    return np.interp(wavelength_nm, RGB_NM[::-1], at_rgb[::-1])


PRESETS: MappingProxyType[str, Callable[[ArrayLike], Atmosphere]] = MappingProxyType(
    {
        "earth-clear": earth_clear,
        "earth-hazy": earth_hazy,
        "earth-2008": earth_2008,
        "earth-twilight": earth_twilight,
        "mars-like": mars_like,
    }
)


def preset(name: str, wavelength_nm: ArrayLike = RGB_NM) -> Atmosphere:
    """The atmosphere of that name, at wavelengths in nm.

    Raises:
        ValueError: the name is unknown, and the sentence lists the known ones; or wavelengths are
            outside 360 to 830 nm.
    """
    if not isinstance(name, str) or name not in PRESETS:
        raise ValueError(f"no atmosphere {shown(name)}; there are {', '.join(PRESETS)}")
    return PRESETS[name](wavelength_nm)

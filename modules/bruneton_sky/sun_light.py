"""The sun as a light: what of it arrives, and how its disc darkens toward the limb."""

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.single_scattering import optical_depth_to_top
from vrut_lite.geometry.colour import rgb_from_spectrum

RGB_WAVELENGTH_NM = (680.0, 550.0, 440.0)
_SUNLIGHT_EXPONENT = 0.0


def sun_irradiance(atmosphere: Atmosphere, altitude_m: float, mu_s: float) -> NDArray[np.float64]:
    """Irradiance (C,) on a plane that faces the whole disc, W m^-2 nm^-1.

    The transmittance is that of the disc's centre; below the horizon, while a part of the
    disc still shows, that of the horizon.
    """
    lowest = float(horizon_mu(atmosphere.ground_radius_m, altitude_m))
    depth = optical_depth_to_top(atmosphere, altitude_m, max(mu_s, lowest))
    return np.asarray(atmosphere.solar_irradiance) * np.exp(-depth)


def sun_irradiance_rgb(
    atmosphere: Atmosphere, altitude_m: float, mu_s: float, visible_disc_fraction: float
) -> NDArray[np.float64]:
    """Irradiance (3,) of the visible part of the disc, linear sRGB, W m^-2.

    A component below zero, a sun redder than the gamut, is clamped.
    """
    spectral = sun_irradiance(atmosphere, altitude_m, mu_s)
    rgb = rgb_from_spectrum(spectral, atmosphere.wavelength_nm, _SUNLIGHT_EXPONENT)
    return np.maximum(rgb, 0.0) * visible_disc_fraction


def limb_darkening(wavelength_nm: float) -> NDArray[np.float64]:
    """Polynomial (6,) in cos psi, constant first, whose mean over the disc is 1.

    Neckel 2005, "Analytical Reference Functions F(lambda) for the Sun's Limb Darkening and
    Its Absolute Continuum Intensities", the fit for 422.57 to 1100 nm to Neckel and Labs'
    observations of 1994.
    """
    inverse = 1000.0 / wavelength_nm
    fifth = inverse**5
    polynomial = np.array(
        [
            0.75267 - 0.265577 * inverse,
            0.93874 + 0.265577 * inverse - 0.004095 * fifth,
            -1.89287 + 0.012582 * fifth,
            2.42234 - 0.017117 * fifth,
            -1.71150 + 0.011977 * fifth,
            0.49062 - 0.003347 * fifth,
        ]
    )
    # The mean of cos^k over the disc is 2 / (k + 2).
    return polynomial / (polynomial * 2.0 / (np.arange(6) + 2.0)).sum()


def limb_darkening_rgb() -> tuple[tuple[float, ...], ...]:
    """One polynomial per channel, in the form that SunLightChanged carries."""
    return tuple(tuple(map(float, limb_darkening(nm))) for nm in RGB_WAVELENGTH_NM)

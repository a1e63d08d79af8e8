"""Preetham, Shirley and Smits 1999, "A Practical Analytic Model for Daylight"."""

from dataclasses import dataclass

import numpy as np

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.colour import daylight_spectrum
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.framework.tables import table_spectra
from vrut_lite_lab.study.models.model import cosines

# Appendix A.2: Perez' A to E for Y, x and y as slope and offset in turbidity.
_DISTRIBUTION = np.array(
    [
        [(0.1787, -1.4630), (-0.0193, -0.2592), (-0.0167, -0.2608)],
        [(-0.3554, 0.4275), (-0.0665, 0.0008), (-0.0950, 0.0092)],
        [(-0.0227, 5.3251), (-0.0004, 0.2125), (-0.0079, 0.2102)],
        [(0.1206, -2.5771), (-0.0641, -0.8989), (-0.0441, -1.6537)],
        [(-0.0670, 0.3703), (-0.0033, 0.0452), (-0.0109, 0.0529)],
    ]
)
# The zenith's x and y: rows for turbidity squared, turbidity and 1, columns for the sun's
# zenith angle cubed, squared, itself and 1.
_ZENITH_X = np.array(
    [
        [0.00166, -0.00375, 0.00209, 0.0],
        [-0.02903, 0.06377, -0.03202, 0.00394],
        [0.11693, -0.21196, 0.06052, 0.25886],
    ]
)
_ZENITH_Y = np.array(
    [
        [0.00275, -0.00610, 0.00317, 0.0],
        [-0.04214, 0.08970, -0.04153, 0.00516],
        [0.15346, -0.26756, 0.06670, 0.26688],
    ]
)
# Appendix A.1: ozone in cm, precipitable water in cm.
_OZONE_CM, _WATER_CM = 0.35, 2.0


@dataclass(frozen=True)
class Preetham:
    """The sky of one turbidity."""

    turbidity: float = STUDY.turbidity
    name: str = "preetham"
    title: str = "Preetham 1999"

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40): luminance and chromaticity by Perez' formula, then daylight's basis.

        The formula has no value at the horizon itself; there its limit is taken. With a low
        sun chromaticities leave what daylight's basis spans, and single wavelengths turn
        negative: left so, as published.
        """
        mu, mu_s, nu = cosines(sun_zenith_rad, view_zenith_rad, relative_azimuth_rad)
        shape = _DISTRIBUTION @ np.array([self.turbidity, 1.0])
        seen = _perez(shape, np.maximum(mu, 1e-6), nu)
        at_zenith = _perez(shape, np.ones(1), np.array([mu_s]))
        luminance, x, y = np.moveaxis(self._zenith(sun_zenith_rad) * seen / at_zenith, -1, 0)
        return daylight_spectrum(luminance, x, y)

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,) after appendix A.1: molecules, aerosol, ozone, gases and water."""
        zenith_deg = np.degrees(sun_zenith_rad)
        air_mass = 1.0 / (np.cos(sun_zenith_rad) + 0.15 * (93.885 - zenith_deg) ** -1.253)
        micrometres = WAVELENGTHS_NM / 1000.0
        ozone_per_cm, water_per_cm, gases = table_spectra("preetham_absorption")
        depth = 0.008735 * micrometres**-4.08
        depth += (0.04608 * self.turbidity - 0.04586) * micrometres**-1.3
        depth = depth * air_mass + ozone_per_cm * _OZONE_CM * air_mass
        depth += _band_depth(1.41, 118.93, gases * air_mass)
        depth += _band_depth(0.2385, 20.07, water_per_cm * _WATER_CM * air_mass)
        return np.asarray(STUDY.solar_irradiance * np.exp(-depth))

    def _zenith(self, sun_zenith_rad: float) -> FloatArray:
        """Luminance in cd m^-2, x and y of the zenith."""
        powers = self.turbidity ** np.array([2.0, 1.0, 0.0])
        angles = sun_zenith_rad ** np.array([3.0, 2.0, 1.0, 0.0])
        chi = (4.0 / 9.0 - self.turbidity / 120.0) * (np.pi - 2.0 * sun_zenith_rad)
        kilo = (4.0453 * self.turbidity - 4.9710) * np.tan(chi) - 0.2155 * self.turbidity + 2.4192
        return np.array([1000.0 * kilo, powers @ _ZENITH_X @ angles, powers @ _ZENITH_Y @ angles])


def _perez(shape: FloatArray, mu: FloatArray, nu: FloatArray) -> FloatArray:
    """Perez' formula (n, 3) for Y, x and y."""
    a, b, c, d, e = shape
    gamma = np.arccos(nu)[:, None]
    gradation = 1.0 + a * np.exp(b / mu[:, None])
    return np.asarray(gradation * (1.0 + c * np.exp(d * gamma) + e * nu[:, None] ** 2))


def _band_depth(strength: float, saturation: float, amount: FloatArray) -> FloatArray:
    """Optical depth of a gas whose lines saturate (Leckner's formula, as printed)."""
    return np.asarray(strength * amount / (1.0 + saturation * amount) ** 0.45)

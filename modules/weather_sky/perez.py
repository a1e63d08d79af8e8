"""Perez's all-weather sky: luminance distribution and luminous efficacies from two irradiances.

R. Perez, R. Seals, J. Michalsky 1993, "All-weather model for sky luminance distribution", Solar
Energy 50, 235, with its erratum (51, 423); R. Perez, P. Ineichen, R. Seals, J. Michalsky, R.
Stewart 1990, "Modeling daylight availability and irradiance components", Solar Energy 44, 271.

Arrays (...,) are hours; zenith angles are the sun's, in radians, at most `LOWEST_SUN_RAD`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.atmosphere.sky_distribution import Distribution
from vrut_lite.numeric_types import FloatArray

SOLAR_CONSTANT_W_M2 = 1367.0
# Below it air mass and clearness mean little; the sun of a sunlit half hour stands there.
LOWEST_SUN_RAD = float(np.radians(89.0))
_CLEARNESS_BINS = np.array([1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2])
_MOST_CLEARNESS = 12.0
_BRIGHTNESS = (0.01, 0.6)
# Least brightness of the fit in bins 2 to 5, by the erratum.
_LEAST_BRIGHTNESS = 0.2
# Least value of either factor of a luminance distribution inside the model's domain. Nearer to 0
# single directions outshine the mean 25 times; at 0 no light is left to scale.
_LEAST_FACTOR = 0.05
# Efficacy (lm/W) of a sun 2 degrees high behind broken clouds: the mean of the fits' five middle
# kinds, 7 to 50. No light is lost where a fit is below it.
_LEAST_DIRECT_LM_W = 20.0
# Brightnesses that may stand in, and angles from the sun at which the factors are compared.
_STAND_INS = np.linspace(*_BRIGHTNESS, 119)
_ANGLES_RAD = np.linspace(0.0, np.pi, 46)

# Table 1 of 1993: by clearness, a to e, of each four terms.
_SHAPE = np.array(
    [
        1.3525, -0.2576, -0.2690, -1.4366, -0.7670, 0.0007, 1.2734, -0.1233, 2.8000, 0.6004,
        1.2375, 1.0000, 1.8734, 0.6297, 0.9738, 0.2809, 0.0356, -0.1246, -0.5718, 0.9938,
        -1.2219, -0.7730, 1.4148, 1.1016, -0.2054, 0.0367, -3.9128, 0.9156, 6.9750, 0.1774,
        6.4477, -0.1239, -1.5798, -0.5081, -1.7812, 0.1080, 0.2624, 0.0672, -0.2190, -0.4285,
        -1.1000, -0.2515, 0.8952, 0.0156, 0.2782, -0.1812, -4.5000, 1.1766, 24.7219, -13.0812,
        -37.7000, 34.8438, -5.0000, 1.5218, 3.9229, -2.6204, -0.0156, 0.1597, 0.4199, -0.5562,
        -0.5484, -0.6654, -0.2672, 0.7117, 0.7234, -0.6219, -5.6812, 2.6297, 33.3389, -18.3000,
        -62.2500, 52.0781, -3.5000, 0.0016, 1.1477, 0.1062, 0.4659, -0.3296, -0.0876, -0.0329,
        -0.6000, -0.3566, -2.5000, 2.3250, 0.2937, 0.0496, -5.6812, 1.8415, 21.0000, -4.7656,
        -21.5906, 7.2492, -3.5000, -0.1554, 1.4062, 0.3988, 0.0032, 0.0766, -0.0656, -0.1294,
        -1.0156, -0.3670, 1.0078, 1.4051, 0.2875, -0.5328, -3.8500, 3.3750, 14.0000, -0.9999,
        -7.1406, 7.5469, -3.4000, -0.1078, -1.0750, 1.5702, -0.0672, 0.4016, 0.3017, -0.4844,
        -1.0000, 0.0211, 0.5025, -0.5119, -0.3000, 0.1922, 0.7023, -1.6317, 19.0000, -5.0000,
        1.2438, -1.9094, -4.0000, 0.0250, 0.3844, 0.2656, 1.0468, -0.3788, -2.4517, 1.4656,
        -1.0500, 0.0289, 0.4260, 0.3590, -0.3250, 0.1156, 0.7781, 0.0025, 31.0625, -14.5000,
        -46.1148, 55.3750, -7.2312, 0.4050, 13.3500, 0.6234, 1.5000, -0.6426, 1.8564, 0.5636,
    ]
).reshape(8, 5, 4)  # fmt: skip

# Table 4 of 1990: lumens per watt by clearness, four terms each.
_DIFFUSE = np.array([
    [97.24, -0.46, 12.00, -8.91], [107.22, 1.15, 0.59, -3.95], [104.97, 2.96, -5.53, -8.77],
    [102.39, 5.59, -13.95, -13.90], [100.71, 5.94, -22.75, -23.74], [106.42, 3.83, -36.15, -28.83],
    [141.88, 1.90, -53.24, -14.03], [152.23, 0.35, -45.27, -7.98],
])  # fmt: skip
_GLOBAL = np.array([
    [96.63, -0.47, 11.50, -9.16], [107.54, 0.79, 1.79, -1.19], [98.73, 0.70, 4.40, -6.95],
    [92.72, 0.56, 8.36, -8.31], [86.73, 0.98, 7.10, -10.94], [88.34, 1.39, 6.06, -7.60],
    [78.63, 1.47, 4.93, -11.37], [99.65, 1.86, -4.46, -3.15],
])  # fmt: skip
_DIRECT = np.array([
    [57.20, -4.55, -2.98, 117.12], [98.99, -3.46, -1.21, 12.38], [109.83, -4.90, -1.71, -8.81],
    [110.34, -5.84, -1.99, -4.56], [106.36, -3.97, -1.75, -6.16], [107.19, -1.25, -1.51, -26.73],
    [105.75, 0.77, -1.26, -34.44], [101.18, 1.58, -1.10, -8.29],
])  # fmt: skip


class AllWeather(NamedTuple):
    """The state of skies (...,): the sun's zenith angle, Perez's clearness and brightness."""

    zenith_rad: FloatArray
    clearness: FloatArray
    brightness: FloatArray

    @property
    def bin(self) -> NDArray[np.intp]:
        """Which of the eight kinds of sky, 0 is overcast and 7 clear."""
        return np.searchsorted(_CLEARNESS_BINS, self.clearness, side="right")

    @property
    def shape_brightness(self) -> FloatArray:
        """Brightness (...,) whose shape is drawn: the nearest one inside the model's domain.

        Outside it the fit has luminances of 0 or less: thin light of clearness 2.8 to 4.5 below a
        high sun, and much light of clearness above 6.2.
        """
        stated = self._stated_brightness
        shape = np.shape(stated)
        kind = np.atleast_1d(self.bin).ravel()
        zenith, drawn = (np.atleast_1d(values).ravel() for values in (self.zenith_rad, stated))
        outside = np.flatnonzero(~_is_inside(kind, zenith, drawn))
        if outside.size:
            inside = _is_inside(kind[outside, None], zenith[outside, None], _STAND_INS)
            away = np.where(inside, np.abs(_STAND_INS - drawn[outside, None]), np.inf)
            drawn = drawn.copy()
            drawn[outside] = _STAND_INS[np.argmin(away, axis=1)]
        return np.asarray(drawn.reshape(shape))

    @property
    def is_outside(self) -> NDArray[np.bool_]:
        """Whether hours (...,) lie outside the model's domain."""
        return np.asarray(self.shape_brightness != self._stated_brightness)

    @property
    def _stated_brightness(self) -> FloatArray:
        """Brightness (...,) with the erratum's least value."""
        between = (self.clearness > _CLEARNESS_BINS[0]) & (self.clearness < _CLEARNESS_BINS[4])
        return np.where(between, np.maximum(self.brightness, _LEAST_BRIGHTNESS), self.brightness)

    def distribution(self) -> Distribution:
        """How luminance is spread, by the shape's brightness; coefficients (...,)."""
        return _distribution(self.bin, self.zenith_rad, self.shape_brightness)

    def diffuse_efficacy(self, water_cm: ArrayLike) -> FloatArray:
        """Lumens per watt (...,) of the light of the sky, below `water_cm` of water vapour."""
        return self._of_level(_DIFFUSE, water_cm)

    def global_efficacy(self, water_cm: ArrayLike) -> FloatArray:
        """Lumens per watt (...,) of sun and sky together on level ground."""
        return self._of_level(_GLOBAL, water_cm)

    def direct_efficacy(self, water_cm: ArrayLike) -> FloatArray:
        """Lumens per watt (...,) of the sun on a plane that faces it.

        Below suns of 12 degrees the fits of cloudy kinds fall to 0 and less; the least value of
        all kinds stands in there.
        """
        a, b, c, d = np.moveaxis(_DIRECT[self.bin], -1, 0)
        low = np.exp(5.73 * self.zenith_rad - 5.0)
        fit = a + b * np.asarray(water_cm) + c * low + d * self.brightness
        return np.maximum(fit, _LEAST_DIRECT_LM_W)

    def _of_level(self, table: FloatArray, water_cm: ArrayLike) -> FloatArray:
        a, b, c, d = np.moveaxis(table[self.bin], -1, 0)
        value = a + b * np.asarray(water_cm) + c * np.cos(self.zenith_rad)
        return np.asarray(value + d * np.log(self.brightness))


def _distribution(
    kind: NDArray[np.intp], zenith: FloatArray, brightness: FloatArray
) -> Distribution:
    """The model's coefficients (...,) of kinds of sky, suns and brightnesses that broadcast."""
    terms = _SHAPE[kind]
    x1, x2, x3, x4 = np.moveaxis(terms, -1, 0)
    z, delta = zenith[..., None], brightness[..., None]
    a, b, c, d, e = np.moveaxis(x1 + x2 * z + delta * (x3 + x4 * z), -1, 0)
    c1, c2, c3, c4 = np.moveaxis(terms[..., 2, :], -1, 0)
    d1, d2, d3, d4 = np.moveaxis(terms[..., 3, :], -1, 0)
    overcast = kind == 0
    with np.errstate(invalid="ignore", over="ignore"):
        c_overcast = np.exp(np.maximum(brightness * (c1 + c2 * zenith), 0.0) ** c3) - c4
        d_overcast = -np.exp(brightness * (d1 + d2 * zenith)) + d3 + brightness * d4
    return Distribution(
        a, b, np.where(overcast, c_overcast, c), np.where(overcast, d_overcast, d), e
    )


def _is_inside(
    kind: NDArray[np.intp], zenith: FloatArray, brightness: FloatArray
) -> NDArray[np.bool_]:
    """Whether both factors of the luminance are above 0 in every direction (...,)."""
    spread = _distribution(kind, zenith, brightness)
    columns = Distribution(*(np.asarray(term)[..., None] for term in spread[:5]))
    gradation = columns.gradation(np.array([0.0, 1.0]))
    indicatrix = columns.indicatrix(np.cos(_ANGLES_RAD))
    return np.minimum(gradation.min(axis=-1), indicatrix.min(axis=-1)) >= _LEAST_FACTOR


def all_weather(
    direct_normal_w_m2: ArrayLike,
    diffuse_horizontal_w_m2: ArrayLike,
    sun_zenith_rad: ArrayLike,
    day_of_year: ArrayLike = 150,
) -> AllWeather:
    """The skies (...,) of broadband irradiances; the diffuse one must be above 0.

    Clearness and brightness are held within the model's bounds, 1 to 12 and 0.01 to 0.6.
    """
    direct, diffuse, zenith, day = np.broadcast_arrays(
        *(
            np.asarray(value, dtype=float)
            for value in (direct_normal_w_m2, diffuse_horizontal_w_m2, sun_zenith_rad, day_of_year)
        )
    )
    zenith = np.clip(zenith, 0.0, LOWEST_SUN_RAD)
    cube = 1.041 * zenith**3
    clearness = ((diffuse + direct) / diffuse + cube) / (1.0 + cube)
    above_air = SOLAR_CONSTANT_W_M2 * distance_factor(day)
    brightness = diffuse * air_mass(zenith) / above_air
    return AllWeather(
        zenith, np.clip(clearness, 1.0, _MOST_CLEARNESS), np.clip(brightness, *_BRIGHTNESS)
    )


def air_mass(zenith_rad: ArrayLike) -> FloatArray:
    """Relative optical air mass (...,), Kasten 1966."""
    zenith = np.asarray(zenith_rad, dtype=float)
    return 1.0 / (np.cos(zenith) + 0.15 * (93.885 - np.degrees(zenith)) ** -1.253)


def distance_factor(day_of_year: ArrayLike) -> FloatArray:
    """How much more sunlight (...,) arrives than at the mean distance, Spencer 1971."""
    angle = 2.0 * np.pi * (np.asarray(day_of_year, dtype=float) - 1.0) / 365.0
    first = 1.00011 + 0.034221 * np.cos(angle) + 0.00128 * np.sin(angle)
    return np.asarray(first + 0.000719 * np.cos(2.0 * angle) + 0.000077 * np.sin(2.0 * angle))


def precipitable_water_cm(dew_point_c: ArrayLike) -> FloatArray:
    """Water vapour (...,) above a place of a dew point in degrees Celsius, by Perez 1990."""
    return np.exp(0.07 * np.asarray(dew_point_c, dtype=float) - 0.075)

"""Spectral reflectance of the ground below a sky, and its colour in sunlight.

Spectra are those of `data/ground_reflectance.csv`, whose sources its NOTICE names. A ground is
Lambertian: water too, whose mirror image of the sky is counted as diffuse.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.resources import files
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.geometry.colour import colour_table, luminance, rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray, Vector, vector

# Columns of the table, after the wavelength.
GROUNDS = ("grass", "soil", "sand", "paving", "snow", "water")
GREY_ALBEDO = 0.1


@dataclass(frozen=True)
class GroundReflectance:
    """Reflectance of a ground at the wavelengths of `colour_table`, shares from 0 to 1."""

    values: tuple[float, ...]

    @classmethod
    def grey(cls, albedo: float) -> Self:
        """A ground that reflects all wavelengths alike."""
        return cls((float(albedo),) * len(colour_table()))

    @classmethod
    def named(cls, name: str) -> Self:
        """One of `GROUNDS`."""
        table = _table()
        nm = colour_table()[:, 0]
        return cls(tuple(np.interp(nm, table[:, 0], table[:, 1 + GROUNDS.index(name)]).tolist()))

    @classmethod
    def of_rgb(cls, rgb: ArrayLike) -> Self:
        """The smoothest spectrum of a colour (3,), linear sRGB in sunlight, cut off at 0 and 1."""
        return cls(tuple(np.clip(np.asarray(rgb, float) @ _smooth_spectra(), 0.0, 1.0).tolist()))

    def with_albedo(self, albedo: float) -> Self:
        """The same hue at another luminous albedo in sunlight, cut off at 1."""
        now = self.albedo
        if now <= 0.0:
            return self.grey(albedo)
        return type(self)(tuple(np.minimum(np.array(self.values) * (albedo / now), 1.0).tolist()))

    def at(self, wavelength_nm: ArrayLike) -> FloatArray:
        """Reflectance (...,) at wavelengths (...,), in nm."""
        return np.interp(np.asarray(wavelength_nm, float), colour_table()[:, 0], self.values)

    @cached_property
    def rgb(self) -> Vector:
        """Albedo of each channel: linear sRGB of sunlit ground over that of the sunlight."""
        if self.values.count(self.values[0]) == len(self.values):
            return (self.values[0],) * 3
        table = colour_table()
        return vector(sunlit_albedo(self.values, table[:, 4], tuple(table[:, 0])))

    @cached_property
    def albedo(self) -> float:
        """Luminous albedo in sunlight."""
        table = colour_table()
        white = rgb_from_spectrum(table[:, 4], table[:, 0])
        return float(luminance(np.array(self.rgb) * white) / luminance(white))


GREY = GroundReflectance.grey(GREY_ALBEDO)


def sunlit_albedo(
    reflectance: ArrayLike, solar_irradiance: ArrayLike, wavelength_nm: tuple[float, ...]
) -> FloatArray:
    """Albedo (3,) of each channel of linear sRGB, by spectra (C,) of ground and sunlight."""
    sun = np.asarray(solar_irradiance, float)
    lit = rgb_from_spectrum(sun * reflectance, wavelength_nm, 0.0)
    return np.clip(lit / rgb_from_spectrum(sun, wavelength_nm, 0.0), 0.0, 1.0)


@lru_cache(maxsize=1)
def _table() -> FloatArray:
    source = files("vrut_lite.atmosphere") / "data" / "ground_reflectance.csv"
    with source.open(encoding="utf-8") as lines:
        table: FloatArray = np.loadtxt(lines, delimiter=",")
    return table


@lru_cache(maxsize=1)
def _smooth_spectra() -> FloatArray:
    """Reflectances (3, W) of red, green and blue in sunlight, whose sum is 1 everywhere.

    The sum of squared differences of neighbours is least for the given colour, the condition of
    Smits 1999, "An RGB-to-spectrum conversion for reflectances", without his bounds.
    """
    table = colour_table()
    count = len(table)
    # Colour of sunlight that one wavelength alone reflects, over that of all.
    seen = np.array([rgb_from_spectrum(table[:, 4] * one, table[:, 0]) for one in np.eye(count)])
    seen /= seen.sum(axis=0)
    differences = np.diff(np.eye(count), axis=0)
    system = np.zeros((count + 3, count + 3))
    system[:count, :count] = differences.T @ differences
    system[:count, count:], system[count:, :count] = seen, seen.T
    sought = np.vstack([np.zeros((count, 3)), np.eye(3)])
    return np.asarray(np.linalg.solve(system, sought)[:count].T, np.float64)

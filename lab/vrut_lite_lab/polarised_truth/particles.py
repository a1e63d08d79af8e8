"""Scattering by OPAC's aerosols, by sasktran2's Mie code, independent of the product's optics.

Sizes and refractive indices: M. Hess, P. Koepke and I. Schult 1998, "Optical Properties of Aerosols
and Clouds", Bull. Am. Meteorol. Soc. 79, 831, tables 1 and 4, and its data set, in the visible.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from vrut_lite.lazy import lazy
from vrut_lite.numeric_types import FloatArray

_sasktran2 = lazy("sasktran2")

_INDEX_NM = (400.0, 450.0, 500.0, 550.0, 600.0, 650.0)
_WATER = (1.339, 1.337, 1.335, 1.333, 1.332, 1.331)
_SOLUBLE_ABSORPTION = (0.005, 0.005, 0.005, 0.006, 0.006, 0.007)
_SOOT_ABSORPTION = (0.460, 0.455, 0.450, 0.440, 0.435, 0.435)
_DUST_ABSORPTION = (0.013, 0.0085, 0.0078, 0.0055, 0.0045, 0.0045)
# Mode radius of dry water-soluble particles (um).
_DRY_UM = 0.0212
_RADII_PER_E_FOLD = 120
_ANGLE_DEG = np.concatenate([np.arange(0.0, 10.0, 0.1), np.arange(10.0, 180.25, 0.5)])


class LognormalRadii(NamedTuple):
    """Lognormal radii in micrometres: mode, geometric standard deviation, limits."""

    mode_um: float
    sigma: float
    least_um: float
    most_um: float


# Water-soluble particles at 80 and at 50 % of humidity; sulphuric acid of the stratosphere, whose
# sizes are Jaenicke's (1993) and whose index is Palmer and Williams's (1975).
COMPONENTS: Mapping[str, LognormalRadii] = MappingProxyType(
    {
        "waso80": LognormalRadii(0.0306, 2.24, 0.0067, 29.8),
        "waso50": LognormalRadii(0.0262, 2.24, 0.006, 25.0),
        "inso": LognormalRadii(0.471, 2.51, 0.005, 20.0),
        "soot": LognormalRadii(0.0118, 2.00, 0.005, 20.0),
        "minm": LognormalRadii(0.07, 1.95, 0.005, 20.0),
        "miam": LognormalRadii(0.39, 2.00, 0.005, 20.0),
        "micm": LognormalRadii(1.90, 2.15, 0.005, 30.0),
        "acid": LognormalRadii(0.07, 1.86, 0.005, 2.0),
    }
)


class Scattering(NamedTuple):
    """Scattering by particles at wavelengths (C,), relative to one another.

    Extinction and scattering (C,) per particle in um^2; P11, P12, P33 (3, C, n) at rising angles
    (n,), with P12 < 0 where light vibrates across the scattering plane.
    """

    extinction: FloatArray
    scattering: FloatArray
    angle_rad: FloatArray
    matrix: FloatArray


def mixture(particles: Mapping[str, float], wavelength_nm: FloatArray) -> Scattering:
    """Scattering by particles per cm^3 of the components, summed."""
    cosines = np.cos(np.radians(_ANGLE_DEG))
    extinction, scattering = np.zeros((2, wavelength_nm.size))
    matrix = np.zeros((3, wavelength_nm.size, cosines.size))
    mie = _sasktran2.mie.LinearizedMie()
    for name, count in particles.items():
        radius, share = _radii(COMPONENTS[name])
        for c, nm in enumerate(wavelength_nm):
            wave_number = 2000.0 * np.pi / nm
            found = mie.calculate(wave_number * radius, _index(name, nm), cosines, False).values
            area = count * share * np.pi * radius**2
            extinction[c] += area @ found.Qext
            scattering[c] += area @ found.Qsca
            across, along = np.abs(found.S1) ** 2, np.abs(found.S2) ** 2
            both = np.real(found.S2 * np.conj(found.S1))
            rows = 0.5 * (across + along), 0.5 * (along - across), both
            matrix[:, c] += np.stack([count * share @ row for row in rows]) / wave_number**2
    return Scattering(extinction, scattering, np.radians(_ANGLE_DEG), matrix)


def _radii(sizes: LognormalRadii) -> tuple[FloatArray, FloatArray]:
    """Radii (n,) in micrometres and the share of the particles at each."""
    count = int(np.log(sizes.most_um / sizes.least_um) * _RADII_PER_E_FOLD)
    edges = np.linspace(np.log(sizes.least_um), np.log(sizes.most_um), count + 1)
    middle, width = 0.5 * (edges[1:] + edges[:-1]), np.log(sizes.sigma)
    density = np.exp(-0.5 * ((middle - np.log(sizes.mode_um)) / width) ** 2)
    return np.exp(middle), density * np.diff(edges) / (np.sqrt(2.0 * np.pi) * width)


def _index(name: str, nm: float) -> complex:
    """Refractive index; that of soluble particles is a mean with water's by volume."""

    def at(values: tuple[float, ...]) -> float:
        return float(np.interp(nm, _INDEX_NM, values))

    if name == "acid":
        return complex(1.43)
    if name == "inso":
        return complex(1.53, -0.008)
    if name == "soot":
        return complex(1.75, -at(_SOOT_ABSORPTION))
    if name.startswith("mi"):
        return complex(1.53, -at(_DUST_ABSORPTION))
    solid = (_DRY_UM / COMPONENTS[name].mode_um) ** 3
    water = at(_WATER)
    return complex(water + solid * (1.53 - water), -solid * at(_SOLUBLE_ABSORPTION))

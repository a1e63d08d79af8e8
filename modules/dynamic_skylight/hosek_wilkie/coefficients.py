"""The fitted tables of Hosek and Wilkie, interpolated for one turbidity, albedo and hour.

Sources: Hosek and Wilkie 2012, "An Analytic Model for Full Spectral Sky-Dome Radiance", and
2013, "Adding a Solar-Radiance Function to the Hosek-Wilkie Skylight Model"; the tables are the
authors' own, version 1.4a. Every function takes turbidity 1 to 10.
"""

from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from dynamic_skylight.data_files import packaged_arrays
from vrut_lite.numeric_types import FloatArray

Quantity = Literal["rgb", "spec"]

WAVELENGTHS_NM = np.arange(320.0, 721.0, 40.0)
WAVELENGTHS_NM.flags.writeable = False
# Quintic Bernstein weights of the six control points.
_BINOMIAL = np.array([1.0, 5.0, 10.0, 10.0, 5.0, 1.0])
_POWERS = np.arange(6)
_SUN_SEGMENTS = 45


@lru_cache(maxsize=1)
def tables() -> dict[str, FloatArray]:
    """The six tables by name, read-only; the functions that use them describe their axes."""
    loaded = packaged_arrays("hosek_wilkie.npz")
    for table in loaded.values():
        table.flags.writeable = False
    return loaded


def channel_count(quantity: Quantity) -> int:
    """How many channels (3 colours or 11 wavelengths) a quantity's tables have."""
    return int(tables()[f"sky_rad_{quantity}"].shape[-1])


def sky_distribution(
    quantity: Quantity, turbidity: float, albedo: ArrayLike, sun_elevation_rad: float
) -> FloatArray:
    """The nine numbers A to I (C, 9) of the extended Perez formula, in the data's order.

    `albedo` is a number or one per channel (C,). The order is A B C D E F G H I with index 7 = H,
    the factor of the zenith term, and index 8 = I, the anisotropy in chi.
    """
    table = _between_turbidities(tables()[f"sky_params_{quantity}"], turbidity)
    weight = np.asarray(albedo, dtype=float)[..., None]
    return _between_albedos(table, weight, sun_elevation_rad)


def sky_mean_radiance(
    quantity: Quantity, turbidity: float, albedo: ArrayLike, sun_elevation_rad: float
) -> FloatArray:
    """The factor (C,) of the formula: W m^-2 sr^-1 for "rgb", W m^-2 sr^-1 nm^-1 for "spec"."""
    table = _between_turbidities(tables()[f"sky_rad_{quantity}"], turbidity)
    return _between_albedos(table, np.asarray(albedo, dtype=float), sun_elevation_rad)


def sun_radiance(turbidity: float, elevation_rad: ArrayLike) -> FloatArray:
    """Radiance (..., 11) of the disc's centre seen at elevations (...,), W m^-2 sr^-1 nm^-1.

    Cubic pieces in elevation whose length grows with its cube root (the 2013 paper's section
    3.2; `ArHosekSkyModel_Solar`'s break points): the atmosphere thins out fastest when low.
    """
    elevation = np.asarray(elevation_rad, dtype=float)
    table = _between_turbidities(tables()["sun_rad_spec"], turbidity)
    position = _SUN_SEGMENTS * np.cbrt(elevation / (np.pi / 2))
    segment = np.clip(position.astype(int), 0, _SUN_SEGMENTS - 1)
    x = (elevation - (np.pi / 2) * (segment / _SUN_SEGMENTS) ** 3)[..., None]
    c = table[segment]
    result: FloatArray = c[..., 0] + x * (c[..., 1] + x * (c[..., 2] + x * c[..., 3]))
    return result


def limb_darkening() -> FloatArray:
    """Polynomials (11, 6) in cos psi, constant first, one for each wavelength."""
    return tables()["sun_ld_spec"]


def _between_turbidities(table: FloatArray, turbidity: float) -> FloatArray:
    """Linear between the integers 1 to 10 of the first axis."""
    low = min(int(turbidity), len(table) - 1)
    part = turbidity - low
    return table[low - 1] * (1.0 - part) + table[low] * part


def _between_albedos(table: FloatArray, albedo: FloatArray, sun_elevation_rad: float) -> FloatArray:
    """Linear between ground albedo 0 and 1, after the Bezier curve in solar elevation.

    The cube root of elevation (2012 paper, section 5.3) gives the low sun most of the curve.
    """
    e = np.cbrt(sun_elevation_rad / (np.pi / 2))
    bernstein = _BINOMIAL * (1.0 - e) ** (5 - _POWERS) * e**_POWERS
    black, white = np.tensordot(bernstein, table, axes=(0, 1))
    result: FloatArray = black * (1.0 - albedo) + white * albedo
    return result

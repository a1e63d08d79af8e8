"""The fitted tables of Hosek and Wilkie, interpolated for one turbidity, albedo and hour.

Sources: Hosek and Wilkie 2012, "An Analytic Model for Full Spectral Sky-Dome Radiance", and
2013, "Adding a Solar-Radiance Function to the Hosek-Wilkie Skylight Model"; the tables are the
authors' own, version 1.4a. Every function takes turbidity 1 to 10.
"""

import math
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
_BINOMIAL = (1.0, 5.0, 10.0, 10.0, 5.0, 1.0)
# A to I and the factor.
_NUMBERS = 10
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


def sky_formula(
    quantity: Quantity, turbidity: float, albedo: ArrayLike, sun_elevation_rad: float
) -> tuple[FloatArray, FloatArray]:
    """The numbers A to I (C, 9) of the extended Perez formula, and its factor (C,).

    The order is that of the data: A B C D E F G H I with index 7 = H, the factor of the zenith
    term, and index 8 = I, the anisotropy in chi. The factor is in W m^-2 sr^-1 for "rgb", in
    W m^-2 sr^-1 nm^-1 for "spec".

    Linear between the integers of turbidity, and between ground albedo 0 and 1, a number or one per
    channel (C,); a Bezier curve in the cube root of solar elevation (2012 paper, section 5.3),
    which gives the low sun most of the curve.
    """
    table = _sky_table(quantity)
    low = min(int(turbidity), len(table) - 1)
    part = turbidity - low
    e = math.cbrt(sun_elevation_rad / (math.pi / 2))
    curve = [c * (1.0 - e) ** (5 - k) * e**k for k, c in enumerate(_BINOMIAL)]
    weights = np.array([share * c for share in (1.0 - part, part) for c in curve])
    points = table[low - 1 : low + 1].reshape(len(weights), -1)
    black, white = np.dot(weights, points).reshape(2, -1, _NUMBERS)
    share = np.asarray(albedo, dtype=float)[..., None]
    numbers = black * (1.0 - share) + white * share
    return numbers[:, :-1], numbers[:, -1]


@lru_cache(maxsize=2)
def _sky_table(quantity: Quantity) -> FloatArray:
    """Control points (10, 6, 2 C 10): turbidity, curve, then albedo, channel and number at once."""
    loaded = tables()
    factors = loaded[f"sky_rad_{quantity}"][..., None]
    table = np.concatenate([loaded[f"sky_params_{quantity}"], factors], axis=-1)
    points = np.moveaxis(table, 2, 1)
    return np.ascontiguousarray(points.reshape(*points.shape[:2], -1))


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

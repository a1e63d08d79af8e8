"""White balance: a white point, and the matrix that makes it white."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import SRGB_FROM_XYZ, colour_table
from vrut_lite.messages.picture import HIGHEST_K, LOWEST_K

# The white of sRGB itself: no balance.
DAYLIGHT_K = 6504.0
_LOCUS_START_K = 4000.0
_SECOND_RADIATION_CONSTANT_M_K = 1.438776877e-2
# Bradford (Lam 1985), as CIECAM97s and ICC profiles use it: XYZ to sharpened cones.
_CONES_FROM_XYZ = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)


@lru_cache(maxsize=32)
def white_balance_matrix(temperature_k: float, duv: float = 0.0) -> NDArray[np.float64]:
    """Matrix (3, 3) on linear sRGB that turns light of this white to the display's white.

    Luminance of the white is kept; 6504 K with duv 0 gives the identity.
    """
    scale = (_CONES_FROM_XYZ @ white_xyz(DAYLIGHT_K)) / (
        _CONES_FROM_XYZ @ white_xyz(temperature_k, duv)
    )
    adapted = np.linalg.inv(_CONES_FROM_XYZ) @ np.diag(scale) @ _CONES_FROM_XYZ
    matrix: NDArray[np.float64] = SRGB_FROM_XYZ @ adapted @ np.linalg.inv(SRGB_FROM_XYZ)
    matrix.flags.writeable = False
    return matrix


def white_xyz(temperature_k: float, duv: float = 0.0) -> NDArray[np.float64]:
    """XYZ (3,), Y = 1, of a white: daylight of a correlated colour temperature (K).

    `duv` moves it off the daylight locus, in the (u, v) of CIE 1960, towards green. Below
    4000 K, where there is no daylight, the locus goes on beside the black body's.

    Raises:
        ValueError: outside 1700 to 25000 K.
    """
    if not LOWEST_K <= temperature_k <= HIGHEST_K:
        raise ValueError(
            f"a white has {LOWEST_K:.0f} to {HIGHEST_K:.0f} K, not {temperature_k:g} K"
        )
    step_k = 1e-3 * temperature_k
    warmer, cooler = temperature_k - step_k, temperature_k + step_k
    along = _locus_uv(min(cooler, HIGHEST_K)) - _locus_uv(max(warmer, LOWEST_K))
    along /= np.linalg.norm(along)
    # Towards cooler whites u falls, so this normal points up, to green.
    u, v = _locus_uv(temperature_k) + duv * np.array([along[1], -along[0]])
    x, y = 3 * u / (2 * u - 8 * v + 4), 2 * v / (2 * u - 8 * v + 4)
    return np.array([x / y, 1.0, (1.0 - x - y) / y])


def _locus_uv(temperature_k: float) -> NDArray[np.float64]:
    if temperature_k >= _LOCUS_START_K:
        return _daylight_uv(temperature_k)
    return (
        _black_body_uv(temperature_k)
        + _daylight_uv(_LOCUS_START_K)
        - _black_body_uv(_LOCUS_START_K)
    )


def _daylight_uv(temperature_k: float) -> NDArray[np.float64]:
    """CIE 15:2004, equations 3.3 and 3.4."""
    t = 1e3 / temperature_k
    if temperature_k <= 7000.0:
        x = -4.6070 * t**3 + 2.9678 * t**2 + 0.09911 * t + 0.244063
    else:
        x = -2.0064 * t**3 + 1.9018 * t**2 + 0.24748 * t + 0.237040
    return _uv_of_xy(x, -3.0 * x * x + 2.870 * x - 0.275)


def _black_body_uv(temperature_k: float) -> NDArray[np.float64]:
    table = colour_table()
    wavelength_m = table[:, 0] * 1e-9
    radiance = wavelength_m**-5.0 / np.expm1(
        _SECOND_RADIATION_CONSTANT_M_K / (wavelength_m * temperature_k)
    )
    xyz = table[:, 1:4].T @ radiance
    return _uv_of_xy(*(xyz[:2] / xyz.sum()))


def _uv_of_xy(x: float, y: float) -> NDArray[np.float64]:
    return np.array([4 * x, 6 * y]) / (-2 * x + 12 * y + 3)

"""The sun's azimuth estimated from the symmetry of the measured sky.

The instrument's north was off by several degrees, so the computed azimuth does not match its
scans. The sky is symmetric about the sun's vertical plane: the azimuth, within 20 deg of the
computed one, in which the mirrored sky differs least is taken (Bruneton 2016).
"""

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite_lab.study.framework.interpolant import interpolate
from vrut_lite_lab.study.framework.spectra import integral

_REACH_DEG, _STEP_DEG = 20.0, 0.2
_ZENITHS, _AZIMUTHS = 16, 64


def estimated_sun_azimuth(radiance: ArrayLike, expected_azimuth_rad: float) -> float:
    """Azimuth in rad, in [0, 2 pi), of the plane about which radiance (81, 40) is symmetric.

    To 0.2 deg, within 20 deg of the expected azimuth.
    """
    # The interpolant and the integral are linear, so that the spectrum need not be carried.
    sky = integral(radiance)
    zenith = np.arccos((np.arange(_ZENITHS) + 0.5) / _ZENITHS)[:, None]
    azimuth = 2.0 * np.pi * np.arange(_AZIMUTHS) / _AZIMUTHS
    seen = interpolate(sky, zenith, azimuth)
    steps = round(2.0 * _REACH_DEG / _STEP_DEG)
    offset_deg = np.linspace(-_REACH_DEG, _REACH_DEG, steps + 1)
    candidates = expected_azimuth_rad + np.radians(offset_deg)
    mirrored = interpolate(sky, zenith, 2.0 * candidates[:, None, None] - azimuth)
    difference = np.abs(seen - mirrored).sum(axis=(1, 2))
    return float(np.mod(candidates[np.argmin(difference)], 2.0 * np.pi))

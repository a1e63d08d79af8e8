"""Skies for the figures: spectra in the 81 directions, colours of every pixel."""

from dataclasses import dataclass

import numpy as np

from vrut_lite.geometry.colour import SRGB_FROM_XYZ
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.colour import xyz
from vrut_lite_lab.study.framework.directions import COUNT, directions
from vrut_lite_lab.study.framework.fisheye import SkyPixels
from vrut_lite_lab.study.framework.interpolant import interpolate
from vrut_lite_lab.study.models.model import SkyModel
from vrut_lite_lab.study.report.moments import Moment

_AT_ONCE = 4096


@dataclass(frozen=True, eq=False)
class StudySky:
    """One sky: radiance (81, 40), and CIE XYZ (n, 3) in cd m^-2 of a picture's n pixels."""

    radiance: FloatArray
    xyz: FloatArray

    @property
    def luminance(self) -> FloatArray:
        """Of the pixels (n,), cd m^-2."""
        return self.xyz[:, 1]

    @property
    def zenith_luminance(self) -> float:
        """Overhead, cd m^-2."""
        return float(xyz(self.radiance[COUNT // 2])[1])

    @property
    def srgb(self) -> FloatArray:
        """Linear sRGB (n, 3) of the pixels, negative components cut to 0."""
        return np.maximum(self.xyz @ SRGB_FROM_XYZ.T, 0.0)


def directional_radiance(model: SkyModel, moment: Moment) -> FloatArray:
    """Radiance (81, 40) of a model in the 81 directions."""
    zenith, azimuth = directions()
    return model.sky_radiance(moment.sun_zenith_rad, zenith, azimuth - moment.sun_azimuth_rad)


def model_sky(model: SkyModel, moment: Moment, at: SkyPixels) -> StudySky:
    """A model's sky, every pixel computed."""
    relative = at.azimuth_rad - moment.sun_azimuth_rad
    parts = [
        xyz(model.sky_radiance(moment.sun_zenith_rad, at.zenith_rad[some], relative[some]))
        for some in _slices(at.zenith_rad.size)
    ]
    return StudySky(directional_radiance(model, moment), np.concatenate(parts))


def measured_sky(radiance: FloatArray, at: SkyPixels) -> StudySky:
    """A measured sky, interpolated between its 81 directions."""
    # Interpolation is linear: colours may be taken before it.
    return StudySky(radiance, interpolate(xyz(radiance), at.zenith_rad, at.azimuth_rad))


def _slices(count: int) -> list[slice]:
    return [slice(first, first + _AT_ONCE) for first in range(0, count, _AT_ONCE)]

"""The five round pictures of a sky, as in figures 2 to 6 of Galaj and Wojciechowski 2019."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vrut_lite_lab.study.framework.colour import chromaticity, tone_mapped
from vrut_lite_lab.study.framework.colour_scales import error_colours, luminance_colours
from vrut_lite_lab.study.framework.errors import relative_error
from vrut_lite_lab.study.framework.fisheye import Picture, SkyPixels, mark, picture
from vrut_lite_lab.study.framework.interpolant import interpolate
from vrut_lite_lab.study.report.moments import Moment
from vrut_lite_lab.study.report.skies import StudySky

TILE = 128
Paint = Callable[[StudySky], NDArray[np.generic]]

# By name: what the page says of it, and the colours of the pixels.
FIGURES: dict[str, tuple[str, Paint]] = {
    "figure2_fisheye": ("StudySky, tone-mapped", lambda sky: tone_mapped(sky.srgb)),
    "figure3_luminance": (
        "Absolute luminance in cd/m²",
        lambda sky: luminance_colours(sky.luminance),
    ),
    "figure4_relative_luminance": (
        "Luminance in percent of the zenith's",
        lambda sky: luminance_colours(100.0 * sky.luminance / sky.zenith_luminance),
    ),
    "figure5_chromaticity": ("Chromaticity", lambda sky: chromaticity(sky.srgb)),
}
ERROR_FIGURE = "figure6_relative_error"
ERROR_TITLE = "Relative error, 360 to 720 nm"


def panel(paint: Paint, sky: StudySky, moment: Moment, at: SkyPixels) -> Picture:
    """One round picture (TILE, TILE, 3) of a sky, the sun marked."""
    return _finished(picture(at, paint(sky)), moment)


def error_panel(sky: StudySky, reference: StudySky, moment: Moment, at: SkyPixels) -> Picture:
    """The relative error at the 81 directions, interpolated between them."""
    error = relative_error(sky.radiance, reference.radiance)
    seen = interpolate(error[:, None], at.zenith_rad, at.azimuth_rad)[:, 0]
    return _finished(picture(at, error_colours(seen)), moment)


def _finished(painted: Picture, moment: Moment) -> Picture:
    """Enlarged to a tile, then marked, so that marks stay fine."""
    times = TILE // len(painted)
    tile = painted.repeat(times, axis=0).repeat(times, axis=1)
    mark(tile, moment.sun_zenith_rad, moment.sun_azimuth_rad)
    return tile

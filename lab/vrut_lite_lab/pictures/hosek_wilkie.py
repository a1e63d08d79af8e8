"""The daylight thesis's figures A.1 to A.5, at their printed turbidity and albedo, on one sheet.

    python -m vrut_lite_lab.pictures.hosek_wilkie SHEET.jpg

The thesis (Hvezda 2020, appendix A) prints neither the sun's elevation nor the camera: 4 deg stand
for sunrise and 2 deg for sundown, seen towards the sun; of the two skies with the sun at the zenith
one shows the horizon and one looks up. Exposure is automatic, the tone map the host's, without the
sun's disc.
"""

import sys
from typing import NamedTuple

import numpy as np
from dynamic_skylight.daylight import Daylight
from numpy.typing import NDArray

from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.pictures.display import display_picture
from vrut_lite.sky.visible_disc import visible_fraction
from vrut_lite_lab.pictures.drawing import sheet, view_directions


class AppendixFigure(NamedTuple):
    """A figure of the appendix; the camera's pitch is above the horizon, towards the sun."""

    caption: str
    turbidity: float
    albedo: float
    sun_elevation_deg: float
    pitch_deg: float


FIGURES = (
    AppendixFigure("A.1 sunrise, T = 5, albedo 0.1", 5.0, 0.1, 4.0, 15.0),
    AppendixFigure("A.2 sundown, T = 5, albedo 0.1", 5.0, 0.1, 2.0, 15.0),
    AppendixFigure("A.3 sun at zenith, T = 5, albedo 0.1", 5.0, 0.1, 89.0, 20.0),
    AppendixFigure("A.4 sun at zenith, T = 5, albedo 0.1, looking up", 5.0, 0.1, 89.0, 70.0),
    AppendixFigure("A.5 sundown, T = 3, albedo 0.9", 3.0, 0.9, 2.0, 15.0),
)


def draw(figure: AppendixFigure) -> NDArray[np.integer]:
    """The figure (h, w, 3)."""
    elevation_rad = float(np.radians(figure.sun_elevation_deg))
    light = Daylight(
        turbidity=figure.turbidity,
        albedo=figure.albedo,
        sun_colour="disc",
        apparent_elevation_rad=elevation_rad,
        sun_azimuth_rad=0.0,
        visible_disc_fraction=float(visible_fraction(elevation_rad)),
    )
    radiance = sample_sky(light.background(512), view_directions(figure.pitch_deg))
    return display_picture(radiance.astype(np.float32))


if __name__ == "__main__":
    sheet([(figure.caption, draw(figure)) for figure in FIGURES], 3).save(sys.argv[1], quality=88)

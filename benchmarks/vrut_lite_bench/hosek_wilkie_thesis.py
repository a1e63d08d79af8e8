"""The daylight thesis's figures A.1 to A.5, at their printed turbidity and albedo, on one sheet.

    python -m vrut_lite_bench.hosek_wilkie_thesis SHEET.jpg

The thesis (Hvezda 2020, appendix A) prints no solar elevation and no camera: 4 deg stand for
sunrise and 2 deg for sundown, seen towards the sun; of the two skies with the sun at the
zenith one looks at the horizon and one up. Exposure is automatic, the tone map the host's.
"""

import sys
from typing import Any, NamedTuple

import numpy as np
from dynamic_skylight.daylight import Daylight
from dynamic_skylight.sun.disc import visible_fraction
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from vrut_lite.daylight.camera import look_at
from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.pictures.display import display_picture

WIDTH, HEIGHT = 480, 300
FIELD_OF_VIEW_DEG = 62.0
_CAPTION_HEIGHT = 22
_SUN_AZIMUTH_RAD = 0.0


class Figure(NamedTuple):
    """A figure of the appendix; the camera's pitch is above the horizon, towards the sun."""

    caption: str
    turbidity: float
    albedo: float
    sun_elevation_deg: float
    pitch_deg: float


FIGURES = (
    Figure("A.1 sunrise, T = 5, albedo 0.1", 5.0, 0.1, 4.0, 15.0),
    Figure("A.2 sundown, T = 5, albedo 0.1", 5.0, 0.1, 2.0, 15.0),
    Figure("A.3 sun at zenith, T = 5, albedo 0.1", 5.0, 0.1, 89.0, 20.0),
    Figure("A.4 sun at zenith, T = 5, albedo 0.1, looking up", 5.0, 0.1, 89.0, 70.0),
    Figure("A.5 sundown, T = 3, albedo 0.9", 3.0, 0.9, 2.0, 15.0),
)


def draw(figure: Figure) -> NDArray[np.integer]:
    """The figure (HEIGHT, WIDTH, 3), without the disc."""
    elevation = np.radians(figure.sun_elevation_deg)
    light = Daylight(
        turbidity=figure.turbidity,
        albedo=figure.albedo,
        sun_colour="disc",
        apparent_elevation_rad=float(elevation),
        sun_azimuth_rad=_SUN_AZIMUTH_RAD,
        visible_disc_fraction=float(visible_fraction(elevation)),
    )
    radiance = sample_sky(light.background(512), view_directions(figure.pitch_deg))
    return display_picture(radiance.astype(np.float32))


def view_directions(pitch_deg: float) -> NDArray[np.float64]:
    """Unit world directions (HEIGHT, WIDTH, 3) of a camera that looks north and up."""
    pitch = np.radians(pitch_deg)
    view = look_at((0.0, 0.0, 0.0), (0.0, float(np.sin(pitch)), float(-np.cos(pitch))))
    half = np.tan(np.radians(FIELD_OF_VIEW_DEG) / 2)
    x = (2 * np.arange(WIDTH) + 1) / WIDTH - 1
    y = 1 - (2 * np.arange(HEIGHT) + 1) / HEIGHT
    rays: Any = np.stack(
        np.broadcast_arrays(half * WIDTH / HEIGHT * x, half * y[:, None], -1.0), axis=-1
    )
    rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    directions: NDArray[np.float64] = rays @ view[:3, :3]
    return directions


def sheet() -> Image.Image:
    """All figures, three in a row, captioned."""
    rows = -(-len(FIGURES) // 3)
    paper = Image.new("RGB", (3 * WIDTH, rows * (HEIGHT + _CAPTION_HEIGHT)), "white")
    pen = ImageDraw.Draw(paper)
    for number, figure in enumerate(FIGURES):
        left, top = WIDTH * (number % 3), (HEIGHT + _CAPTION_HEIGHT) * (number // 3)
        paper.paste(Image.fromarray(draw(figure)), (left, top))
        pen.text((left + 6, top + HEIGHT + 5), figure.caption, fill="black")
    return paper


if __name__ == "__main__":
    sheet().save(sys.argv[1], quality=88)

"""Draw docs/pictures/twilight_*: illuminance against the published curve, and strips of skies.

Run with matplotlib installed: python -m vrut_lite_lab.twilight_fit.pictures
"""

from collections.abc import Callable
from functools import cache

import matplotlib as mpl
import numpy as np
from dynamic_skylight.sun_light import sun_light
from dynamic_skylight.twilight import HourSky, sky_of_hour
from dynamic_skylight.twilight_curve import illuminance_lx
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from vrut_lite.atmosphere.refraction import geometric_elevation, refraction_of_true_rad
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance, srgb_encode
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.visible_disc import visible_fraction

mpl.use("Agg")
import matplotlib.pyplot as plt

from vrut_lite_lab.checkout import ROOT

PICTURES = ROOT / "docs" / "pictures"
TABLE = ROOT / "modules" / "dynamic_skylight" / "data" / "twilight.npz"
STRIP_DEG = (10, 5, 2, 1, 0.5, 0, -1, -2, -3, -4, -5, -6, -8, -10, -12, -15, -18)
ARCH_DEG = (0.5, 0, -1, -2, -3, -4, -5, -6)
STRIP_TURBIDITIES = (3.0, 6.0)
PLOT_TURBIDITIES = (1.0, 3.0, 6.0, 10.0)
ALBEDO = 0.2
FRAME, MARGIN, TITLE = 150, 6, 26
# Mean luminance over the dome becomes this share of white; brighter parts roll off.
KEY = 0.35
# Of the second strip: exposure follows illuminance to this power, so that night stays darker.
RELATIVE_POWER = 0.8


@cache
def hour(turbidity: float, geometric_deg: float) -> HourSky:
    """The sky of a geometric elevation."""
    geometric = np.radians(geometric_deg)
    return sky_of_hour(turbidity, ALBEDO, float(geometric + refraction_of_true_rad(geometric)))


def illuminance(turbidity: float, geometric_deg: float) -> float:
    """Lux on level ground from the sky alone."""
    cube = hour(turbidity, geometric_deg).cube_map(64)
    return LUMENS_PER_WATT * float(luminance(horizontal_irradiance(cube)))


def sunlight(turbidity: float, geometric_deg: float) -> float:
    """Lux on level ground from what is up of the disc."""
    geometric = np.radians(geometric_deg)
    elevation = float(geometric + refraction_of_true_rad(geometric))
    light = sun_light(turbidity, ALBEDO, elevation, float(visible_fraction(elevation)))
    return LUMENS_PER_WATT * max(np.sin(elevation), 0.0) * float(luminance(light.irradiance_rgb))


def draw_illuminance() -> None:
    """The wrapper's illuminance, the published curve and the computed one."""
    elevation = np.linspace(-18.0, 10.0, 281)
    figure, axes = plt.subplots(figsize=(8.0, 5.5), layout="constrained")
    axes.semilogy(elevation, illuminance_lx(elevation), "k", lw=4, alpha=0.3,
                  label="published, sun and sky (Seidelmann 1992)")  # fmt: skip
    for colour, turbidity in enumerate(PLOT_TURBIDITIES):
        sky = np.array([illuminance(turbidity, e) for e in elevation])
        sun = np.array([sunlight(turbidity, e) for e in elevation])
        axes.semilogy(elevation, sky + sun, f"C{colour}", lw=1.2,
                      label=f"sun and sky, turbidity {turbidity:g}")  # fmt: skip
        axes.semilogy(elevation, sky, f"C{colour}:", lw=1.0)
    with np.load(TABLE) as table:
        for turbidity, level in zip(table["turbidity"], table["luminous_irradiance"], strict=True):
            # Solved without refraction: the sun's elevation there is the apparent one.
            geometric = np.degrees(geometric_elevation(np.radians(table["sun_deg"])))
            axes.semilogy(geometric, LUMENS_PER_WATT * level, ".", ms=5,
                          label=f"solved, sky alone, turbidity {turbidity:g}")  # fmt: skip
    axes.set(xlabel="geometric elevation of the sun (deg)", ylabel="illuminance (lx)",
             xlim=(10, -18), ylim=(3e-4, 3e4), title="dotted: sky alone; albedo 0.2")  # fmt: skip
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    figure.savefig(PICTURES / "twilight_illuminance.png", dpi=110)


def fisheye(sky: HourSky) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Radiance (FRAME, FRAME, 3) of the dome, equidistant, the sun at the bottom, and a mask."""
    axis = (np.arange(FRAME) + 0.5) / FRAME * 2.0 - 1.0
    x, y = np.meshgrid(axis, axis)
    radius = np.hypot(x, y)
    theta = np.minimum(radius, 1.0) * np.pi / 2
    return seen(sky, theta, np.arctan2(x, y)), radius <= 1.0


def seen(sky: HourSky, theta: FloatArray, azimuth: FloatArray) -> FloatArray:
    """Radiance (..., 3) at zenith angles and azimuths from the sun's."""
    e = sky.sun_elevation_rad
    cosine = np.cos(theta) * np.sin(e) + np.sin(theta) * np.cos(e) * np.cos(azimuth)
    return sky.radiance(theta, np.arccos(np.clip(cosine, -1.0, 1.0)))


def developed(radiance: FloatArray, exposure: float) -> NDArray[np.uint8]:
    """8 bits: each colour keeps its hue, its luminance rolls off towards white."""
    bright = luminance(radiance)[..., None] * exposure
    picture = radiance * exposure * (1.0 + bright / 9.0) / (1.0 + bright)
    return np.asarray(np.round(255.0 * srgb_encode(picture)), dtype=np.uint8)


def draw_strip() -> None:
    """Two pairs of rows: each frame exposed for itself, and exposed by illuminance^0.8."""
    rows = [(t, relative) for relative in (False, True) for t in STRIP_TURBIDITIES]
    sheet, pen = _sheet(len(STRIP_DEG), len(rows), FRAME, FRAME)
    for j, (turbidity, relative) in enumerate(rows):
        for i, e in enumerate(STRIP_DEG):
            radiance, inside = fisheye(hour(turbidity, e))
            exposure = KEY / float(luminance(radiance[inside]).mean())
            if relative:
                exposure *= (illuminance(turbidity, e) / illuminance(turbidity, 10.0)) ** (
                    1.0 - RELATIVE_POWER
                )
            frame = developed(radiance, exposure) * inside[..., None]
            how = "exposure E^-0.8" if relative else "auto"
            _paste(sheet, pen, i, j, frame.astype(np.uint8), f"{e:g}°  T={turbidity:g}  {how}")
    sheet.save(PICTURES / "twilight_strip.jpg", quality=90)


def draw_arch() -> None:
    """Opposite the sun, 140 by 35 deg: the pink band above the planet's shadow."""
    azimuth = np.pi + np.radians(np.linspace(-70.0, 70.0, 4 * FRAME))
    theta = np.radians(np.linspace(55.0, 89.9, FRAME))[:, None]
    sheet, pen = _sheet(2, len(ARCH_DEG), 4 * FRAME, FRAME)
    for i, turbidity in enumerate((2.0, 3.0)):
        for j, e in enumerate(ARCH_DEG):
            radiance = seen(hour(turbidity, e), *np.broadcast_arrays(theta, azimuth[None, :]))
            frame = developed(radiance, KEY / float(luminance(radiance).mean()))
            _paste(sheet, pen, i, j, frame, f"{e:g}°  T={turbidity:g}")
    sheet.save(PICTURES / "twilight_arch.jpg", quality=90)


def _sheet(
    columns: int, rows: int, width: int, height: int
) -> tuple[Image.Image, ImageDraw.ImageDraw]:
    size = (columns * (width + MARGIN) + MARGIN, rows * (height + TITLE) + MARGIN)
    sheet = Image.new("RGB", size, (24, 24, 24))
    return sheet, ImageDraw.Draw(sheet)


def _paste(
    sheet: Image.Image,
    pen: ImageDraw.ImageDraw,
    column: int,
    row: int,
    frame: NDArray[np.uint8],
    title: str,
) -> None:
    height, width = frame.shape[:2]
    left, top = MARGIN + column * (width + MARGIN), TITLE + row * (height + TITLE)
    sheet.paste(Image.fromarray(frame), (left, top))
    pen.text((left + 2, top - 16), title, fill=(220, 220, 220))


def main() -> None:
    """All three pictures."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    steps: tuple[Callable[[], None], ...] = (draw_illuminance, draw_strip, draw_arch)
    for step in steps:
        step()


if __name__ == "__main__":
    main()

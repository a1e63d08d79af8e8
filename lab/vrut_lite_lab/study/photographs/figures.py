"""Photograph and models side by side: lat-long strips, the solar meridian, maps of the residual.

Everything is turned so that the sun stands in the middle. Models are shown as the photograph
would have them, with its exposure and gains.
"""

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.messages.picture import SetExposure
from vrut_lite.numeric_types import FloatArray
from vrut_lite.pictures.display import display_picture
from vrut_lite.pictures.exposure import automatic_ev100
from vrut_lite_lab.study.photographs.comparison import PhotographComparison
from vrut_lite_lab.study.photographs.fit import MODELS, Fit, chromaticity
from vrut_lite_lab.study.photographs.mask import elevations_deg

matplotlib.use("Agg")
from matplotlib import pyplot as plt

_PANEL = (640, 160)
# A photograph's unit is unknown: it is no night.
_CAMERA = SetExposure(night_look="exposure")
_CAPTION_HEIGHT = 20
# The profile is the mean of so many columns on either side of the meridian.
_HALF_WIDTH = 2
_COLOURS = {"Hosek-Wilkie": "tab:blue", "Bruneton": "tab:red"}
_LARGEST_LOG10 = 0.3


def strips(comparison: PhotographComparison) -> Image.Image:
    """Photograph, masked photograph and the two fitted skies, from horizon to zenith."""
    reference = next(iter(comparison.fits.values()))
    photo = _upper(comparison.photo, reference) / reference.exposure
    usable = _upper(comparison.masks.usable, reference)
    ev100 = automatic_ev100(photo[usable].astype(np.float32))
    share = 100.0 * comparison.pixels.weight.sum() / _weight_of_sky(comparison.photo.shape[0])
    counts = f"what of it counts: {share:.0f} % of the hemisphere"
    panels = [("the photograph", photo), (counts, photo * usable[..., None])]
    for name in MODELS:
        found = comparison.fits[name]
        sky = _sky(name, found, comparison.photo.shape[0])
        caption = f"{name}, turbidity {found.turbidity:g}, sun {found.sun.elevation_deg:.1f} deg"
        panels.append((caption, sky / reference.exposure))
    width, height = _PANEL
    paper = Image.new("RGB", (2 * width, 2 * (height + _CAPTION_HEIGHT)), "white")
    pen = ImageDraw.Draw(paper)
    for number, (caption, radiance) in enumerate(panels):
        left, top = width * (number % 2), (height + _CAPTION_HEIGHT) * (number // 2)
        shown = display_picture(np.maximum(radiance, 0.0).astype(np.float32), ev100, _CAMERA)
        paper.paste(Image.fromarray(shown).resize(_PANEL, Image.Resampling.BICUBIC), (left, top))
        pen.text((left + 6, top + height + 4), caption, fill="black")
    return paper


def profile_figure(comparison: PhotographComparison, path: Path) -> None:
    """Luminance and chromaticity along the solar meridian; maps of the ratio of luminances."""
    figure, axes = plt.subplots(2, 2, figsize=(13.0, 7.0), layout="constrained")
    _draw_profiles(axes[0], comparison)
    for axis, name in zip(axes[1], MODELS, strict=True):
        found = comparison.fits[name]
        ratio = _log_ratio(comparison, name)
        picture = axis.imshow(
            ratio,
            extent=(-180.0, 180.0, 0.0, 90.0),
            vmin=-_LARGEST_LOG10,
            vmax=_LARGEST_LOG10,
            cmap="RdBu_r",
            aspect="auto",
        )
        axis.set(title=f"log10 photograph / {name}, T = {found.turbidity:g}")
        axis.set(xlabel="azimuth from the sun, deg", ylabel="elevation, deg")
    figure.colorbar(picture, ax=axes[1], shrink=0.7)
    figure.savefig(path, dpi=80)
    plt.close(figure)


def _draw_profiles(axes: Any, comparison: PhotographComparison) -> None:
    height = comparison.photo.shape[0]
    reference = next(iter(comparison.fits.values()))
    seen = _upper(comparison.masks.usable, reference)
    photo = np.where(seen[..., None], _upper(comparison.photo, reference), np.nan)
    angle, values = _meridian(photo)
    zenith = float(np.nanmean(luminance(photo[0])))
    light, colour = axes
    light.plot(angle, luminance(values) / zenith, "k.", ms=4, label="photograph")
    for name in MODELS:
        found = comparison.fits[name]
        sky = _meridian(_sky(name, found, height))[1]
        light.plot(angle, luminance(sky) / zenith, _COLOURS[name], label=name)
        for part, (letter, style) in enumerate((("u'", "--"), ("v'", "-"))):
            label = f"{name} {letter}"
            chroma = chromaticity(sky / found.gains)[:, part]
            colour.plot(angle, chroma, style, color=_COLOURS[name], label=label)
            photo_chroma = chromaticity(values / found.gains)[:, part]
            colour.plot(angle, photo_chroma, ".", ms=3, color=_COLOURS[name], alpha=0.5)
    light.axvline(reference.sun.elevation_deg, color="orange", lw=1, label="sun")
    light.set(yscale="log", title="relative luminance, 1 in the photograph's zenith")
    colour.set(title="u', v': models, and (dots) the photograph without their gains")
    for axis in axes:
        axis.set(xlabel="along the solar meridian: 0 below the sun, 90 zenith, deg")
        axis.grid(alpha=0.3)
        axis.legend(fontsize=8)


def _meridian(upper: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Angles (2 h,) from the sun's horizon over the zenith, and the mean values (2 h, 3) there.

    NaN where a part of the columns is masked.
    """
    height, width = upper.shape[:2]
    middle = np.arange(-_HALF_WIDTH, _HALF_WIDTH) + width // 2
    before = upper[:, middle].mean(axis=1)
    behind = upper[:, (middle + width // 2) % width].mean(axis=1)
    elevation = elevations_deg(2 * height)[:height]
    angle = np.concatenate([elevation[::-1], 180.0 - elevation])
    return angle, np.concatenate([before[::-1], behind])


def _log_ratio(comparison: PhotographComparison, name: str) -> NDArray[np.floating]:
    found = comparison.fits[name]
    photo = luminance(_upper(comparison.photo, found))
    sky = luminance(_sky(name, found, comparison.photo.shape[0]))
    seen = _upper(comparison.masks.usable, found)
    return np.where(seen, np.log10(np.where(seen, photo / sky, 1.0)), np.nan)


def _sky(name: str, found: Fit, height: int) -> FloatArray:
    """The model's sky (h / 2, 2 h, 3) in the photograph's unit and colours, sun in the middle."""
    centred = found.sun._replace(azimuth_deg=0.0)
    direction = lat_long_directions(height)[: height // 2]
    radiance = MODELS[name](found.turbidity, centred, direction.reshape(-1, 3))
    return radiance.reshape(direction.shape) * (found.exposure * found.gains)


def _weight_of_sky(height: int) -> float:
    """The sum of the weights of all pixels above the horizon."""
    return float(2 * height * np.cos(np.radians(elevations_deg(height)[: height // 2])).sum())


def _upper(picture: NDArray[Any], found: Fit) -> NDArray[Any]:
    """The sky's half of a lat-long picture, turned by whole columns to have the sun in the
    middle."""
    height = picture.shape[0]
    columns = round(found.sun.azimuth_deg / 180.0 * height)
    return np.roll(picture[: height // 2], -columns, axis=1)

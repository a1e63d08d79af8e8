"""Fits both sky models to a photograph of the sky, and gives the fits as Markdown tables."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import OpenEXR

from vrut_lite.errors import UserError
from vrut_lite_lab.study.photographs.fit import (
    MODELS,
    ClearPixels,
    Fit,
    FloatArray,
    Model,
    best_fit,
    bruneton_in,
    bruneton_with,
    contrast,
    fit,
    pixels_of,
    residual_log10,
    spread_log10,
)
from vrut_lite_lab.study.photographs.mask import Masks, Sun, find_azimuth_deg, find_disc, masks_of

TURBIDITIES = tuple(float(t) for t in np.arange(1.0, 10.01, 0.5))
# A sun that is not in view stands somewhere here: not yet up, or behind hills.
HIDDEN_SUN_DEG = tuple(float(e) for e in np.arange(-9.0, 1.01, 0.5))
# The search looks at every third row and column, the result at all.
_SEARCH_STEP = 3
_MOST_PIXELS = 64_000_000
HEADER = (
    "| photograph | sun elevation, azimuth | model | turbidity (as good) | exposure "
    "| gains R, G, B | rms log10 luminance | rms u'v' |\n|---|---|---|---:|---:|---|---:|---:|"
)
# Changes of the air of Bruneton's model, one at a time, that may explain the residual.
OTHER_AIR: dict[str, Model] = {
    "as the module has it, continental average": bruneton_with(),
    "continental clean": bruneton_in("continental-clean"),
    "continental polluted": bruneton_in("continental-polluted"),
    "urban": bruneton_in("urban"),
    "maritime clean": bruneton_in("maritime-clean"),
    "one lobe, g = 0.8": bruneton_in("one-lobe"),
    "one lobe, g = 0.6": bruneton_with(mie_g=0.6),
    "haze, scale height 3 km": bruneton_with(mie_scale_height_m=3000.0),
    "haze, scattering 0.8 of its light": bruneton_with(mie_albedo=0.8),
    "ground of albedo 0.3": bruneton_with(albedo=0.3),
    "no ozone": bruneton_with(ozone_du=0.0),
    "450 DU of ozone": bruneton_with(ozone_du=450.0),
}
AIR_HEADER = (
    "| photograph | Bruneton's sky | turbidity | rms log10 luminance | rms u'v' "
    "| mean log10 within 25° of the sun | contrast |\n|---|---|---:|---:|---:|---:|---:|"
)
_NEAR_SUN_DEG = 25.0


class PhotographComparison(NamedTuple):
    """A photograph (h, 2 h, 3), its masks, its clear pixels, and the models' fits by caption.

    `as_good`: for models that were searched, the least and the largest turbidity whose cost is
    within 10 % of the best.
    """

    photo: FloatArray
    masks: Masks
    pixels: ClearPixels
    fits: dict[str, Fit]
    as_good: dict[str, tuple[float, float]]


def read_photograph(path: Path) -> FloatArray:
    """Linear RGB (h, 2 h, 3), the zenith on the top row.

    Raises:
        UserError: it is no whole lat-long picture of three channels and 64 megapixels at most.
    """
    if not path.is_file():
        raise UserError(f"{path}: there is no such file")
    try:
        # The header tells what memory the pixels will take; the library would take it at once.
        with OpenEXR.File(str(path), header_only=True) as head:
            low, high = head.header()["dataWindow"]
        width, height = (int(side) for side in np.subtract(high, low, dtype=np.int64) + 1)
        if width != 2 * height or not 0 < width * height <= _MOST_PIXELS:
            raise UserError(f"{path}: {width} x {height} pixels are no lat-long picture of ours")
        with OpenEXR.File(str(path)) as file:
            picture = np.asarray(file.channels()["RGB"].pixels, dtype=float)
    except (RuntimeError, OSError, KeyError, ValueError) as error:
        raise UserError(f"{path}: is no whole picture of the channels R, G and B") from error
    if not np.isfinite(picture).all():
        raise UserError(f"{path}: holds values that are not finite")
    return picture


def compare(
    photo: FloatArray, turbidities: tuple[float, ...] = TURBIDITIES
) -> PhotographComparison:
    """Mask, sun, and the fit of each model; last, Bruneton at the turbidity of Hosek-Wilkie."""
    disc = find_disc(photo)
    masks = masks_of(photo, disc)
    suns = [disc] if disc else _hidden_suns(photo, masks)
    coarse = pixels_of(photo, masks.usable, _SEARCH_STEP)
    pixels = pixels_of(photo, masks.usable)
    fits, as_good = {}, {}
    for name, model in MODELS.items():
        found, as_good[name] = best_fit(coarse, model, turbidities, suns)
        fits[name] = fit(pixels, model, found.turbidity, found.sun)
    matched = fits["Hosek-Wilkie"]
    again = fit(pixels, MODELS["Bruneton"], matched.turbidity, matched.sun)
    fits["Bruneton, matched"] = again
    return PhotographComparison(photo, masks, pixels, fits, as_good)


def _hidden_suns(photo: FloatArray, masks: Masks) -> list[Sun]:
    azimuth = find_azimuth_deg(photo, masks.usable)
    return [Sun(azimuth, elevation, False) for elevation in HIDDEN_SUN_DEG]


def table_rows(name: str, comparison: PhotographComparison) -> list[str]:
    """Lines of the Markdown table for one photograph."""
    rows = []
    for model, found in comparison.fits.items():
        low, high = comparison.as_good.get(model, (None, None))
        span = "" if low is None else f" ({low:g} to {high:g})"
        rows.append(
            f"| {name} | {found.sun.elevation_deg:.1f}°, {found.sun.azimuth_deg:.1f}° | {model} "
            f"| {found.turbidity:g}{span} | {found.exposure:.3g} "
            f"| {', '.join(f'{gain:.2f}' for gain in found.gains)} "
            f"| {found.rms_log10:.3f} | {found.rms_uv:.4f} |"
        )
    even = spread_log10(comparison.pixels)
    return [*rows, f"| {name} | | an even sky | | | | {even:.3f} | |"]


def air_rows(
    name: str, comparison: PhotographComparison, turbidities: tuple[float, ...] = TURBIDITIES
) -> list[str]:
    """Lines of the Markdown table of other air for one photograph, each at its own turbidity."""
    pixels = pixels_of(comparison.photo, comparison.masks.usable, _SEARCH_STEP)
    sun = comparison.fits["Bruneton"].sun
    near = pixels.direction @ sun.direction() > np.cos(np.radians(_NEAR_SUN_DEG))
    rows = []
    for air, model in OTHER_AIR.items():
        found, _ = best_fit(pixels, model, turbidities, [sun])
        residual = residual_log10(pixels, model, found)
        rows.append(
            f"| {name} | {air} | {found.turbidity:g} | {found.rms_log10:.3f} | {found.rms_uv:.4f} "
            f"| {np.average(residual[near], weights=pixels.weight[near]):+.3f} "
            f"| {contrast(pixels, residual):.2f} |"
        )
    return rows

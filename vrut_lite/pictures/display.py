"""Exposure, white balance, tone map and dither on the CPU, as the frame's last pass has them."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures import exposure, tone_map
from vrut_lite.pictures.glare import with_glare
from vrut_lite.pictures.night_eye import (
    CONES_ALONE_CD,
    RODS_ALONE_CD,
    RODS_BLUE_RGB,
    RODS_GREY_RGB,
    XYZ_FROM_SRGB,
    adapted_cd,
    as_sharp_as_seen,
    seen_by_eye,
)
from vrut_lite.pictures.picture import Picture
from vrut_lite.pictures.white_balance import white_balance_matrix

Bits = Literal[8, 16]
_USUAL = SetExposure()


def display_picture(
    radiance: NDArray[np.floating],
    ev100: float | None = None,
    wish: SetExposure = _USUAL,
    bits: Bits = 8,
    inside: NDArray[np.bool_] | None = None,
    pixel_rad: float = 0.0,
) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """sRGB (h, w, 3) in 8 or 16 bits of linear sRGB radiance (h, w, 3) in W m^-2 sr^-1.

    Without `ev100` the exposure is metered from the picture itself, without pixels outside `inside`
    (h, w), such as the corners around a fisheye. All else is as `wish` says. `pixel_rad`, the angle
    that a pixel sees, gives a dark picture an eye's acuity, and glare its width; 0 leaves both out.
    Steps of 8 bits are dithered; those of 16 are invisible.
    """
    if ev100 is None:
        metered = radiance if inside is None else radiance[inside]
        ev100 = exposure.automatic_ev100(metered, night_look=wish.night_look)
    if wish.glare > 0.0 and pixel_rad > 0.0:
        radiance = with_glare(radiance, wish.glare, pixel_rad)
    field_cd = adapted_cd(ev100, wish.night_look)
    if field_cd is not None:
        radiance = seen_by_eye(as_sharp_as_seen(radiance, pixel_rad, field_cd), field_cd)
    balanced = radiance @ white_balance_matrix(wish.white_temperature_k, wish.white_duv).T
    encoded = tone_map.tone_mapped(balanced * exposure.scale_of(ev100), wish.tone_map)
    if bits == 16:
        return np.rint(encoded * 65535.0).astype(np.uint16)
    encoded += dither(*radiance.shape[:2])[..., None] / 255.0
    return np.rint(np.clip(encoded, 0.0, 1.0) * 255.0).astype(np.uint8)


def display_numbers() -> dict[str, Any]:
    """The numbers of AgX and of the eye by night, for a program elsewhere that does the same.

    Matrices are row after row; luminances are CIE Y in W m^-2 sr^-1.
    """
    return {
        "inset": tone_map.INSET.ravel().tolist(),
        "outset": tone_map.OUTSET.ravel().tolist(),
        "darkest": tone_map.DARKEST_LOG2,
        "brightest": tone_map.BRIGHTEST_LOG2,
        "sigmoid": list(tone_map.SIGMOID),
        "contrast": tone_map.CONTRAST,
        "saturation": tone_map.SATURATION,
        "xyz_from_srgb": XYZ_FROM_SRGB.ravel().tolist(),
        "rods_grey": RODS_GREY_RGB.tolist(),
        "rods_blue": RODS_BLUE_RGB.tolist(),
        "rods_range": [RODS_ALONE_CD / LUMENS_PER_WATT, CONES_ALONE_CD / LUMENS_PER_WATT],
    }


def developed(
    radiance: NDArray[np.float32], wish: SetExposure, pixel_rad: float = 0.0, white: float = 0.0
) -> Picture:
    """Radiance (h, w, 3) exposed and tone-mapped as the GL frame does it.

    `white`: see `automatic_ev100`.
    """
    ev100 = exposure.ev100_of(wish, radiance, white)
    # GL counts rows from below, and so does its dither.
    display = display_picture(radiance[::-1], ev100, wish, pixel_rad=pixel_rad)[::-1]
    return Picture(radiance, np.ascontiguousarray(display, np.uint8), ev100, pixel_rad=pixel_rad)


def dither(height: int, width: int) -> NDArray[np.float64]:
    """Triangular noise (h, w) in (-1, 1) steps of 8 bits, fixed per pixel.

    Two interleaved gradient noises (Jimenez 2014, "Next Generation Post Processing in Call of
    Duty"), summed: it breaks the bands of a smooth sky without moving its mean.
    """
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    return _gradient_noise(x, y) + _gradient_noise(y + 47.0, x + 47.0) - 1.0


def _gradient_noise(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.mod(52.9829189 * np.mod(0.06711056 * x + 0.00583715 * y, 1.0), 1.0)

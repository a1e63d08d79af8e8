"""Linear pictures as Radiance RGBE (.hdr): three mantissas of 8 bits and a shared exponent.

G. Ward, "Real Pixels", Graphics Gems II, 1991, and the Radiance file formats document. Pixels
are stored flat: every reader must take that, and no run-length code can be got wrong.
"""

import os

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT, SRGB_CHROMATICITIES
from vrut_lite.pictures.picture_array import Metadata, require_picture
from vrut_lite.write_atomic import atomic_output

# Radiance defines luminance as 179 lm/W times its radiance over the visible spectrum.
_RADIANCE_LUMENS_PER_WATT = 179.0
_EXPONENT_BIAS = 128
LARGEST = 255 / 256 * 2.0**127
_OF_THE_FORMAT = {"FORMAT", "EXPOSURE", "COLORCORR", "PRIMARIES", "MANTISSAS"}


def write_hdr(
    path: str | os.PathLike[str], rgb_linear: NDArray, metadata: Metadata | None = None
) -> None:
    """Write (h, w, 3) linear sRGB radiance, W m^-2 sr^-1, as float16 or float32.

    The pixels keep their numbers. EXPOSURE, by which Radiance divides them, is 179 / 683, so
    that its tools find the right luminance. Relative to a pixel's largest channel the error is
    at most 1/256; negative values become 0, those above LARGEST become that.

    Raises:
        ValueError: another shape or type, a value that is not finite, or a metadata name or
            value that the header cannot hold.
        UserError: the file cannot be written.
    """
    require_picture(rgb_linear, ("float16", "float32"))
    if not np.isfinite(rgb_linear).all():
        raise ValueError("a Radiance picture holds finite values only: this one has inf or nan")
    header = _header(metadata or {}, *rgb_linear.shape[:2])
    with atomic_output(path) as beside, beside.open("wb") as stream:
        stream.write(header.encode())
        for row in rgb_linear:
            stream.write(rgbe_from_rgb(row).tobytes())


def _header(metadata: Metadata, height: int, width: int) -> str:
    for key, value in metadata.items():
        if key in _OF_THE_FORMAT or not key or set("=\n") & set(key) or "\n" in str(value):
            raise ValueError(f"a Radiance header cannot hold the metadata '{key}'")
    lines = [
        "#?RADIANCE",
        *(f"{key}={value}" for key, value in metadata.items()),
        f"PRIMARIES={' '.join(f'{number:g}' for number in SRGB_CHROMATICITIES)}",
        f"EXPOSURE={_RADIANCE_LUMENS_PER_WATT / LUMENS_PER_WATT:.9g}",
        "MANTISSAS=rounded",
        "FORMAT=32-bit_rle_rgbe",
        "",
        f"-Y {height} +X {width}",
    ]
    return "\n".join(lines) + "\n"


def rgbe_from_rgb(rgb: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Bytes (..., 4) of RGB (..., 3): value = mantissa / 256 * 2^(exponent - 128).

    Mantissas are rounded to nearest: Radiance itself truncates and adds a half when it reads,
    but the readers in common use do not, and would find every picture 0.3 % too dark. The line
    MANTISSAS=rounded says so to readers that add the half.
    """
    value = np.clip(rgb.astype(np.float32), 0.0, LARGEST)
    largest = value.max(axis=-1)
    exponent = np.frexp(largest)[1]
    # A largest mantissa that rounds up to 256 needs the next exponent.
    exponent += np.rint(np.ldexp(largest, 8 - exponent)) > 255
    # A zero exponent byte means black, for values below the format's least.
    dark = (exponent <= -_EXPONENT_BIAS) | (largest == 0)
    mantissa = np.rint(np.ldexp(value, 8 - exponent[..., None]))
    rgbe = np.concatenate([mantissa, exponent[..., None] + _EXPONENT_BIAS], axis=-1)
    return np.where(dark[..., None], 0.0, rgbe).astype(np.uint8)

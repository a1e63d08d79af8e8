"""Reads equirectangular panoramas: OpenEXR, Radiance's RGBE (.hdr), and the sky of a glTF file."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from photo_sky.primaries import rgb_from_primaries
from photo_sky.read_gltf import SUFFIXES as GLTF_SUFFIXES
from photo_sky.read_gltf import GltfSun, read_gltf_sky
from photo_sky.read_hdr import pixels_of, read_head
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMENS_PER_WATT, SRGB_CHROMATICITIES
from vrut_lite.numeric_types import FloatArray

_MOST_PIXELS = 64_000_000
_SUFFIXES = (".exr", ".hdr", ".pic", *GLTF_SUFFIXES)
# Luminance of the value 1 in an EXR without whiteLuminance: 1 W m^-2 sr^-1, as in our files.
USUAL_CD_M2 = LUMENS_PER_WATT


class Panorama(NamedTuple):
    """A picture as stored, and its unit.

    Attributes:
        pixels: linear sRGB (h, 2 h, 3), the zenith on the top row; sharpened files, and colours
            outside sRGB, have values below 0.
        cd_m2_per_unit: luminance of RGB (1, 1, 1), by the file's own head.
        sun: the file's own sun, which is not in the picture; None to look for it there.
    """

    pixels: FloatArray
    cd_m2_per_unit: float
    sun: GltfSun | None = None


def read_panorama(path: Path) -> Panorama:
    """The panorama of a file, its colours as its head describes them.

    Raises:
        UserError: the file is missing, of another format, damaged, not twice as wide as high, or
            dark.
    """
    if not path.is_file():
        raise UserError(f"cannot open the panorama {path}: there is no such file")
    if path.suffix.lower() not in _SUFFIXES:
        raise UserError(f"{path} is no panorama: an EXR, HDR or glTF file is needed")
    try:
        found = _reader_of(path)(path)
    # OpenEXR and documents of other programs raise errors of several kinds.
    except (RuntimeError, OSError, LookupError, ValueError, TypeError, AttributeError):
        raise UserError(
            f"cannot read the panorama {path}: it is damaged or not linear RGB"
        ) from None
    pixels = found.pixels
    if not np.isfinite(pixels).all():
        raise UserError(f"cannot use the panorama {path}: it holds values that are not finite")
    if not pixels[: len(pixels) // 2].max() > 0.0:
        raise UserError(f"cannot use the panorama {path}: its upper half is black")
    return found


def _reader_of(path: Path) -> Callable[[Path], Panorama]:
    suffix = path.suffix.lower()
    if suffix in GLTF_SUFFIXES:
        return _read_gltf
    return _read_exr if suffix == ".exr" else _read_hdr


def _read_gltf(path: Path) -> Panorama:
    sky = read_gltf_sky(path, _MOST_PIXELS)
    _check_size(path, sky.pixels.shape[1], len(sky.pixels))
    return Panorama(*sky)


def _check_size(path: Path, width: int, height: int) -> None:
    if width != 2 * height or height < 8:
        raise UserError(
            f"{path} has {width} x {height} pixels: a panorama of the whole sphere is twice as "
            "wide as high"
        )
    if width * height > _MOST_PIXELS:
        raise UserError(f"the panorama {path} is too large: it has more than 64 megapixels")


def _read_exr(path: Path) -> Panorama:
    # Imported when used: whoever lists modules needs none of it.
    import OpenEXR

    # The header states the memory of the pixels, which the library would take at once.
    with OpenEXR.File(str(path), header_only=True) as head:
        low, high = head.header()["dataWindow"]
    width, height = (int(side) for side in np.subtract(high, low, dtype=np.int64) + 1)
    _check_size(path, width, height)
    with OpenEXR.File(str(path)) as file:
        channels, said = file.channels(), file.header()
        name = "RGB" if "RGB" in channels else "RGBA"
        pixels = np.asarray(channels[name].pixels, dtype=float)[..., :3]
        pixels = rgb_from_primaries(pixels, tuple(said.get("chromaticities", SRGB_CHROMATICITIES)))
        white = float(said.get("whiteLuminance", 0.0))
    return Panorama(pixels, white if np.isfinite(white) and white > 0.0 else USUAL_CD_M2)


def _read_hdr(path: Path) -> Panorama:
    data = path.read_bytes()
    head = read_head(data)
    _check_size(path, *head.size)
    return Panorama(pixels_of(data, head), head.cd_m2_per_unit)

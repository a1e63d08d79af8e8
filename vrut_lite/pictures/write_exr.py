"""Linear pictures as OpenEXR: half or single precision, ZIP, colour space and units stated."""

import os
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT, SRGB_CHROMATICITIES
from vrut_lite.pictures.picture_array import Metadata, require_picture
from vrut_lite.write_atomic import atomic_output

_OF_THE_FORMAT = {
    *("channels", "chunkCount", "compression", "dataWindow", "displayWindow", "lineOrder"),
    *("name", "pixelAspectRatio", "screenWindowCenter", "screenWindowWidth", "tiles", "type"),
    *("version", "view", "chromaticities", "whiteLuminance"),
}


def write_exr(
    path: str | os.PathLike[str],
    rgb_linear: NDArray,
    metadata: Metadata,
    more: Mapping[str, NDArray] | None = None,
) -> None:
    """Write (h, w, 3) linear sRGB radiance, W m^-2 sr^-1, in the precision of the array.

    `more` holds further channels (h, w) by name.

    float16 becomes HALF, float32 FLOAT, both bit for bit. Metadata become string and double
    attributes. The standard attribute whiteLuminance gives the luminance of RGB (1, 1, 1) in
    cd m^-2, so that a reader that knows it recovers the unit.

    Raises:
        ValueError: another shape or type, or a metadata name that the format itself uses.
        UserError: the file cannot be written.
    """
    import OpenEXR

    require_picture(rgb_linear, ("float16", "float32"))
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "chromaticities": SRGB_CHROMATICITIES,
        "whiteLuminance": LUMENS_PER_WATT,
        **{key: _attribute(key, value) for key, value in metadata.items()},
    }
    channels = {"RGB": rgb_linear, **(more or {})}
    picture = OpenEXR.File(
        header, {name: np.ascontiguousarray(values) for name, values in channels.items()}
    )
    with atomic_output(path) as beside:
        try:
            picture.write(os.fspath(beside))
        except RuntimeError as error:
            # The library's sentence names the temporary file in quotes, followed by the reason.
            raise OSError(str(error).rpartition('". ')[2].rstrip(".").lower()) from error


def _attribute(key: str, value: str | float) -> str | NDArray[np.float64]:
    """Text as it is; a number as an array of one, which the library stores as a double."""
    if key in _OF_THE_FORMAT:
        raise ValueError(f"the attribute '{key}' belongs to the OpenEXR format: name it otherwise")
    return value if isinstance(value, str) else np.array([value], dtype=np.float64)

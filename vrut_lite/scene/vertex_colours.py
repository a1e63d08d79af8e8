"""Vertex colours of all formats as linear values in [0, 1]; changes have notices."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import srgb_decode
from vrut_lite.scene.import_warnings import Notices

# Some programs write bytes. No colour of [0, 1] comes near it.
_BYTES_FROM = 2.0


def within_range(colours: NDArray[Any], notices: Notices) -> NDArray[np.float32]:
    """Linear colours (V, 3 or 4) in [0, 1]."""
    values = np.asarray(colours, np.float32)
    clipped = np.clip(np.nan_to_num(values, nan=0.0), 0.0, 1.0)
    # The last digit of packed and quantised values may lie outside.
    if not np.allclose(clipped, values, rtol=0.0, atol=1e-3):
        notices.tell_once("vertex colours outside 0 to 1", "clipped")
    return clipped


def colours_of_obj(colours: NDArray[np.float64], notices: Notices) -> NDArray[np.float64]:
    """Linear colours (V, 3) of an OBJ's, which are sRGB-encoded, as those who write them show them.

    The format says nothing of them; MeshLab, Blender (by default), ZBrush and scanners write the
    8-bit values of a display over 255.
    """
    if np.nanmax(colours, initial=0.0) >= _BYTES_FROM:
        notices.tell("vertex colours up to 255 in the OBJ", "divided by 255")
        colours = colours / 255.0
    return srgb_decode(within_range(colours, notices))

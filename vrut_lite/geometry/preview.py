"""Pictures for notebooks, which ask objects for them by `_repr_png_` and `_repr_html_`."""

from base64 import b64encode
from collections.abc import Sequence
from html import escape
from io import BytesIO

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import luminance, srgb_encode
from vrut_lite.geometry.panorama import fisheye_directions, sample_sky

_SIZE, _GAP = 240, 8
# Linear value of the mean sky luminance before the tone curve (1 = white).
_MEAN = 0.5


def png(display: NDArray[np.uint8]) -> bytes:
    """A picture (h, w, 3) as PNG."""
    # Pillow is only needed where something is shown.
    from PIL import Image

    into = BytesIO()
    Image.fromarray(np.ascontiguousarray(display)).save(into, format="png")
    return into.getvalue()


def captioned_html(picture: bytes, caption: str) -> str:
    """A PNG with words below it that a reader who does not see it hears too."""
    data, said = b64encode(picture).decode("ascii"), escape(caption)
    return (
        f'<figure style="margin:0"><img src="data:image/png;base64,{data}" alt="{said}" '
        f'style="max-width:100%"><figcaption>{said}</figcaption></figure>'
    )


def fisheyes_png(cubes: Sequence[NDArray[np.floating]], size: int = _SIZE) -> bytes:
    """Skies (6, n, n, 3) side by side as PNG, each a fisheye exposed to its own mean.

    Looking up, north at the top and east on the left; white where there is no sky.
    """
    directions, inside = fisheye_directions(size)
    strip = np.full((size, len(cubes) * (size + _GAP) - _GAP, 3), 255, np.uint8)
    for n, cube in enumerate(cubes):
        seen = np.maximum(sample_sky(cube, directions[inside]), 0.0)
        mean = float(np.mean(luminance(seen)))
        shown = srgb_encode(-np.expm1(-seen * (_MEAN / mean if mean > 0.0 else 0.0)))
        tile = strip[:, n * (size + _GAP) :][:, :size]
        tile[inside] = np.round(255.0 * np.clip(shown, 0.0, 1.0))
    return png(strip)

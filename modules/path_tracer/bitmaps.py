"""Texels as bitmaps of mitsuba, which go on beyond their edges as glTF's samplers say.

Mitsuba has one way to go on for both axes. Where they differ, a map is laid beside itself: twice
where it is mirrored, which then repeats, and so many times where it repeats beside an axis that is
clamped.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.scene_content import Sampler

Plugin = dict[str, Any]
_TILES = 16
_MOST_TEXELS = 2**26
_REPEATED = Sampler()


def bitmap(
    mitsuba: Any, texels: NDArray[np.float32], sampler: Sampler = _REPEATED
) -> dict[str, Any]:
    """The texture of texels (h, w, c), row 0 at v = 0, in linear values."""
    wraps = [sampler.wrap_v, sampler.wrap_u]
    spans = [1, 1]
    if wraps[0] != wraps[1]:
        for axis in (0, 1):
            if wraps[axis] == "mirror":
                texels = np.concatenate([texels, np.flip(texels, axis)], axis=axis)
                wraps[axis], spans[axis] = "repeat", 2
    firsts = [0.0, 0.0]
    if wraps[0] != wraps[1] and texels.size * _TILES <= _MOST_TEXELS:
        axis = wraps.index("repeat")
        times = _TILES // spans[axis]
        texels = np.concatenate([texels] * times, axis=axis)
        firsts[axis], spans[axis] = 0.5, _TILES
        wraps[axis] = "clamp"
    made = {
        "type": "bitmap",
        "bitmap": mitsuba.Bitmap(np.ascontiguousarray(texels)),
        "raw": True,
        "filter_type": "nearest" if sampler.nearest else "bilinear",
        "wrap_mode": "repeat" if wraps[0] != wraps[1] else wraps[0],
    }
    if spans != [1, 1]:
        transform = mitsuba.ScalarTransform4f()
        move = transform.translate([firsts[1], firsts[0], 0.0])
        made["to_uv"] = move @ transform.scale([1.0 / spans[1], 1.0 / spans[0], 1.0])
    return made

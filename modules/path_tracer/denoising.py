"""Pictures without grain, by Intel's Open Image Denoise (Afra 2024) where it is installed."""

from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from path_tracer.guides import Guides

_DENOISER = "mitsuba_oidn"


def can_denoise() -> bool:
    """Whether the package mitsuba-oidn is installed."""
    return find_spec(_DENOISER) is not None


def without_grain(
    radiance: NDArray[np.float32], guides: Guides | None = None
) -> NDArray[np.float32]:
    """Linear radiance (h, w, 3) without grain; it invents what few paths leave open."""
    import mitsuba_oidn

    told = {} if guides is None else guides._asdict()
    # Copied, for the next call may write into the same memory.
    return np.array(mitsuba_oidn.denoise(np.ascontiguousarray(radiance), hdr=True, **told))

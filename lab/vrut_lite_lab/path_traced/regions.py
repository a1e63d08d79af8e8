"""Regions of a picture, and how far two pictures differ in them."""

import flip_evaluator
import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter

from vrut_lite.array import Array
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.scene.scene_state import SceneState
from vrut_lite_lab.path_traced.cases import Case
from vrut_lite_lab.path_traced.truths import Picture, Recipe, kept, traced
from vrut_lite_lab.pictures.darkness import no_background, no_sun, relit

REGIONS_NAME = "regions"
REGIONS = ("sunlit", "shadowed", "sky")
_SAMPLES = 8
_FEWEST_PIXELS = 100
Mask = NDArray[np.bool_]


def regions_of(case: Case, state: SceneState) -> dict[str, Mask]:
    """Masks (h, w) of REGIONS without pixels at their edges, from disk if known."""
    return kept(case, REGIONS_NAME, lambda: dict(_regions(state)))


def _regions(state: SceneState) -> dict[str, Mask]:
    """Where sky without the sun is seen, where all of a pixel is in the sun, and where none is.

    The sun's disc is some pixels wide: how much of it a frame's few samples a pixel meet is chance.
    """
    above = (texel_directions(64)[..., 1:2] > 0.0) * np.ones(3)
    # No surface may be met: what the eye sees of the sky is 1, and all else black.
    unlit, seen = (
        relit(state, key_light=no_sun(), background=no_background()),
        Recipe(max_bounces=0),
    )
    sky = traced(relit(unlit, background=uniform(above)), seen, _SAMPLES)
    bare = traced(relit(unlit, background=uniform(np.ones_like(above))), seen, _SAMPLES)
    by_sun = relit(state, background=no_background())
    sharp = Recipe(max_bounces=1, sun="sharp")
    lit = luminance(traced(by_sun, sharp, _SAMPLES))
    disc = luminance(traced(by_sun, seen, _SAMPLES))
    things = bare.max(axis=-1) == 0.0
    return {
        "sky": _inner((sky.min(axis=-1) > 0.999) & (disc == 0.0)),
        "sunlit": _inner(things & (lit > 0.05 * np.quantile(lit, 0.95)) & (lit > 0.0)),
        "shadowed": _inner(things & (lit == 0.0)),
    }


def uniform(cube: NDArray[np.float64]) -> BackgroundChanged:
    """A background of a cube map (6, n, n, 3)."""
    return msgspec.structs.replace(no_background(), cube=Array(cube.astype(np.float16)))


def _inner(mask: Mask) -> Mask:
    return np.asarray(minimum_filter(mask, 3, mode="nearest"))


def difference(picture: Picture, reference: Picture, mask: Mask) -> float:
    """Relative difference of the mean luminance in a region; NaN where it hardly is one."""
    if mask.sum() < _FEWEST_PIXELS or not np.any(reference[mask] > 0.0):
        return float("nan")
    return float(luminance(picture[mask]).mean() / luminance(reference[mask]).mean() - 1.0)


def flip(picture: Picture, reference: Picture) -> float:
    """Mean HDR-FLIP (Andersson et al. 2021), 0 for equal pictures."""
    clipped = [np.maximum(image, 0.0).astype(np.float32) for image in (reference, picture)]
    return float(flip_evaluator.evaluate(*clipped, "HDR")[1])

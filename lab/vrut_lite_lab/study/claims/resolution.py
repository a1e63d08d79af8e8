"""Whether a cube map finer than 256^2 texels a face shows more of a clear sky (the thesis)."""

from collections.abc import Iterator

import numpy as np
from dynamic_skylight import HosekWilkieSky

from vrut_lite.geometry.colour import srgb_encode
from vrut_lite.geometry.cube_map import sample_cube, texel_directions
from vrut_lite.numeric_types import FloatArray

_TURBIDITY, _ALBEDO = 3.0, 0.1
_SIZES, _ELEVATIONS_DEG = (64, 128, 256, 512, 1024), (2.0, 10.0, 45.0)
_LOOKS = 50_000
# Half a texel of the smallest map below the horizon would mix ground into the sky.
_LOWEST_DEG = 1.5


def display_difference(size: int, elevation_deg: float) -> FloatArray:
    """Differences (n,) in steps of 1/255 on a screen, at random directions of the sky.

    Between the formula and a look-up, linear between texels, in a cube map of it; the largest
    of three channels. Exposed so that the mean sky is at 1 - 1/e of white.
    """
    elevation = np.radians(elevation_deg)
    sun = np.array([0.0, np.sin(elevation), -np.cos(elevation)])
    sky = HosekWilkieSky(_TURBIDITY, _ALBEDO, float(elevation))
    directions = _directions()
    right = _radiance(sky, directions, sun)
    seen = sample_cube(_radiance(sky, texel_directions(size), sun), directions)
    codes = (255.0 * srgb_encode(-np.expm1(-each / right.mean())) for each in (right, seen))
    return np.abs(np.subtract(*codes)).max(axis=-1)


def _directions() -> FloatArray:
    rng = np.random.default_rng(1)
    up = rng.uniform(np.sin(np.radians(_LOWEST_DEG)), 1.0, _LOOKS)
    azimuth, across = rng.uniform(0.0, 2.0 * np.pi, _LOOKS), np.sqrt(1.0 - up * up)
    return np.stack([across * np.sin(azimuth), up, -across * np.cos(azimuth)], axis=-1)


def _radiance(sky: HosekWilkieSky, directions: FloatArray, sun: FloatArray) -> FloatArray:
    zenith = np.arccos(np.clip(directions[..., 1], 0.0, 1.0))
    return np.asarray(sky.radiance(zenith, np.arccos(np.clip(directions @ sun, -1.0, 1.0))))


def report() -> Iterator[str]:
    """Lines of text."""
    yield "cube maps of a Hosek-Wilkie sky against the formula, steps of 1/255: mean, 99 %, largest"
    for elevation in _ELEVATIONS_DEG:
        for size in _SIZES:
            off = display_difference(size, elevation)
            yield (
                f"  sun {elevation:g} deg up, {size}^2: {off.mean():.3f}, "
                f"{np.quantile(off, 0.99):.2f}, {off.max():.2f}"
            )

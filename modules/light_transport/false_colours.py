"""The light map as pictures in false colours: light, texel size and noise. No Qt here."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.light_map import NOT_MAPPED, LightMapLaid, SurfaceLightChanged
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.numeric_types import FloatArray

# From dark violet over green to yellow, as perceptually even scales have it.
_STOPS = np.array(
    [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]], float
)
_UNUSED = (24, 24, 24)
# Range of the shown values: darker and brighter ones get the colours of the ends.
_LOW, _HIGH = 0.01, 0.99
_WIDEST = 1e3
_SAMPLES_A_TEXEL = 4.0


class FalseColours(NamedTuple):
    """sRGB pixels (h, w, 3) uint8, and the values of the darkest and the brightest colour."""

    pixels: NDArray[np.uint8]
    low: float
    high: float


def light_picture(light: SurfaceLightChanged) -> FalseColours:
    """Illuminance by all but the key light's own light, in lux, on a scale by ratios."""
    return _coloured(_illuminance_lx(light))


def error_picture(finer: SurfaceLightChanged, coarser: SurfaceLightChanged) -> FalseColours:
    """Noise that the finer's rays leave, as a share of the light: rms over 3 x 3 texels.

    Both are of one hour, and the fewer rays of the coarser are among the finer's: with n of N rays
    the variance of their difference is N / n - 1 times the variance that N rays leave.
    """
    one, other = _illuminance_lx(finer), _illuminance_lx(coarser)
    change = (one - other) / np.maximum(np.maximum(one, other), 1e-9)
    height, width = one.shape
    wide = np.pad(change * change, 1, mode="edge")
    boxes = [wide[i : i + height, j : j + width] for i in range(3) for j in range(3)]
    noise = np.sqrt(np.mean(boxes, axis=0) / (finer.rays / coarser.rays - 1.0))
    return _coloured(np.where(one > 0.0, noise, 0.0))


def scale_pixels(width: int) -> NDArray[np.uint8]:
    """The scale (1, width, 3) from the darkest colour to the brightest."""
    return _colour_at(np.linspace(0.0, 1.0, width)[None])


def density_picture(laid: LightMapLaid, scene: SceneOpened) -> FalseColours:
    """The edge of the texels in metres; the ground's are left out."""
    width, height = laid.size_px
    edges_m = np.zeros((height, width))
    for part, number in enumerate(laid.part_shape.values.tolist()):
        if number == NOT_MAPPED:
            continue
        shape = laid.shape(number)
        uv = shape.uv[shape.triangles] + laid.part_corner_px.values[part]
        corners_m = scene.geometry.world_triangles(part)
        _splat(uv.astype(float), _texel_edges_m(uv.astype(float), corners_m), edges_m)
    return _coloured(edges_m)


def _illuminance_lx(light: SurfaceLightChanged) -> FloatArray:
    rgb = light.texels.values[..., :3].astype(float) * light.radiance_scale
    return np.asarray(luminance(rgb) * LUMENS_PER_WATT, float)


def _texel_edges_m(uv: FloatArray, corners_m: FloatArray) -> FloatArray:
    """How wide (F,) a texel is on each triangle."""
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    texels = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    across = np.cross(corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0])
    area_m2 = 0.5 * np.linalg.norm(across, axis=1)
    return np.sqrt(area_m2 / np.maximum(texels, 1e-12))


def _splat(uv: FloatArray, values: FloatArray, picture: FloatArray) -> None:
    """Give the texels under triangles (F, 3, 2) their values, at points spread over them."""
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    texels = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    counts = (np.ceil(_SAMPLES_A_TEXEL * texels) + 3).astype(int)
    which = np.repeat(np.arange(len(uv)), counts)
    # The plastic number's sequence is even for any count.
    step = np.arange(len(which))
    s, t = (0.5 + 0.7548776662466927 * step) % 1.0, (0.5 + 0.5698402909980532 * step) % 1.0
    folded = s + t > 1.0
    s, t = np.where(folded, 1.0 - s, s)[:, None], np.where(folded, 1.0 - t, t)[:, None]
    at = np.floor(uv[which, 0] + s * a[which] + t * b[which]).astype(int)
    height, width = picture.shape
    column, row = np.clip(at[:, 0], 0, width - 1), np.clip(at[:, 1], 0, height - 1)
    picture[row, column] = values[which]


def _coloured(values: FloatArray) -> FalseColours:
    """Colours by the logarithm of positive values; others count as unused."""
    used = values > 0.0
    if not np.any(used):
        pixels = np.broadcast_to(np.array(_UNUSED, np.uint8), (*values.shape, 3))
        return FalseColours(np.ascontiguousarray(pixels), 0.0, 0.0)
    low, high = (float(value) for value in np.quantile(values[used], (_LOW, _HIGH)))
    low = max(low, high / _WIDEST)
    span = max(np.log(high / low), 1e-9)
    pixels = _colour_at(np.clip(np.log(np.maximum(values, low) / low) / span, 0.0, 1.0))
    pixels[~used] = _UNUSED
    return FalseColours(pixels, low, high)


def _colour_at(share: FloatArray) -> NDArray[np.uint8]:
    at = share * (len(_STOPS) - 1)
    rgb = np.stack([np.interp(at, range(len(_STOPS)), stops) for stops in _STOPS.T], axis=-1)
    return rgb.round().astype(np.uint8)

"""Quality of a light map by texel: the width of texels and the noise of their light."""

import numpy as np

from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.light_map import NOT_MAPPED, LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import FloatArray

_SAMPLES_A_TEXEL = 4.0


def noise(finer: FloatArray, coarser: FloatArray, times: float) -> FloatArray:
    """Noise of the light, as a share of it: rms over 3 x 3 texels.

    Args:
        finer, coarser: irradiance (h, w, 3) of one hour by many and by fewer rays, of which the
            fewer are among the many.
        times: ratio of the numbers of rays. With n of N rays the variance of the difference is
            N / n - 1 times the variance with N rays.
    """
    one, other = luminance(np.asarray(finer, float)), luminance(np.asarray(coarser, float))
    change = (one - other) / np.maximum(np.maximum(one, other), 1e-30)
    height, width = one.shape
    wide = np.pad(change * change, 1, mode="edge")
    boxes = [wide[i : i + height, j : j + width] for i in range(3) for j in range(3)]
    return np.where(one > 0.0, np.sqrt(np.mean(boxes, axis=0) / (times - 1.0)), 0.0)


def noise_of_pair(finer: SurfaceLightChanged, coarser: SurfaceLightChanged) -> FloatArray:
    """`noise` of the texels (h, w) of two messages, the finer by more rays."""
    one, other = (
        light.texels.values[..., :3].astype(float) * light.radiance_scale
        for light in (finer, coarser)
    )
    return noise(one, other, finer.rays / coarser.rays)


def texel_edges_m(laid: LightMapLaid, scene: SceneOpened) -> FloatArray:
    """The edge (h, w) of each texel in metres, 0 where none is on a surface."""
    width, height = laid.size_px
    edges_m = np.zeros((height, width))
    for part, number in enumerate(laid.part_shape.values.tolist()):
        if number == NOT_MAPPED:
            continue
        shape = laid.shape(number)
        uv = (shape.uv[shape.triangles] + laid.part_corner_px.values[part]).astype(float)
        _splat(uv, _edges_on(uv, scene.geometry.world_triangles(part)), edges_m)
    if laid.ground is not None:
        chart = laid.ground
        along = np.linspace(-1.0, 1.0, chart.edge_px)
        slope = chart.half_width_m * chart.warp / np.sinh(chart.warp) * 2.0 / (chart.edge_px - 1)
        edge_m = slope * np.cosh(chart.warp * along)
        (left, top), (right, bottom) = chart.corner_px, chart.end_px
        edges_m[top:bottom, left:right] = np.sqrt(np.outer(edge_m, edge_m))
    return edges_m


def _edges_on(uv: FloatArray, corners_m: FloatArray) -> FloatArray:
    """Width (F,) in metres of a texel on each triangle."""
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    texels = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    # Looked up in the middle of a texel, on both sides of which the chart ends: half of a strip.
    narrow = (np.ptp(uv, axis=1) == 0.0).any(axis=1)
    texels[narrow] = 0.5 * np.maximum(np.ptp(uv[narrow], axis=1).max(axis=1), 1.0)
    across = np.cross(corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0])
    area_m2 = 0.5 * np.linalg.norm(across, axis=1)
    return np.sqrt(area_m2 / np.maximum(texels, 1e-12))


def _splat(uv: FloatArray, values: FloatArray, picture: FloatArray) -> None:
    """Give the texels under triangles (F, 3, 2) their values, at points spread over them."""
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    texels = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    counts = (
        np.ceil(_SAMPLES_A_TEXEL * np.maximum(texels, np.ptp(uv, axis=1).max(axis=1)))
    ).astype(int) + 3
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

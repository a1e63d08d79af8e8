"""Light maps for the scene of one square, and their twin in double precision."""

import numpy as np

from vrut_lite.array import Array
from vrut_lite.messages.light_map import GroundChart, LightMapLaid, ProbeGrid, SurfaceLightChanged

# Of the square's four corners, (-0.5, 0.5) first, in the rectangle of a part: x right, z down.
RECTANGLE_PX = 8
CORNERS_PX = np.array([[0.5, 7.5], [7.5, 7.5], [7.5, 0.5], [0.5, 0.5]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
PROBES = ProbeGrid(lower_m=(-2.0, -1.0, -2.0), step_m=(1.0, 1.0, 1.0), counts=(5, 4, 5))


def laid(scene, corners_px, ground=None, probes=None, size_px=(32, 16), key="layout"):
    """The layout of parts that all show one square; a corner of None has no texels."""
    mapped = np.array([corner is not None for corner in corners_px])
    corner = np.array([corner or (0, 0) for corner in corners_px], np.int32)
    message = LightMapLaid(
        content_key=scene.content_key,
        layout_key=key,
        size_px=size_px,
        shapes=Array(np.array([[0, 0, 6, 0, 2]])),
        # Split along the diagonal, as charts are.
        source_vertex=Array(TRIANGLES.astype(np.int32).ravel()),
        uv=Array(CORNERS_PX[TRIANGLES.ravel()].astype(np.float32)),
        triangles=Array(np.arange(6, dtype=np.int32).reshape(2, 3)),
        part_shape=Array(np.where(mapped, 0, -1).astype(np.int32)),
        part_corner_px=Array(corner),
        ground=ground,
        probes=probes,
        source="test",
    )
    message.check()
    message.check_arrays()
    return message


def lit(layout, texels, probes=None, scale=1.0, sky=None):
    """Light in that layout: texels (h, w, 4), probes (nz, ny, nx, 6, 4); irradiance and share.

    `sky` (4,): b and a of the share of the sky that all see.
    """
    over = np.array([scale, scale, scale, 1.0])
    message = SurfaceLightChanged(
        layout_key=layout.layout_key,
        texels=Array((texels / over).astype(np.float16)),
        probes=None if probes is None else Array((probes / over).astype(np.float16)),
        radiance_scale=scale,
        rays=64,
        source="test",
        visible_sky=None
        if sky is None
        else Array(np.broadcast_to(sky, texels.shape).astype(np.float16)),
    )
    message.check()
    message.check_arrays()
    assert message.fits(layout)
    return message


def even(layout, irradiance=np.pi, share=1.0):
    """The same light in every texel."""
    width, height = layout.size_px
    return np.broadcast_to(np.array([irradiance] * 3 + [share]), (height, width, 4))


def uneven(layout, seed=0):
    """Light that differs from texel to texel."""
    width, height = layout.size_px
    texels = np.random.default_rng(seed).uniform(1.0, 4.0, (height, width, 4))
    texels[..., 3] = 1.0
    return texels.astype(np.float16).astype(float)


def fetched(texels, at_px):
    """The linearly filtered values (..., 4) of texels (h, w, 4) at places (..., 2) in texels."""
    at = np.asarray(at_px) - 0.5
    first = np.floor(at).astype(int)
    part = at - first
    total = 0.0
    for right in (0, 1):
        for down in (0, 1):
            weight = np.abs(1 - right - part[..., 0]) * np.abs(1 - down - part[..., 1])
            column = np.clip(first[..., 0] + right, 0, texels.shape[1] - 1)
            row = np.clip(first[..., 1] + down, 0, texels.shape[0] - 1)
            total = total + weight[..., None] * texels[row, column]
    return total


def on_chart(chart: GroundChart, away_m):
    """Texel coordinates (..., 2) of level places (..., 2), metres from the disc's middle."""
    along = np.arcsinh(np.sinh(chart.warp) * np.asarray(away_m) / chart.half_width_m) / chart.warp
    along = np.clip(along, -1.0, 1.0)
    return np.array(chart.corner_px) + 0.5 + 0.5 * (1.0 + along) * (chart.edge_px - 1)

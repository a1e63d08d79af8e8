"""The ground's texels, where they lie, and which texel a place has."""

import numpy as np
import pytest
from light_transport.layout.ground_chart import (
    ground_chart,
    ground_owners,
    ground_uv_px,
    ground_xz_m,
)
from light_transport.layout.layout import lay_out
from light_transport.surfaces.surfaces import surfaces_of
from mesh_scenes import box, opened

from vrut_lite.messages.ground_disc import GroundDisc

DISC = GroundDisc((30.0, -7.0), 1.5, 600.0)
CHART = ground_chart(DISC, 10.0, (64, 200))


def test_places_are_where_the_message_says():
    """The formula of `GroundChart`, written out for one point."""
    at = ground_uv_px(CHART, DISC, (30.0 + 3.0, -7.0 - 20.0))
    for found, corner, d in zip(at, CHART.corner_px, (3.0, -20.0), strict=True):
        warped = np.arcsinh(np.sinh(CHART.warp) * d / 40.0) / CHART.warp
        assert found == pytest.approx(corner + 0.5 + 0.5 * (1 + warped) * 95)


def test_every_texel_leads_to_its_place_and_back():
    """Middles of texels to the ground and back, the outermost on the chart's border."""
    row, column = np.indices((96, 96))
    middles = np.stack([column, row], axis=-1) + 0.5 + CHART.corner_px
    xz_m = ground_xz_m(CHART, DISC, middles)
    np.testing.assert_allclose(ground_uv_px(CHART, DISC, xz_m), middles)
    np.testing.assert_allclose([xz_m.min((0, 1)), xz_m.max((0, 1))], [(-10, -47), (70, 33)])
    # The texels below the scene are finer than those at the edge by the cosine of the warp.
    width_m = np.diff(xz_m[48, :, 0])
    assert width_m[-1] / width_m[47] == pytest.approx(np.cosh(3.0), rel=0.1)


def test_what_lies_beyond_has_the_outermost_texels():
    """A look-up far away stays in the chart."""
    far = ground_uv_px(CHART, DISC, [(1e6, -1e6)])
    np.testing.assert_allclose(far, [(64 + 95.5, 200.5)])


def test_a_texel_s_owner_lies_below_it():
    """The two triangles of the ground's square, met from above."""
    scene = opened(box((4, 3, 9)), ground=True)
    surfaces = surfaces_of(scene)
    layout = lay_out(scene, surfaces, texels=900)
    chart = layout.message.ground
    (x, y), last = chart.corner_px, len(surfaces.part)
    square = layout.owner[y : y + 96, x : x + 96]
    np.testing.assert_array_equal(square, ground_owners(last - 2))
    row, column = np.nonzero(square == last - 1)
    middles = np.stack([column, row], axis=-1) + 0.5 + chart.corner_px
    xz_m = ground_xz_m(chart, scene.ground, middles) - surfaces.centre_m[[0, 2]]
    a, b, c = surfaces.corners_m[-1][:, [0, 2]]
    shares = np.linalg.solve(np.stack([b - a, c - a], axis=1), (xz_m - a).T)
    assert shares.min() > -1e-9
    assert shares.sum(axis=0).max() < 1 + 1e-9

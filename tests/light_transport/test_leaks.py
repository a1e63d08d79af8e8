"""Light that gets through walls: a shut room as people model it, boxes that touch on one floor.

`pytest -s` prints how much; docs/light.md has the figures.
"""

import numpy as np
import pytest
from boxes import hour
from light_transport.layout.layout import lay_out
from light_transport.surfaces.surfaces import surfaces_of
from light_transport.transport import SceneTransport
from long_parameters import mostly_long
from mesh_scenes import box, opened

HALF_M, HIGH_M, TEXEL_M = 1.5, 2.5, 0.1


def solid(lower, upper):
    """A box with normals of its sides."""
    points, triangles = box(np.subtract(upper, lower))
    points = (points + np.asarray(lower))[np.ravel(triangles)]
    sides = np.cross(points[1::3] - points[::3], points[2::3] - points[::3])
    normals = np.repeat(sides / np.linalg.norm(sides, axis=1, keepdims=True), 3, axis=0)
    return points, np.arange(36), normals


def shut_room(thick):
    """Four walls and a lid on a floor that goes on outdoors."""
    inner, outer = HALF_M, HALF_M + thick
    return opened(
        solid((-outer, 0.0, -outer), (-inner, HIGH_M, outer)),
        solid((inner, 0.0, -outer), (outer, HIGH_M, outer)),
        solid((-inner, 0.0, -outer), (inner, HIGH_M, -inner)),
        solid((-inner, 0.0, inner), (inner, HIGH_M, outer)),
        solid((-outer, HIGH_M, -outer), (outer, HIGH_M + thick, outer)),
        solid((-outer - 2.0, -0.1, -outer - 2.0), (outer + 2.0, 0.0, outer + 2.0)),
    )


def looked_up(layout, texels, rng, count=60):
    """Light at places (N, 3), the places, and their triangles, as the frame interpolates it."""
    weights = rng.dirichlet((1.0, 1.0, 1.0), (len(layout.uv_px), count))
    at = np.einsum("fnk,fkc->fnc", weights, layout.uv_px.astype(float)) - 0.5
    low = np.floor(at).astype(int)
    (x, y), (column, row) = np.moveaxis(at - low, -1, 0), np.moveaxis(low, -1, 0)
    top = (1.0 - x) * texels[row, column] + x * texels[row, column + 1]
    below = (1.0 - x) * texels[row + 1, column] + x * texels[row + 1, column + 1]
    return weights, (1.0 - y) * top + y * below


@pytest.mark.parametrize("texels_thick", mostly_long([2.0, 2.2, 3.0], (2.0).__eq__))
def test_a_shut_room_is_dark_in_the_mean(texels_thick):
    """Sun, sky and sunlit floor outside: inside there is less than a thousandth of their light in
    the mean, and less than a ten-thousandth anywhere, where walls touch too."""
    scene = shut_room(texels_thick * TEXEL_M)
    surfaces = surfaces_of(scene)
    surfaces.reflectance_rgb[:] = 0.8
    layout = lay_out(scene, surfaces, TEXEL_M)
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(128)
    light = transport.light(hour(5.0, irradiance=100.0, key=(0.4, 0.7, 0.2))).texels[..., 1]
    weights, found = looked_up(layout, light, np.random.default_rng(0))
    places = np.einsum("fnk,fkc->fnc", weights, surfaces.corners_m) + surfaces.centre_m
    inwards = np.einsum("fnc,fc->fn", [0.0, 0.5 * HIGH_M, 0.0] - places, surfaces.face_normals())
    edge = np.array([HALF_M, HIGH_M, HALF_M]) + 1e-6
    inside = (np.abs(places) < edge).all(axis=-1) & (places[..., 1] > -1e-6) & (inwards > 0.0)
    outdoors = np.median(found[(places[..., 1] > -1e-6) & (np.abs(places) > 2.5).any(axis=-1)])
    share = found[inside] / outdoors
    print(
        f"\na wall of {texels_thick} texels: {share.mean():.1e} of the light outdoors in the mean,"
        f" {share.max():.1e} at most, {np.mean(share > 1e-3):.2%} of places above a thousandth"
    )
    assert inside.sum() > 500
    assert share.mean() < 1e-3
    assert share.max() < 1e-4

"""What the points of a still mirror, against sums of the BRDF over the hemisphere."""

import numpy as np
import pytest
from boxes import box, floor, hour, quads
from light_transport.giving_up import always
from light_transport.transport import SceneTransport
from light_transport.view.view_reflections import ViewPoints, lobe_light

from vrut_lite.geometry.cube_map import texel_directions

RAYS = 4096
UP = np.array([0.0, 1.0, 0.0])
WALL_FACING_WEST = [[1, 0, -2], [1, 0, 2], [1, 1, 2], [1, 1, -2]]


def shown(transport, towards, light, place=(0.0, 0.0, 0.0), rays=RAYS):
    """Both parts (2, 3) of what a point of the first quad, which faces up, mirrors to an eye."""
    towards = np.asarray(towards, float) / np.linalg.norm(towards)
    radii = (np.asarray(place) - transport.surfaces.centre_m) / transport.surfaces.radius_m
    points = ViewPoints(np.zeros(1, np.int32), radii[None], UP[None], UP[None], towards[None])
    return lobe_light(transport, light, transport.light(light), points, rays, 1, always).radiance[
        :, 0
    ]


def by_sums(towards, roughness, light):
    """The same by sums over directions, of radiances light(d (N, 3)); glTF 2.0, appendix B.3."""
    view = -np.asarray(towards, float) / np.linalg.norm(towards)
    # As many directions for each cosine, equal steps of which are equal solid angles.
    cosine = (np.arange(400) + 0.5) / 400
    turn = 2.0 * np.pi * (np.arange(576) + 0.5) / 576
    y, turn = (grid.ravel() for grid in np.meshgrid(cosine, turn))
    d = np.stack([np.sqrt(1 - y**2) * np.cos(turn), y, np.sqrt(1 - y**2) * np.sin(turn)], axis=1)
    half = d + view
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    a2, nv = roughness**4, view[1]
    distribution = a2 / (np.pi * (half[:, 1] ** 2 * (a2 - 1.0) + 1.0) ** 2)
    smith = y * np.sqrt(nv**2 * (1 - a2) + a2) + nv * np.sqrt(y**2 * (1 - a2) + a2)
    grazing = (1.0 - half @ view) ** 5
    brdf = distribution * 0.5 / smith * y
    weights = np.stack([brdf * (1.0 - grazing), brdf * grazing])
    return weights @ light(d) / weights.sum(axis=1)


@pytest.mark.parametrize("roughness", [0.3, 0.8])
@pytest.mark.parametrize("towards", [(0.3, -1.0, 0.2), (1.0, -0.25, 0.1)])
def test_lobes_are_those_of_the_brdf(roughness, towards):
    """A glowing wall before a black sky: its share of either lobe is that of the sums."""
    surfaces = quads(floor(-1, 1, -2, 2), WALL_FACING_WEST, emitted=np.pi, roughness=roughness)
    surfaces[0].emitted_rgb[:2] = 0.0
    surfaces[0].reflectance_rgb[:] = 0.0
    transport = SceneTransport(*surfaces)
    transport.add_rays(16)

    def light(d):
        meets = d[:, 0] > 1e-9
        t = 1.0 / np.where(meets, d[:, 0], 1.0)
        return (meets & (d[:, 1] * t < 1.0) & (np.abs(d[:, 2] * t) < 2.0)).astype(float)

    expected = by_sums(towards, roughness, light)
    assert shown(transport, towards, hour(0.0))[:, 1] == pytest.approx(expected, abs=0.01)


def test_the_sky_is_read_where_each_ray_goes():
    """A sky of radiance 1 + x + 2 y above black ground, whose image is no mean."""
    d = texel_directions(32)
    cube = np.repeat((1.0 + d[..., :1] + 2.0 * d[..., 1:2]), 3, axis=-1).astype(np.float32)
    transport = SceneTransport(*quads(floor(-1, 1, -1, 1), roughness=0.5))
    transport.add_rays(16)
    towards = (1.0, -0.5, 0.0)
    expected = by_sums(towards, 0.5, lambda d: 1.0 + d[:, 0] + 2.0 * d[:, 1])
    found = shown(transport, towards, hour(1.0, cube=cube, ground=0.0))
    assert found[:, 1] == pytest.approx(expected, rel=0.01)


def test_even_light_is_mirrored_evenly():
    """In a closed box that glows with 1, and of albedo 0, every lobe shows 1."""
    walls = box((-1, 0, -1), (1, 2, 1), inwards=True)
    transport = SceneTransport(*quads(*walls, emitted=np.pi, reflectance=0.0, roughness=0.3))
    transport.add_rays(16)
    found = shown(transport, (0.5, -1.0, 0.2), hour(0.0), (0.0, 0.0, 0.0), rays=64)
    assert found == pytest.approx(1.0, abs=1e-5)


def test_what_is_mirrored_stands_in_the_key_light_or_in_its_shadow():
    """A matte wall of albedo 0.5 under a key light from the west, half of it behind a screen."""
    screen = [[-1, 0, -2], [-1, 0, 0], [-1, 2, 0], [-1, 2, -2]]
    surfaces = quads(floor(-1, 1, -2, 2), WALL_FACING_WEST, screen, [*screen[::-1]], roughness=0.1)
    transport = SceneTransport(*surfaces)
    transport.add_rays(16)
    light = hour(0.0, key=(-1.0, 0.0, 0.0), irradiance=np.pi)
    lit = shown(transport, (1.0, -0.5, 0.0), light, (0.0, 0.0, 1.0))
    shaded = shown(transport, (1.0, -0.5, 0.0), light, (0.0, 0.0, -1.0))
    assert lit[0, 1] - shaded[0, 1] == pytest.approx(0.5, abs=0.05)


def test_what_has_no_texels_tells_nothing():
    """Foliage has no roughness here: the frame keeps its own coat."""
    transport = SceneTransport(*quads(floor(-1, 1, -1, 1)))
    transport.add_rays(16)
    points = ViewPoints(np.full(1, -1, np.int32), *np.tile(UP, (3, 1, 1)), -UP[None])
    now = hour(1.0)
    found = lobe_light(transport, now, transport.light(now), points, 16, 1, always)
    assert not found.radiance.any()


def test_lobes_go_on_where_a_few_rays_ended():
    """A fourth of the rays everywhere, the others where they are asked for: there the light is that
    of all rays, and elsewhere that of the fourth."""
    transport = SceneTransport(*quads(floor(-1, 1, -1, 1), WALL_FACING_WEST, roughness=0.5))
    transport.add_rays(16)
    x = np.array([-0.5, 0.0, 0.5])
    places = np.stack([x, 0.0 * x, 0.0 * x], axis=1) - transport.surfaces.centre_m
    towards = np.tile(np.array([1.0, -1.0, 0.0]) / np.sqrt(2.0), (3, 1))
    points = ViewPoints(
        np.zeros(3, np.int32),
        places / transport.surfaces.radius_m,
        *np.tile(UP, (2, 3, 1)),
        towards,
    )
    asked = np.array([True, False, True])
    light = hour(1.0)
    found = lobe_light(
        transport, light, transport.light(light), points, 64, 1, always, lambda few: asked
    )
    few, all_rays = (
        lobe_light(transport, light, transport.light(light), points, rays, 1, always)
        for rays in (16, 64)
    )
    for values, of_few, of_all in zip(found, few, all_rays, strict=True):
        axis = values.ndim - 1 if values.shape[-1] == 3 else 1
        picked = [np.moveaxis(each, axis, 0) for each in (values, of_few, of_all)]
        np.testing.assert_array_equal(picked[0][asked], picked[2][asked])
        np.testing.assert_array_equal(picked[0][~asked], picked[1][~asked])
    assert not np.array_equal(few.radiance, all_rays.radiance)

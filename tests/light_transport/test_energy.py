"""Light is neither lost nor made: furnaces, open planes, form factors, rooms that are shut.

`pytest -s` prints how near it came (docs/light.md has the figures).
"""

from itertools import pairwise

import numpy as np
import pytest
from boxes import box, floor, hour, quads
from light_transport.giving_up import unless
from light_transport.transport import SceneTransport

from vrut_lite.errors import GivenUp
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance, irradiance_coefficients


def baked(scene, rays=64):
    transport = SceneTransport(*scene)
    transport.add_rays(rays)
    return transport


def _off(found, expected):
    """How far light is from what it should be, for people."""
    off = found / expected - 1.0
    return f"{off.mean():+.2%} in the mean, {np.abs(off).max():.2%} at most"


def on_quad(light, number, texels=8):
    """RGB and openness (texels, texels, 4) of a quad's texels."""
    return light.texels[number * (texels + 2) : number * (texels + 2) + texels]


@pytest.mark.parametrize("albedo", [0.5, 0.9])
def test_a_closed_box_that_glows_is_a_furnace(albedo):
    """Each wall sends M and what it reflects: E = M / (1 - albedo), by all bounces."""
    room = quads(*box((0, 0, 0), (2, 1, 3), inwards=True), reflectance=albedo, emitted=np.pi)
    light = baked(room).light(hour())
    found = np.stack([on_quad(light, side) for side in range(6)])
    print(f"\nglowing box, albedo {albedo}: {_off(found[..., :3], np.pi / (1.0 - albedo))}")
    np.testing.assert_allclose(found[..., :3], np.pi / (1.0 - albedo), rtol=5e-3)
    assert (found[..., 3] == 0.0).all()


def test_a_white_box_in_a_white_furnace_disappears():
    """Under a sky and ground of radiance L a white body gets pi L everywhere, and sends it on."""
    light = baked(quads(*box((0, 0, 0), (1, 2, 1)), reflectance=1.0)).light(hour(2.0))
    found = np.stack([on_quad(light, side) for side in range(6)])
    print(f"\nwhite box under a white sky: {_off(found[..., :3], 2.0 * np.pi)}")
    np.testing.assert_allclose(found[..., :3], 2.0 * np.pi, rtol=2e-3)
    np.testing.assert_allclose(found[..., 3], 1.0, atol=1e-2)


def test_an_open_plane_gets_pi_times_the_radiance_of_a_uniform_sky():
    """Nothing hides anything: irradiance is pi L, and the openness 1."""
    light = baked(quads(floor(0, 1, 0, 1))).light(hour(3.0, ground=0.0))
    np.testing.assert_allclose(on_quad(light, 0)[..., :3], 3.0 * np.pi, rtol=1e-5)
    np.testing.assert_allclose(on_quad(light, 0)[..., 3], 1.0, atol=2e-2)


def test_a_sky_that_varies_gives_the_irradiance_of_its_harmonics():
    """A smooth sky on an open plane: the same number by two ways."""
    up = np.maximum(texel_directions(32)[..., 1:2], 0.0)
    cube = np.repeat(1.0 + 2.0 * up, 3, axis=-1).astype(np.float32)
    light = baked(quads(floor(0, 1, 0, 1)), 256).light(hour(cube=cube, ground=0.0))
    expected = np.pi * (1.0 + 4.0 / 3.0)
    assert on_quad(light, 0)[..., 0].mean() == pytest.approx(expected, rel=3e-3)


def test_a_bend_keeps_its_own_light_where_noise_is_smoothed():
    """Eight strips round an arch under light from one side: each gets its harmonics', to 3 %.

    Smoothed as they are, neighbours turned by 20 degrees would share their light.
    """
    d = texel_directions(32)
    from_east = np.where(d[..., 1:2] > 0.0, np.maximum(d[..., :1], 0.0) ** 2, 0.0)
    cube = (from_east + 0.05) * np.ones(3)
    surfaces, layout = arch(strips=8, texels=4)
    light = baked((surfaces, layout), 1024).light(hour(cube=cube.astype(np.float32), ground=0.05))
    normals = surfaces.face_normals()[::2]
    expected = evaluate_irradiance(irradiance_coefficients(cube), normals)[:, 0]
    found = light.texels[:, :, 0].reshape(8, 4, 4).mean(axis=(1, 2))
    np.testing.assert_allclose(found, expected, rtol=0.03)


def arch(strips, texels):
    """Strips from west over the top to east, one chart, each with a flat normal."""
    turn = np.radians(np.linspace(170.0, 10.0, strips + 1))
    edge = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    corners = [
        [[a[0], a[1], 0.0], [a[0], a[1], 0.5], [b[0], b[1], 0.5], [b[0], b[1], 0.0]]
        for a, b in pairwise(edge)
    ]
    surfaces, layout = quads(*corners, texels=texels, reflectance=0.0)
    surfaces.part[:] = 0
    # One strip below the other, without the gaps that keep charts apart.
    gaps = np.repeat(np.arange(strips), 2)[:, None] * 2.0
    layout.uv_px[..., 1] -= gaps
    layout.owner = layout.owner[layout.owner[:, 0] >= 0]
    return surfaces, layout


def test_a_lamp_over_a_floor_gives_the_known_form_factor():
    """Parallel squares of edge a at distance a exchange 0.19982 of what one sends (Howell C-11)."""
    lamp = np.array(floor(0, 1, 0, 1, y=1.0))[::-1]
    scene = quads(floor(0, 1, 0, 1), lamp, reflectance=0.0, texels=24)
    scene[0].emitted_rgb[2:] = 10.0
    light = baked(scene, 256).light(hour())
    assert on_quad(light, 0, 24)[..., 0].mean() == pytest.approx(1.9982, rel=5e-3)


@pytest.mark.parametrize("albedo", [0.5, 0.9])
def test_what_is_sent_is_absorbed(albedo):
    """One wall of a shut room glows; all walls together absorb its power, at any albedo."""
    room = quads(*box((0, 0, 0), (2, 1, 3), inwards=True), reflectance=albedo, texels=16)
    room[0].emitted_rgb[:2] = 7.0
    light = baked(room, 128).light(hour())
    areas = (3.0, 3.0, 6.0, 6.0, 2.0, 2.0)
    arrived = sum(area * on_quad(light, side, 16)[..., 0].mean() for side, area in enumerate(areas))
    absorbed = (1.0 - albedo) * arrived
    print(f"\nabsorbed of what is sent, albedo {albedo}: {absorbed / (7.0 * areas[0]) - 1.0:+.2%}")
    assert absorbed == pytest.approx(7.0 * areas[0], rel=5e-3)


def test_light_is_linear_in_sky_and_key_light():
    """The light of both together is that of the one and of the other."""
    transport = baked(quads(*box((0, 0, 0), (1, 1, 1)), floor(-2, 3, -2, 3), reflectance=0.6))
    sky, sun = (
        transport.light(hour(2.0)),
        transport.light(hour(irradiance=50.0, key=(0.5, 0.6, 0.3))),
    )
    both = transport.light(hour(2.0, irradiance=50.0, key=(0.5, 0.6, 0.3)))
    np.testing.assert_allclose(
        both.texels[..., :3], sky.texels[..., :3] + sun.texels[..., :3], rtol=3e-3, atol=1e-3
    )


def test_the_key_light_comes_by_its_bounces_alone():
    """A wall beside a sunlit floor gets light of it; an open floor, which sees nothing, none."""
    wall = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
    scene = quads(floor(0, 2, 0, 2), wall, reflectance=0.5)
    light = baked(scene, 256).light(hour(irradiance=100.0, ground=0.0))
    assert 0.0 < on_quad(light, 0)[..., 0].mean() < 3.0
    # Perpendicular squares with a common edge exchange 0.20004 of what one sends (Howell C-14).
    assert on_quad(light, 1)[..., 0].mean() == pytest.approx(0.5 * 100.0 * 0.20004, rel=0.03)


def test_a_wall_of_two_texels_lets_no_light_into_a_dark_room():
    """One floor reaches from the sun below the walls into a shut room: nothing gets there."""
    texels, room = 32, 2.0
    thick = 2.0 * 8.0 / texels
    inner = box((-room / 2, 0.0, -room / 2), (room / 2, room, room / 2), inwards=True)
    outer = box(
        (-room / 2 - thick, -0.01, -room / 2 - thick),
        (room / 2 + thick, room + thick, room / 2 + thick),
    )
    ground = floor(-4.13, 3.87, -4.02, 3.98)
    # Without the inner box's own floor, which would lie in the ground's plane.
    quads_of_room = [*outer, *(side for k, side in enumerate(inner) if k != 3)]
    scene = quads(ground, *quads_of_room, texels=texels, reflectance=0.8)
    transport = baked(scene, 128)
    light = transport.light(hour(5.0, irradiance=100.0, key=(0.4, 0.7, 0.2)))
    found = on_quad(light, 0, texels)[..., :3]
    place = transport.texels.place * scene[0].radius_m + scene[0].centre_m
    on_floor = transport.texels.triangle < 2
    inside = (np.abs(place[:, [0, 2]]) < room / 2).all(axis=1) & on_floor
    column, row = transport.texels.pixel[inside].T
    outdoors = np.median(found)
    assert inside.sum() > 30
    assert found[row, column].max() < 1e-3 * outdoors
    walls = [on_quad(light, number, texels)[..., :3].max() for number in range(7, 12)]
    brightest = max(found[row, column].max(), *walls) / outdoors
    print(f"\nbehind a wall of two texels: at most {brightest:.1e} of the light outdoors")
    assert max(walls) < 1e-3 * outdoors


def test_a_sheet_full_of_holes_lets_their_share_through():
    """A canopy that is a quarter open: the floor below gets a quarter of the sky behind it."""
    canopy = np.array(floor(-50, 51, -50, 51, y=0.1))[::-1]
    scene = quads(floor(0, 1, 0, 1), canopy, reflectance=0.0)
    scene[0].opacity[2:] = 0.75
    light = baked(scene, 512).light(hour(1.0, ground=0.0))
    assert on_quad(light, 0)[..., 0].mean() == pytest.approx(0.25 * np.pi, rel=0.03)


def test_a_plinth_without_a_back_casts_no_darkness_up_the_wall_that_it_leans_on():
    """The wall behind it is out of sight: what a look-up mixes in above it is the wall's own. The
    black top, 6 cm wide, takes (1 - h / sqrt(h^2 + 0.06^2)) / 2 of the light h above it, 16 % in
    the mean of the half texel there, where look-ups are between two texels."""
    texels, edge = 16, 4.0
    wall = [[0, 0, 0], [edge, 0, 0], [edge, edge, 0], [0, edge, 0]]
    # It reaches 6 cm out of the wall and up to the middle of a texel.
    plinth = [side for k, side in enumerate(box((-1, -1, -0.1), (5, 1.6, 0.06))) if k != 5]
    scene = quads(wall, *plinth, texels=texels, reflectance=0.0, double_sided=True)
    light = baked(scene).light(hour(1.0))
    found = on_quad(light, 0, texels)[..., 0]
    first_free = int(np.ceil(1.6 / edge * texels)) - 1
    looked_up = 0.75 * found[first_free] + 0.25 * found[first_free + 1]
    np.testing.assert_allclose(looked_up, 0.84 * np.pi, rtol=0.1)
    np.testing.assert_allclose(found[first_free + 1 :], np.pi, rtol=0.1)


@pytest.mark.parametrize("double_sided", [True, False])
def test_a_body_is_dark_inside_however_it_is_marked(double_sided):
    """Rays that begin inside a box end at its back and do not count, whatever the file says."""
    body = box((0, -0.5, 0), (1, 0.5, 1))
    scene = quads(*body, floor(-2, 3, -2, 3), texels=24, double_sided=double_sided)
    transport = baked(scene)
    place = transport.texels.place * scene[0].radius_m + scene[0].centre_m
    on_floor = transport.texels.triangle >= 12
    deep = on_floor & (np.abs(place[:, [0, 2]] - 0.5) < 0.3).all(axis=1)
    assert deep.any()
    assert (transport.table.valid[: len(place)][deep] == 0).all()
    # They show the light of the nearest place outside.
    assert (transport.light(hour(1.0)).texels[..., 0][transport.texels.row_of >= 0] > 0.1).all()


def test_rays_do_not_depend_on_rounds_or_threads():
    """64 rays at once by one thread and 24 and 40 by three: the same table, the same light."""
    scene = quads(*box((0, 0, 0), (1, 1, 1)), floor(-2, 3, -2, 3), texels=20)
    one, three = SceneTransport(*scene), SceneTransport(*scene, threads=3)
    one.add_rays(64)
    three.add_rays(64)
    now = hour(2.0, irradiance=50.0, key=(0.5, 0.6, 0.3))
    np.testing.assert_array_equal(one.light(now).texels, three.light(now).texels)
    rounds = SceneTransport(*scene)
    rounds.add_rays(24)
    rounds.add_rays(40)
    np.testing.assert_array_equal(rounds.table.valid, one.table.valid)


def test_a_cancelled_round_changes_nothing():
    """Who cancels keeps the light that was there."""
    transport = baked(quads(floor(0, 1, 0, 1)))
    before = transport.table
    with pytest.raises(GivenUp):
        transport.add_rays(64, unless(lambda: True))
    assert transport.table is before
    assert transport.rays == 64

"""Shadows of the key light while time plays: its bounces change without steps."""

import numpy as np
from boxes import box, floor, hour, quads
from light_transport.hour.key_light import FARTHEST, direction_of, directions_around
from light_transport.hour.relighting import key_shares
from light_transport.transport import SceneTransport


def test_any_direction_lies_between_three_fixed_ones_near_it():
    """Their weighted sum is the direction itself but for the lattice's bend, on the horizon too."""
    random = np.random.default_rng(1)
    directions = random.normal(size=(3000, 3))
    directions[:, 1] = np.abs(directions[:, 1]) * (np.arange(3000) % 5 > 0)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for direction in directions:
        numbers, weights = directions_around(tuple(direction))
        around = np.array([direction_of(number) for number in numbers])
        assert weights.min() >= 0.0
        assert np.linalg.norm(np.cross(around, direction), axis=1).max() < FARTHEST
        np.testing.assert_allclose(np.linalg.norm(around, axis=1), 1.0)
        np.testing.assert_allclose(weights.sum(), 1.0)
        np.testing.assert_allclose(weights @ around, direction, atol=0.015)
        assert around[:, 1].min() >= 0.0


def test_weights_do_not_jump_where_triangles_meet():
    """A hundredth of a degree along a path over the sky changes no weight by more than 3 %."""
    turns = np.radians(np.arange(0.0, 40.0, 0.01))
    last: dict[int, float] = {}
    for turn in turns:
        direction = np.array([np.cos(turn) * 0.8, 0.25 + 0.3 * np.sin(turn), 0.6 * np.sin(turn)])
        numbers, weights = directions_around(tuple(direction / np.linalg.norm(direction)))
        now = dict(zip(numbers, weights, strict=True))
        if last:
            assert max(abs(now.get(n, 0.0) - last.get(n, 0.0)) for n in {*now, *last}) < 0.03
        last = now


def test_light_does_not_step_while_a_shadow_passes_small_patches():
    """Below a roof the sun reaches one wide texel of the floor after the other, each with one ray.

    The roof's underside sees little else: in a quarter of a degree its light changes by less than a
    quarter of all that it changes. Rays towards the sun itself bring nine tenths at once.
    """
    roof = box((-1.0, 0.5, -1.0), (0.0, 0.6, 1.0))
    transport = SceneTransport(*quads(floor(-1, 1, -1, 1), *roof, texels=2), patch_texels=1.0)
    transport.add_rays(256)
    below = transport.texels.normal[:, 1] < -0.5
    row, column = transport.texels.pixel[below][:, ::-1].T
    seen = []
    for turn in np.radians(np.arange(40.0, 70.0, 0.25)):
        now = hour(key=(np.sin(turn), np.cos(turn), 0.0), irradiance=100.0)
        seen.append(transport.light(now).texels[row, column, 1].astype(float))
    steps = np.abs(np.diff(seen, axis=0)).max(axis=0)
    changes = np.ptp(seen, axis=0)
    assert changes.max() > 5.0
    assert (steps < changes.max() / 4.0).all()


def test_kept_shadows_change_no_light():
    """An hour after others, to which the clock came back, has the light, to the bit, that it has
    alone."""
    scene = quads(floor(-2, 2, -2, 2), *box((-0.5, 0, -0.5), (0.5, 1, 0.5)))
    transport, fresh = SceneTransport(*scene), SceneTransport(*scene)
    transport.add_rays(64)
    fresh.add_rays(64)
    forth = np.arange(10.0, 16.0, 0.5)
    for turn in np.radians([*forth, 30.0, *forth[::-1], 10.5]):
        now = hour(1.0, key=(np.sin(turn), np.cos(turn), 0.3), irradiance=50.0)
        light = transport.light(now).texels
    np.testing.assert_array_equal(light, fresh.light(now).texels)


def test_grazing_light_is_not_lost_at_the_surface_itself():
    """Some of the fixed directions around a sun on the horizon lie behind a wall that it grazes."""
    wall = [[0, 0, 1], [0, 0, -1], [0, 2, -1], [0, 2, 1]]
    transport = SceneTransport(*quads(floor(-1, 1, -1, 1, y=-0.5), wall))
    transport.add_rays(64)
    for x, y in ((0.02, 0.5), (0.5, 0.02)):
        now = hour(key=(x, y, 0.3), irradiance=1.0)
        direction = np.asarray(now.key_direction)
        share = key_shares(transport, transport.cache, now)
        asked = transport.cache.key_shadows.rays.ray < 8
        cosine = transport.receivers.geometry.faces[transport.texels.triangle] @ direction
        facing = asked & (cosine > 0.0)
        # The wall hides some of the floor.
        facing &= transport.texels.normal[:, 1] < 0.5
        assert facing.any()
        np.testing.assert_allclose(share[facing], cosine[facing], rtol=1e-4)

"""Glossy parts show the cube map of what stands around them; the sky has radiance 1."""

import msgspec
import numpy as np
import pytest
from light_map_stage import even, laid, lit
from scene_stage import light, look, square, surface
from stateful_backend import opened

from vrut_lite.array import Array
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.light_map import ReflectionProbes

pytestmark = pytest.mark.gl
SIZE, EDGE = 48, 64
ABOVE = ((0.0, 1.0, 1e-3), (0.0, 0.0, 0.0), 2 * np.arctan(0.4))
SLOPE = 0.4 * ((np.arange(SIZE) + 0.5) / SIZE * 2.0 - 1.0)
# Walls, floor and ceiling of the room that a mirror in its middle sees are so far away.
HALF_M = 2.0
MIRROR, EVEN_LIGHT = surface(1.0, 0.0), (1.5 * np.pi, 0.5)


@pytest.fixture
def backend(shared_gl_backend):
    backend = shared_gl_backend(size_px=(SIZE, SIZE), ground_albedo_rgb=(0.5,) * 3)
    light(backend, np.ones((6, 16, 16, 3)))
    return backend


def show(backend, path, cube, part=0, corners=((1, 2),), scale=1.0, room_m=(HALF_M,) * 3):
    """A scene whose part mirrors a cube (6, EDGE, EDGE, 4), or None, with the room's distances."""
    scene = opened(path)
    layout = laid(scene, corners)
    changed = lit(layout, even(layout, *EVEN_LIGHT), scale=scale)
    if cube is not None:
        nearness = (np.abs(texel_directions(EDGE)) / room_m).max(axis=-1)
        mirrors = ReflectionProbes(
            part=Array(np.array([part], np.int32)),
            centre_m=Array(np.zeros((1, 3))),
            nearness=Array(nearness[None].astype(np.float32)),
        )
        layout = msgspec.structs.replace(layout, mirrors=mirrors)
        over = np.array([scale, scale, scale, 1.0])
        values = Array((cube / over)[None].astype(np.float16))
        changed = msgspec.structs.replace(changed, mirrors=values)
        for message in (layout, changed):
            message.check()
            message.check_arrays()
        assert changed.fits(layout)
    backend.change(scene=scene)
    backend.hear(layout, changed)
    return look(backend, *ABOVE).radiance


def one_value(radiance, alpha):
    return np.broadcast_to([radiance] * 3 + [alpha], (6, EDGE, EDGE, 4))


@pytest.mark.parametrize("scale", [1.0, 0.25])
def test_a_mirror_shows_its_cube_and_the_sky_where_that_sees_it(backend, tmp_path, scale):
    """Radiance 3 all around is seen as 3; half of it before a sky of 1 as 1.5 + 0.5 * 1."""
    path = square(tmp_path, MIRROR)
    for alpha, expected in ((1.0, 3.0), (0.5, 2.0), (0.0, 1.0)):
        found = show(backend, path, one_value(3.0 * alpha, alpha), scale=scale)
        np.testing.assert_allclose(found[SIZE // 2, SIZE // 2], expected, rtol=5e-3)


def test_the_image_moves_as_the_room_does(backend, tmp_path):
    """The ceiling is as bright as its place to the right: a ray from the mirror at x with slope s
    ends there at x + 2 s, not at 2 s as seen from the middle."""
    d = texel_directions(EDGE)
    at_x = d[..., 0] / np.abs(d).max(axis=-1) * HALF_M
    cube = np.concatenate(
        [np.repeat(3.0 + at_x[..., None], 3, axis=-1), np.ones((6, EDGE, EDGE, 1))], axis=-1
    )
    found = show(backend, square(tmp_path, MIRROR), cube)[SIZE // 2, :, 0]
    # The eye is 1 m above: x is the slope itself.
    np.testing.assert_allclose(found, 3.0 + SLOPE + HALF_M * SLOPE, rtol=0.01)


def test_the_image_is_right_also_far_from_the_middle_of_a_low_room(backend, tmp_path):
    """Below a ceiling at 0.2 m places at 0.4 m are seen as they are from there.

    Fixed-point steps towards the place swing about it and end up to 0.06 m beside it.
    """
    room_m = np.array([2.0, 0.2, 2.0])
    d = texel_directions(EDGE)
    at_x = (d / (np.abs(d) / room_m).max(axis=-1, keepdims=True))[..., 0]
    cube = np.concatenate(
        [np.repeat(3.0 + at_x[..., None], 3, axis=-1), np.ones((6, EDGE, EDGE, 1))], axis=-1
    )
    found = show(backend, square(tmp_path, MIRROR), cube, room_m=room_m)[SIZE // 2, :, 0]
    np.testing.assert_allclose(found, 3.0 + SLOPE + 0.2 * SLOPE, atol=0.02)


def test_rough_metal_shows_a_blurred_image_and_then_none(backend, tmp_path):
    """A fine pattern has its mean in a satin mirror; above roughness 0.6 all is as without."""
    pattern = np.indices((EDGE, EDGE)).sum(axis=0) % 2 * 2.0
    cube = np.stack(
        [*[np.broadcast_to(pattern, (6, EDGE, EDGE))] * 3, np.ones((6, EDGE, EDGE))], axis=-1
    )
    satin = show(backend, square(tmp_path, surface(1.0, 0.3)), cube)
    np.testing.assert_allclose(satin[SIZE // 4 : -SIZE // 4, SIZE // 2], 1.0, rtol=0.02)
    path = square(tmp_path, surface(1.0, 0.7))
    # To rounding: the two are programs of their own.
    np.testing.assert_allclose(show(backend, path, cube), show(backend, path, None), rtol=1e-6)


def test_what_mirrors_nothing_is_the_same_to_the_bit(backend, tmp_path):
    """The neighbour of a mirror, and all where no part mirrors; frames count how many do."""
    nodes = [{"mesh": 0, "translation": [x, 0, 0]} for x in (-0.5, 0.5)]
    path, corners = square(tmp_path, MIRROR, nodes=nodes), ((1, 2), (11, 3))
    before = dict(backend.counters.done)
    without = show(backend, path, None, corners=corners)
    assert backend.counters.done.get("mirror", 0) == before.get("mirror", 0)
    assert backend.counters.skipped["mirror: none in view"] > 0
    beside = show(backend, path, one_value(3.0, 1.0), part=1, corners=corners)
    assert backend.counters.done["mirror"] == before.get("mirror", 0) + 1
    np.testing.assert_array_equal(beside[:, : SIZE // 2 - 1], without[:, : SIZE // 2 - 1])
    np.testing.assert_allclose(beside[:, SIZE // 2 + 2 :], 3.0, rtol=0.01)
    np.testing.assert_array_equal(show(backend, path, None, corners=corners), without)

"""Pictures drawn piece by piece: the same pixels, and an end as soon as nobody waits."""

from itertools import count

import numpy as np
import pytest
import trimesh
from cloud_stage import clouded, rough_layer
from scene_stage import light, look
from stateful_backend import opened

from vrut_lite.errors import GivenUp
from vrut_lite.messages.ground_disc import GroundDisc

pytestmark = pytest.mark.gl
SKY = np.linspace(9.0, 1.0, 16)[None, :, None, None] * np.ones((6, 1, 16, 3))
EYE = (6.0, 3.0, 8.0)


@pytest.fixture
def backend(gl_backend, tmp_path):
    """Glossy spheres, one of them of glass, under clouds, 140 x 140 pixels: several pieces."""
    scene = trimesh.Scene()
    for place, alpha in (((0, 1, 0), 255), ((1.5, 2, 3), 255), ((3, 1.5, 4), 120)):
        sphere = trimesh.creation.icosphere(3, 1.0).apply_translation(place)
        sphere.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(
                baseColorFactor=[200, 120, 60, alpha],
                alphaMode="OPAQUE" if alpha == 255 else "BLEND",
                metallicFactor=0.5,
                roughnessFactor=0.3,
            )
        )
        scene.add_geometry(sphere)
    path = tmp_path / "spheres.glb"
    scene.export(path)
    scene = opened(path, GroundDisc((0, 0), 0, 600))
    backend = gl_backend(size_px=(140, 140), scene=scene, **clouded(rough_layer()))
    light(backend, SKY, sun_direction=(0.6, 0.8, 0.0), sun_irradiance=(90.0, 80.0, 70.0))
    look(backend, EYE, (1.5, 3.5, 2.0))
    return backend


def test_pieces_make_the_same_picture_bit_for_bit(backend):
    """Whoever may give a picture up, and does not, gets the picture of one piece."""
    whole = backend.draw()
    asked = count()
    pieced = backend.draw(is_given_up=lambda: next(asked) < 0)
    # For meshes, clouds and glass: a piece is no larger than twice the last.
    assert next(asked) >= 6
    assert np.array_equal(whole.radiance, pieced.radiance)
    assert np.array_equal(whole.display, pieced.display)
    assert np.unique(whole.display.reshape(-1, 3), axis=0).shape[0] > 1000


@pytest.mark.long
def test_a_picture_that_is_given_up_leaves_the_next_as_it_would_have_been(backend):
    """Before its first pixel, and within passes: each is counted."""
    whole = backend.draw()
    for times, after in enumerate((0, 2, 5), 1):
        assert given_up(backend, after)
        assert backend.counters.skipped["picture: given up"] == times
    assert np.array_equal(backend.draw().display, whole.display)


@pytest.mark.long
def test_a_picture_ends_wherever_it_is_given_up(backend):
    """Before its first pixel, in the middle of each pass, and before its last."""
    whole = backend.draw()
    times = 0
    while given_up(backend, times):
        times += 1
    # Before and after the passes, and within them.
    assert times > 4
    assert backend.counters.skipped["picture: given up"] == times
    assert np.array_equal(backend.draw().display, whole.display)


def test_a_moving_picture_shows_everything_wherever_a_still_was_given_up(backend):
    """A still given up among clouds left the next ones at one depth: a sky without a scene."""
    whole = backend.draw(still=False).radiance
    times = 0
    while given_up(backend, times):
        moving = backend.draw(still=False).radiance
        assert np.abs(moving - whole).mean() < 0.01 * whole.mean(), times
        times += 1
    assert times > 4


def given_up(backend, after):
    """Whether a picture was, that was to be when it was asked for the so-manieth time."""
    asked = count()
    try:
        backend.draw(is_given_up=lambda: next(asked) == after)
    except GivenUp:
        return True
    return False


@pytest.mark.parametrize(
    ("asked", "drawn", "placed_s", "shaded_s", "expected"),
    [
        (10, 10.0, 0.0, 0.001, 20),  # quick: twice as large, no more
        (10, 1.5, 0.0, 0.001, 20),  # at the picture's edge: as quick
        (20, 20.0, 0.0, 0.5, 6),  # 25 ms a tile: six in 0.15 s
        (20, 5.0, 0.0, 0.125, 6),  # the same at the edge
        (20, 20.0, 0.0, 40.0, 2),  # never fewer than two
        (20, 20.0, 0.1, 0.2, 10),  # 50 ms are left, but placing takes 100: as long for pixels
    ],
)
def test_a_piece_takes_a_sixth_of_a_second(asked, drawn, placed_s, shaded_s, expected):
    """The last one's time decides; placing triangles never takes longer than shading."""
    from vrut_lite.render.tiles import next_tiles

    assert next_tiles(asked, drawn, placed_s, shaded_s) == expected


@pytest.mark.parametrize("size", [(960, 540), (1024, 576), (1367, 769), (2561, 1441)])
def test_what_is_quick_is_soon_one_piece(size):
    """What the edge leaves of a piece must not make the next ones small, whatever the size."""
    from vrut_lite.render.tiles import next_tiles, piece_at

    tiles, counts = 2, []
    for _ in range(3):
        left = lower = number = 0
        while lower < size[1]:
            piece = piece_at(left, lower, size, tiles)
            tiles = next_tiles(tiles, piece.tiles, 0.0, 1e-5 * piece.tiles)
            left = piece.right % size[0]
            lower = lower if left else piece.upper
            number += 1
        counts.append(number)
    assert counts[0] < 40
    assert counts[-1] == 1


@pytest.mark.parametrize("tiles", [1, 4, 9, 10, 25, 1000])
def test_pieces_cover_every_pixel_once(tiles):
    """The picture's sides are no multiples of a tile's."""
    from vrut_lite.render.tiles import piece_at

    size = (150, 333)
    drawn = np.zeros(size[::-1], int)
    left = lower = 0
    while lower < size[1]:
        piece = piece_at(left, lower, size, tiles)
        drawn[piece.lower : piece.upper, piece.left : piece.right] += 1
        left = piece.right % size[0]
        lower = lower if left else piece.upper
    assert (drawn == 1).all()

"""Pictures of a headset's eyes: each is what a camera there shows, and both share one light."""

from dataclasses import replace

import numpy as np
import pytest
from box_stage import show_box, sun_at, uniform_sky
from house_fixtures import CARD_NS
from scene_stage import light, look
from stateful_backend import StatefulBackend

from vrut_lite.messages.camera import look_at
from vrut_lite.messages.picture import SetExposure
from vrut_lite.render.eye_pictures import HeadsetEye
from vrut_lite.render.unlocked import read_bytes

pytestmark = pytest.mark.gl
SUN = {"sun_direction": sun_at(35.0, 40.0), "sun_irradiance": (10.0, 9.0, 8.0)}
EYE, TARGET = np.array([4.0, 3.0, 6.0]), np.array([0.0, 1.0, 0.0])
SIZE = (160, 120)
# The picture with an angle of 0.6 rad from top to bottom.
HIGH = np.tan(0.3)
WIDE = HIGH * SIZE[0] / SIZE[1]
MIDDLE = (-WIDE, WIDE, -HIGH, HIGH)


@pytest.fixture(scope="module")
def card_owner():
    from vrut_lite.render.gl_owner import GlOwner

    owner = GlOwner(CARD_NS)
    yield owner
    owner.close()


@pytest.fixture
def card(card_owner, box_file):
    """A box in sun and even skylight, drawn as a card does, with one exposure."""
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(card_owner)
    stage = StatefulBackend(backend, size_px=SIZE)
    show_box(stage, box_file)
    light(stage, uniform_sky(1.0), **SUN)
    stage.change(exposure=SetExposure(mode="manual", ev100=10.0))
    look(stage, EYE, TARGET, still=False)
    yield stage
    backend.close()


def eye_at(place, tangents=MIDDLE, size_px=SIZE):
    """An eye that looks as the camera does; `seen` gives it a texture."""
    rotation = look_at(np.zeros(3), TARGET - EYE)[:3, :3].T
    return HeadsetEye(np.array(place), rotation, tangents, size_px, texture=0)


def seen(stage, owner, *eyes, **parts):
    """The displayed bytes (h, w, 3) of each eye, and what the frame says of both."""

    def draw(context):
        textures = [context.texture(eye.size_px, 4) for eye in eyes]
        views = [eye._replace(texture=own.glo) for eye, own in zip(eyes, textures, strict=True)]
        drawn = stage.backend.draw_eyes(replace(stage.state, **parts), views)
        pictures = [read_bytes(texture)[::-1, :, :3].copy() for texture in textures]
        for texture in textures:
            texture.release()
        return pictures, drawn

    return owner.call(draw)


def test_an_eye_sees_what_a_camera_at_its_place_shows(card, card_owner):
    """The very bytes of the moving picture: passes, samples and tone map are the same."""
    window = look(card, EYE, TARGET, still=False).display
    (picture,), _ = seen(card, card_owner, eye_at(EYE))
    assert np.ptp(window) > 40
    np.testing.assert_array_equal(picture, window)


def test_an_eye_without_symmetry_sees_a_part_of_a_wider_picture(card, card_owner):
    """As headsets' eyes, which see farther outwards: columns 40 to 119 and rows 24 to 95 of the
    symmetric picture, whose edges are tangents of the same pixels."""
    columns, rows = slice(40, 120), slice(24, 96)
    across, down = 2.0 * WIDE / SIZE[0], 2.0 * HIGH / SIZE[1]
    tangents = (
        -WIDE + columns.start * across,
        -WIDE + columns.stop * across,
        HIGH - rows.stop * down,
        HIGH - rows.start * down,
    )
    (whole,), _ = seen(card, card_owner, eye_at(EYE))
    (part,), _ = seen(card, card_owner, eye_at(EYE, tangents, (80, 72)))
    apart = np.abs(part.astype(int) - whole[rows, columns])
    assert np.ptp(part) > 40
    # Dither is another in another pixel; samples on edges move by the rounding of floats.
    assert np.median(apart) <= 1
    assert (apart.max(axis=-1) > 2).mean() < 0.01


def test_two_eyes_share_one_light_and_one_upload(card, card_owner):
    """A second eye costs its own sky and surfaces: after the sun has moved the shadow map is drawn
    once, the sky filtered once, and each message uploaded once. Both pictures are those of one."""
    right = EYE + np.array([0.064, 0.0, 0.0])
    left, other = eye_at(EYE), eye_at(right)
    light(card, uniform_sky(1.1), **SUN | {"sun_direction": sun_at(80.0, 30.0)})
    counters = card.counters
    counters.done.clear()
    pictures, _ = seen(card, card_owner, left, other)
    done = dict(counters.done)
    assert (done["eye"], done["shadow map"], done["upload"]) == (2, 1, 2)
    for place, picture in zip((left, other), pictures, strict=True):
        (alone,), _ = seen(card, card_owner, place)
        np.testing.assert_array_equal(picture, alone)
    assert (pictures[0] != pictures[1]).mean() > 0.01


def test_the_first_eye_meters_for_both(card, card_owner):
    """Exposures of their own would make one eye darker: the second one, which sees the sky alone,
    is the picture that the exposure of both gives, and not the one that it would meter."""
    bright_above = uniform_sky(0.01)
    bright_above[2] = 0.16
    light(card, bright_above)
    sky = HeadsetEye(EYE, np.eye(3), (-0.1, 0.1, 2.0, 2.2), (32, 32), texture=0)
    (_, second), both = seen(card, card_owner, eye_at(EYE), sky, exposure=SetExposure())
    fixed = SetExposure(mode="manual", ev100=both.ev100)
    (expected,), _ = seen(card, card_owner, sky, exposure=fixed)
    _, alone = seen(card, card_owner, sky, exposure=SetExposure())
    np.testing.assert_array_equal(second, expected)
    assert abs(alone.ev100 - both.ev100) > 0.1


def test_a_frame_is_metered_by_the_one_before(card, card_owner):
    """Nothing waits for the card within a frame: the histogram under another sky comes with the
    second frame. The first frame of a scene is metered by itself."""
    first = seen(card, card_owner, eye_at(EYE), exposure=SetExposure())[1].counts
    light(card, uniform_sky(1.0 / 16.0))
    late, then = (
        seen(card, card_owner, eye_at(EYE), exposure=SetExposure())[1].counts for _ in "12"
    )
    assert first.sum() == SIZE[0] * SIZE[1]
    np.testing.assert_array_equal(late, first)
    assert np.flatnonzero(then).max() < np.flatnonzero(first).min()

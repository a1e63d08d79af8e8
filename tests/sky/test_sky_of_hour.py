"""The plain values of a sky's author: which moves count, and how values become messages."""

import math

import numpy as np
import pytest

from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.messages.sun import SunMoved
from vrut_lite.sky.sky_of_hour import Background, MotionThreshold, SkyInputs


def hour(elevation_rad, eye_height_m=0.0, disc=1.0, azimuth_rad=0.0):
    level = math.cos(elevation_rad)
    x, z = level * math.sin(azimuth_rad), -level * math.cos(azimuth_rad)
    sun = SunMoved(
        direction=(x, math.sin(elevation_rad), z),
        azimuth_rad=azimuth_rad,
        elevation_rad=elevation_rad,
        apparent_elevation_rad=elevation_rad,
        visible_disc_fraction=disc,
    )
    return SkyInputs(sun, 200.0, eye_height_m)


SHOWN = hour(0.3, 10.0)
UNSEEN = MotionThreshold(sun_rad=1e-3, eye_m=2.0)


@pytest.mark.parametrize(
    ("later", "sun_follows", "eye_follows"),
    [
        (hour(0.3005, 11.0), False, False),
        (hour(0.302, 11.0), True, False),
        (hour(0.3005, 13.0), False, True),
        (hour(0.3005, 7.0), False, True),
        (hour(0.3, 10.0, disc=0.9999), True, False),
    ],
)
def test_sun_and_eye_are_followed_each_by_its_own_step(later, sun_follows, eye_follows):
    """Half a step leaves sun or eye where they are shown, two steps move them, and so does any
    change of the disc's visible share."""
    seen = SHOWN.unless_unseen(later, UNSEEN)
    assert seen.sun == (later if sun_follows else SHOWN).sun
    assert seen.eye_height_m == (later if eye_follows else SHOWN).eye_height_m


def test_the_azimuth_is_the_worlds():
    """From -Z, clockwise seen from above."""
    assert hour(0.3, azimuth_rad=2.0).sun_azimuth_rad == pytest.approx(2.0)


def test_a_background_is_encoded_unless_it_is():
    """Float32 becomes float16 and a scale; float16 is unchanged."""
    ground = np.array([1.0, 2.0, 3.0])
    cube = np.random.default_rng(0).uniform(1.0, 1000.0, (6, 4, 4, 3)).astype(np.float32)
    message = Background(cube, ground).message("a_sky")
    shown = decode_float16(message.cube.values, message.radiance_scale)
    np.testing.assert_allclose(shown, cube, rtol=1e-3)
    assert (message.source, message.ground_radiance_rgb) == ("a_sky", (1.0, 2.0, 3.0))
    again = Background(message.cube.values, ground, message.radiance_scale).message("a_sky")
    assert again == message

"""A process's first sky, found on disk again."""

from itertools import count

import numpy as np
import pytest
from dynamic_skylight import cached_cubes
from dynamic_skylight.daylight import Daylight

NOON = {
    "turbidity": 3.0,
    "albedo": 0.2,
    "sun_colour": "disc",
    "sun_azimuth_rad": 1.0,
    "visible_disc_fraction": 1.0,
}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "vrut_lite" / "first_skies"


@pytest.fixture
def start(monkeypatch):
    """What a new process knows."""
    return lambda: monkeypatch.setattr(cached_cubes, "_asked", count())


def background(elevation_rad=0.8):
    return Daylight(apparent_elevation_rad=elevation_rad, **NOON).encoded_background(16)


def test_a_sky_that_is_kept_is_the_sky_that_was_made(start, monkeypatch):
    """To the last bit, and without its kernels."""
    start()
    made = background()
    start()
    monkeypatch.setattr("dynamic_skylight.hosek_wilkie.cube_rows._fill", None)
    kept = background()
    np.testing.assert_array_equal(made[0], kept[0])
    assert made[1] == kept[1]


def test_another_sky_is_another(start, folder):
    """By the sun's place, and by all else that it is made of."""
    start()
    first = background()
    start()
    assert not np.array_equal(first[0], background(0.81)[0])
    assert len(list(folder.iterdir())) == 4


def test_only_a_first_picture_asks(start, folder):
    """Those of a hand on the slider are not kept."""
    start()
    for step in range(4):
        background(0.5 + 0.01 * step)
    assert len(list(folder.iterdir())) == 3

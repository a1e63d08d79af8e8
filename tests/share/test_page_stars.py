"""Stars of a page, from sightings of a night sky that these tests make up."""

import math

import numpy as np
import pytest
from share.page_stars import Sighting, air_mass, fixed_stars, turn_rad, world_from_sky

from vrut_lite.atmosphere.refraction import refraction_of_true_rad

LATITUDE, OFFSET, PRESSURE_PA = 0.8, 0.4, 95_000.0
DEPTH = np.array([0.1, 0.2, 0.4])
MONTH_S = 2_629_800.0


def sky(count=400):
    random = np.random.default_rng(5)
    direction = random.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    light = 1e-9 * random.uniform(0.1, 10.0, (count, 1)) * random.uniform(0.5, 1.5, (count, 3))
    return direction, light


def sightings(direction, light, count=12, planet=True):
    """Stars as an eye sees them, and a planet that moves by ten degrees a month."""
    for month in range(count):
        seconds = 1.7e9 + month * MONTH_S
        all_of = direction
        if planet:
            angle = math.radians(10.0) * month
            moved = [[math.cos(angle), math.sin(angle), 0.3]] / np.sqrt(1.09)
            all_of = np.concatenate([moved, direction])
        shown = np.concatenate([np.full((1, 3), 1e-7), light]) if planet else light
        world = all_of @ world_from_sky(turn_rad(seconds - 1.7e9), LATITUDE, OFFSET).T
        true = np.arcsin(world[:, 1])
        up = true > 0.02
        apparent = true + refraction_of_true_rad(true, PRESSURE_PA)
        level = np.cos(apparent) / np.cos(true)
        seen = np.stack([world[:, 0] * level, np.sin(apparent), world[:, 2] * level], axis=1)
        left = shown * np.exp(-DEPTH * air_mass(np.maximum(apparent, 0.02))[:, None])
        yield Sighting(seconds, seen[up].astype(np.float32), left[up].astype(np.float32))


def test_stars_are_found_where_they_are_fixed_and_as_bright_as_above_the_air():
    """The air's depth comes out of the same stars at other heights; no planet stays."""
    direction, light = sky()
    found = fixed_stars(sightings(direction, light), LATITUDE, OFFSET, PRESSURE_PA)
    assert found.extinction == pytest.approx(DEPTH, rel=2e-3)
    apart = np.arccos(np.clip(found.direction @ direction.T, -1.0, 1.0))
    nearest = apart.argmin(axis=1)
    assert apart.min(axis=1).max() < 5e-4
    assert len(set(nearest)) == len(nearest)
    assert found.irradiance_rgb == pytest.approx(light[nearest], rel=5e-3)
    # All that rise higher than 20 degrees in two nights.
    rises = np.sin(LATITUDE) * direction[:, 2] + np.cos(LATITUDE) * np.hypot(*direction.T[:2])
    assert set(np.flatnonzero(rises > math.sin(math.radians(45.0)))) <= set(nearest)


@pytest.mark.parametrize("count", [0, 1])
def test_a_place_without_two_dark_nights_has_no_stars(count):
    direction, light = sky(20)
    found = sightings(direction, light, count)
    assert fixed_stars(found, LATITUDE, OFFSET, PRESSURE_PA) is None

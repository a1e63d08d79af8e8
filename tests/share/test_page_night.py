"""The Milky Way and the planets of a page, from nights that these tests make up."""

from datetime import UTC, datetime

import astronomy
import numpy as np
import pytest
from share.page_night import PLANETS, Glow, planet_light, split_glow
from share.page_stars import Sighting, air_mass, turn_rad, world_from_sky

from vrut_lite.sky.night_glow import map_directions

LATITUDE, OFFSET = 0.8, 0.4
DEPTH = np.array([0.1, 0.2, 0.3])
MONTH_S = 2_551_443.0


def test_what_turns_with_the_stars_is_told_from_what_stands_over_the_horizon():
    """A band across the sky, under a glow that grows towards the horizon: both come out, and their
    sum is each night's within 6 % of the mean, read at the nearest of coarse texels."""
    rows, columns = 20, 40
    world = map_directions(rows, columns)
    standing = (1.0 + 2.0 * (1.0 - world[..., 1:2]) ** 3) * [1.0, 0.9, 0.8]
    left = np.exp(-DEPTH * air_mass(np.arcsin(world[..., 1]))[..., None])
    pole = np.array([0.5, 0.3, 0.81])

    def above(sky):
        return np.exp(-((sky @ pole / 0.3) ** 2))[..., None] * [1.5, 1.4, 1.0]

    glows = []
    for month in range(12):
        seconds = 1.7e9 + month * MONTH_S
        sky = world @ world_from_sky(turn_rad(seconds - 1.7e9), LATITUDE, OFFSET)
        glows.append(Glow(seconds, standing + left * above(sky)))
    found = split_glow(glows, DEPTH, 1.7e9, LATITUDE, OFFSET)
    assert found.turning.shape == found.standing.shape == (rows, columns, 3)
    for glow in glows[::3]:
        matrix = world_from_sky(turn_rad(glow.seconds - 1.7e9), LATITUDE, OFFSET)
        sky = world @ matrix
        row = (np.arcsin(np.clip(sky[..., 2], -1.0, 1.0)) / np.pi + 0.5) * rows
        column = np.mod(np.arctan2(sky[..., 1], sky[..., 0]) / (2.0 * np.pi), 1.0) * columns
        nearest = np.minimum(row.astype(int), rows - 1), column.astype(int) % columns
        seen = found.standing + left * found.turning[nearest]
        off = np.sqrt(np.mean((seen - glow.radiance_rgb) ** 2)) / glow.radiance_rgb.mean()
        assert off < 0.06
        # The standing part alone is another sky.
        assert np.std(found.standing - glow.radiance_rgb) / glow.radiance_rgb.mean() > 0.15
    north = (np.arange(rows) + 0.5) / rows * np.pi - 0.5 * np.pi
    east = (np.arange(columns) + 0.5) / columns * 2.0 * np.pi
    level = np.cos(north)[:, None]
    up = np.broadcast_to(np.sin(north)[:, None], (rows, columns))
    sky = np.stack([level * np.cos(east), level * np.sin(east), up], axis=-1)
    high = sky[..., 2] > -0.4
    assert np.corrcoef(found.turning[high, 1], above(sky)[high, 1])[0, 1] > 0.85


def test_a_planets_light_at_magnitude_0_comes_from_where_it_stands():
    """Jupiter among stars, dimmed by the air; those that nobody saw have its colour."""
    place = 50.0, 14.0, 200.0
    observer = astronomy.Observer(*place)
    colour = np.array([3.0e-8, 2.5e-8, 2.0e-8])
    sightings = []
    for month in range(12):
        instant = datetime(2026, month + 1, 10, 23, tzinfo=UTC)
        time = astronomy.Time.Make(2026, month + 1, 10, 23, 0, 0.0)
        seen = astronomy.Equator(astronomy.Body.Jupiter, time, observer, True, True)
        level = astronomy.Horizon(time, observer, seen.ra, seen.dec, astronomy.Refraction.Normal)
        height, turn = np.radians([level.altitude, level.azimuth]) - [0.0, OFFSET]
        d = [np.cos(height) * np.sin(turn), np.sin(height), -np.cos(height) * np.cos(turn)]
        bright = 10.0 ** (-0.4 * astronomy.Illumination(astronomy.Body.Jupiter, time).mag)
        through = np.exp(-DEPTH * air_mass(np.array(max(height, 0.05))))
        stars = np.array([[0.0, 1.0, 0.0], d])
        light = np.array([[1e-9, 1e-9, 1e-9], colour * bright * through])
        sightings.append(Sighting(instant.timestamp(), stars, light))
    found = planet_light(sightings, DEPTH, place, OFFSET)
    assert found.shape == (len(PLANETS), 3)
    assert found == pytest.approx(np.tile(colour, (len(PLANETS), 1)), rel=1e-3)
    assert planet_light(sightings[:0], DEPTH, place, OFFSET) is None

"""Places of the sun for which light is computed, and interpolation between them."""

import numpy as np
import pytest
from share.sun_places import DUSK_RAD, SunPlaces, equatorial, horizontal

PRAGUE = float(np.radians(50.0))


@pytest.fixture(scope="module")
def places():
    return SunPlaces(PRAGUE, 0.3)


def test_equatorial_and_horizontal_angles_are_each_others_inverse():
    random = np.random.default_rng(2)
    for latitude in (-0.9, 0.0, PRAGUE, 1.4):
        declination, hour = random.uniform(-0.5, 0.5), random.uniform(-3.0, 3.0)
        elevation, azimuth = horizontal(declination, hour, latitude)
        found = equatorial(float(elevation), float(azimuth), latitude)
        assert found == pytest.approx((declination, hour), abs=1e-12)


def test_the_sun_culminates_in_the_south_at_the_right_height():
    """At an hour angle of zero its height is 90 degrees less latitude, plus declination."""
    elevation, azimuth = horizontal(0.2, 0.0, PRAGUE)
    assert elevation == pytest.approx(0.5 * np.pi - PRAGUE + 0.2)
    assert abs(azimuth) == pytest.approx(np.pi)


def test_places_of_day_and_dusk_are_not_mixed(places):
    """No sunlit wall lights a street after sunset, and none is missing by day."""
    by_dusk = [place for place, _ in places.weights(np.radians(-3.0), 5.0)]
    by_day = [place for place, _ in places.weights(np.radians(3.0), 1.2)]
    assert min(by_dusk) >= places.first_of_dusk > max(by_day)
    assert places.heights[by_dusk].max() < 0.0 < places.heights[by_day].min()


@pytest.mark.parametrize(
    ("height", "azimuth"), [(50, 180), (20, 100), (61, 200), (2.5, 305), (-5, 300), (-15, 10)]
)
def test_interpolation_keeps_smooth_light(places, height, azimuth):
    """To 1 % of a light that changes as the cosine of a wall that faces the sun."""
    wall = np.array([0.6, 0.8])

    def light(elevation, turn):
        towards = np.stack([np.sin(turn), np.cos(turn)])
        return 2.0 + np.cos(elevation) * (wall @ towards)

    nodes = light(places.heights, places.azimuths + places.north_offset_rad)
    elevation, turn = np.radians(height), np.radians(azimuth)
    weights = places.weights(elevation, turn)
    assert sum(weight for _, weight in weights) == pytest.approx(1.0)
    found = sum(weight * nodes[place] for place, weight in weights)
    assert found == pytest.approx(light(elevation, turn), rel=0.01)


def test_below_the_last_dusk_the_last_light_is_held(places):
    """The level fades it out."""
    found = dict(places.weights(DUSK_RAD[0] - 0.3, 1.0))
    assert found == pytest.approx(dict(places.weights(DUSK_RAD[0], 1.0)))


def test_a_place_whose_sun_never_rises_or_sets_has_places():
    for latitude in (-90.0, 90.0, 0.0):
        places = SunPlaces(float(np.radians(latitude)), 0.0)
        assert len(places.heights) == len(places.azimuths) > places.first_of_dusk
        assert np.all(np.isfinite(places.heights))

"""Eclipses of the sun, moonrise and moonset at random places and dates, by astronomy-engine."""

from datetime import UTC, datetime, timedelta
from itertools import pairwise

import astronomy
import numpy as np
from hypothesis import Phase, example, given, settings
from hypothesis import strategies as st
from night_sky.events import next_rise_and_set, next_solar_eclipse
from night_sky.path import moon_path
from night_sky.sky_axes import watch

from vrut_lite.messages.place import SetPlace

J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
DAY = timedelta(days=1)
SUN_RADIUS_KM, MOON_RADIUS_KM = 696_000.0, 1737.4
# Refraction on the horizon (deg) of almanacs; ours is that of 10 deg C, 0.6' more.
REFRACTION_DEG = 34.0 / 60.0
OUR_REFRACTION_DEG = 34.6 / 60.0
# Hidden shares of the sun between which an eclipse may count or not.
SURELY_NONE, SURELY_SEEN = 5e-4, 2e-3
ACROSS = np.linspace(-1.0, 1.0, 4001)

# A smaller case takes minutes to find and says no more.
WITHOUT_SHRINKING = (Phase.explicit, Phase.generate)
instants = st.datetimes(
    datetime(1990, 1, 1), datetime(2050, 1, 1), timezones=st.just(UTC)
)  # fmt: skip
latitudes_deg = st.floats(-89.0, 89.0)
longitudes_deg = st.floats(-180.0, 180.0)


def almanac_time(instant):
    return astronomy.Time((instant - J2000) / DAY)


def seen_from(body, time, observer):
    """Unit vector (3,) in equatorial axes of date, distance (km) and true elevation (deg)."""
    place = astronomy.Equator(body, time, observer, True, True)
    level = astronomy.Horizon(time, observer, place.ra, place.dec, astronomy.Refraction.Airless)
    vector = np.array([place.vec.x, place.vec.y, place.vec.z])
    distance = np.linalg.norm(vector)
    return vector / distance, distance * astronomy.KM_PER_AU, level.altitude


def sun_and_moon(time, observer):
    """The sun's elevation (deg), the moon's distance from it and its radius (radii of the sun)."""
    sun, sun_km, elevation_deg = seen_from(astronomy.Body.Sun, time, observer)
    moon, moon_km, _ = seen_from(astronomy.Body.Moon, time, observer)
    sun_rad = SUN_RADIUS_KM / sun_km
    return elevation_deg, np.linalg.norm(sun - moon) / sun_rad, MOON_RADIUS_KM / moon_km / sun_rad


def hidden_share(time, observer):
    """Share of the sun's disc behind the moon, 0 below the horizon, by its columns."""
    elevation_deg, apart, radius = sun_and_moon(time, observer)
    if elevation_deg + OUR_REFRACTION_DEG < -1e-3 or apart > 1.0 + radius:
        return 0.0
    sun = np.sqrt(1.0 - ACROSS**2)
    moon = np.sqrt(np.maximum(radius**2 - (ACROSS - apart) ** 2, 0.0))
    return float(np.minimum(sun, moon).sum() / sun.sum())


def most_hidden(middle, observer):
    """Largest hidden share about an eclipse's greatest moment on Earth, to half a minute."""
    coarse = [middle.AddDays(minutes / 1440.0) for minutes in range(-216, 217, 8)]
    near = [
        time
        for time in coarse
        for elevation_deg, apart, _ in [sun_and_moon(time, observer)]
        if elevation_deg > -3.0 and apart < 3.0
    ]
    if not near:
        return 0.0
    span_min = np.arange(-8.0, (near[-1].ut - near[0].ut) * 1440.0 + 8.0, 0.5)
    return max(hidden_share(near[0].AddDays(m / 1440.0), observer) for m in span_min)


@settings(max_examples=8, deadline=None, phases=WITHOUT_SHRINKING)
@given(instants, latitudes_deg, longitudes_deg)
@example(datetime(2026, 8, 1, tzinfo=UTC), 52.23, 21.01)  # The sun sets eclipsed.
@example(datetime(2026, 8, 1, tzinfo=UTC), 89.0, 0.0)
def test_the_next_eclipse_is_the_first_of_which_the_place_sees_a_part(
    instant, latitude_deg, longitude_deg
):
    """Every eclipse on Earth is looked at from the place, every half minute: none that it sees is
    left out, and at the instant given as much of the sun is hidden as ever while it is up."""
    found = next_solar_eclipse(watch(instant, latitude_deg, longitude_deg))
    observer = astronomy.Observer(latitude_deg, longitude_deg, 0.0)
    on_earth = astronomy.SearchGlobalSolarEclipse(almanac_time(instant))
    while on_earth.peak.ut < almanac_time(found.at).ut - 0.3:
        assert most_hidden(on_earth.peak, observer) < SURELY_SEEN
        on_earth = astronomy.NextGlobalSolarEclipse(on_earth.peak)
    most = most_hidden(on_earth.peak, observer)
    assert most > SURELY_NONE
    assert abs(found.hidden_area - most) < 0.02
    assert abs(hidden_share(almanac_time(found.at), observer) - most) < 0.02
    assert found.at >= instant


def limb_deg(instant, observer):
    """Apparent elevation (deg) of the moon's upper limb near the horizon."""
    _, distance_km, elevation_deg = seen_from(astronomy.Body.Moon, almanac_time(instant), observer)
    return elevation_deg + REFRACTION_DEG + np.degrees(np.arcsin(MOON_RADIUS_KM / distance_km))


@settings(max_examples=15, deadline=None)
@given(instants, st.one_of(latitudes_deg, st.floats(61.0, 72.0)), longitudes_deg)
@example(datetime(2026, 1, 1, 23, 50, tzinfo=UTC), 50.08, 14.44)
@example(datetime(2025, 12, 4, tzinfo=UTC), 63.0, 0.0)  # A moon that hardly sets.
def test_moonrise_and_moonset_are_the_next_ones(instant, latitude_deg, longitude_deg):
    """The upper limb lies on the horizon then, and passed it that way at no sooner moment; a moon
    without a rise within two days crosses nothing. The bar's path has the same instants."""
    observer = astronomy.Observer(latitude_deg, longitude_deg, 0.0)
    found = next_rise_and_set(watch(instant, latitude_deg, longitude_deg))
    samples = [instant + timedelta(minutes=10 * n) for n in range(2 * 144 + 1)]
    limbs = [limb_deg(when, observer) for when in samples]
    for event, sign in zip(found, (1.0, -1.0), strict=True):
        if event is not None:
            assert instant <= event <= samples[-1]
            assert abs(limb_deg(event, observer)) < 0.005
        for (when, before), (_, after) in pairwise(zip(samples, limbs, strict=True)):
            crosses = sign * before < -0.005 and sign * after > 0.005
            assert not crosses or (event is not None and event < when + timedelta(minutes=10))
    place = SetPlace(latitude_deg=latitude_deg, longitude_deg=longitude_deg)
    path = moon_path(instant, place, "test")
    for event, seconds in zip(found, (path.rises_s, path.sets_s), strict=True):
        after_s = np.inf if event is None else (event - path.start).total_seconds()
        if after_s < (path.direction.shape[0] - 1) * path.step_s - 60.0:
            assert min(abs(after_s - other_s) for other_s in seconds) < 2.0

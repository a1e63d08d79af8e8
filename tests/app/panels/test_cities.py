"""The bundled cities lie where they are, and are found by what one types."""

from importlib.resources import files

import numpy as np
import pytest

from vrut_lite.app.panels.cities import all_cities, find_cities
from vrut_lite.app.panels.place_panel import name_of, point_below
from vrut_lite.geometry.world_outline import world_outline
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import SunMoved
from vrut_lite.place_time import Place, time_zone_at

# Cities near a border, or whose zone the database lists under a neighbour.
SHARED_ZONES = {"AQ": ("Antarctica", "Pacific"), "SJ": ("Arctic", "Europe")}


def zone_countries():
    """Which countries the time zone database lists for a zone."""
    text = (files("tzdata") / "zoneinfo" / "zone1970.tab").read_text()
    rows = [line.split("\t") for line in text.splitlines() if not line.startswith("#")]
    return {row[2]: row[0].split(",") for row in rows}


def test_every_city_lies_in_its_country():
    """A slip of sign or of a digit moves a city into another country's time zone or the sea."""
    from zoneinfo import ZoneInfo

    countries = zone_countries()
    tab = (files("tzdata") / "zoneinfo" / "zone.tab").read_text().splitlines()
    own = {row.split("\t")[2]: row.split("\t")[0] for row in tab if row[:1] not in ("#", "")}
    wrong = []
    for city in all_cities():
        zone = time_zone_at(Place(city.latitude_deg, city.longitude_deg))
        assert isinstance(zone, ZoneInfo)
        listed = {own.get(zone.key), *countries.get(zone.key, [])}
        if city.country not in listed and city.country not in ("AQ", "EH"):
            wrong.append((city, zone.key))
    assert wrong == []


def test_names_are_found_by_their_beginning_first_and_without_accents():
    """Who types 'sao p' means Sao Paulo; 'york' is inside New York."""
    assert find_cities("prag")[0].name == "Prague"
    assert find_cities("SAO PAULO")[0].country == "BR"
    assert "New York" in [city.name for city in find_cities("york")]
    assert find_cities("Prague, CZ")[0].name == "Prague"
    assert find_cities("") == find_cities("xyzzy") == []


def test_a_place_is_named_after_the_city_it_is_in():
    """Within 25 km; out in the ocean the coordinates must do."""
    assert name_of(SetPlace(latitude_deg=50.1, longitude_deg=14.5)) == "Prague, CZ"
    assert name_of(SetPlace(latitude_deg=-40.0, longitude_deg=-20.5)) == "40.00° S, 20.50° W"


@pytest.mark.parametrize("place", [(50.0, 14.4), (-33.9, 151.2), (0.0, -78.0)])
def test_the_sun_stands_in_the_zenith_of_the_point_below_it(place):
    """From a sun at the zenith of the place it is the place; at its horizon a quarter turn off."""
    here = SetPlace(latitude_deg=place[0], longitude_deg=place[1], north_offset_rad=0.7)
    above = {"azimuth_rad": 0.0, "elevation_rad": 0.0, "apparent_elevation_rad": 0.0}
    zenith = SunMoved(direction=(0.0, 1.0, 0.0), visible_disc_fraction=1.0, **above)
    assert point_below(zenith, here) == pytest.approx(place)
    true_north = (-np.sin(0.7), 0.0, -np.cos(0.7))
    horizon = SunMoved(direction=true_north, visible_disc_fraction=1.0, **above)
    latitude_deg, _ = point_below(horizon, here)
    assert latitude_deg == pytest.approx(90.0 - abs(place[0]) if place[0] >= 0 else 90 + place[0])


def test_the_outline_is_land():
    """Rings of degrees that hold Prague and Sydney's hinterland and not the mid-Atlantic."""
    from matplotlib.path import Path

    def on_land(longitude_deg, latitude_deg):
        return any(Path(r).contains_point((longitude_deg, latitude_deg)) for r in world_outline())

    assert on_land(14.4, 50.1)
    assert on_land(149.0, -33.0)
    assert not on_land(-30.0, 30.0)

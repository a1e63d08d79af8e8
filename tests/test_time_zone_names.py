"""Names of time zones by coordinates: the map is loaded once for a place, not in each session."""

import pytest

from vrut_lite import time_zone_names
from vrut_lite.time_zone_names import zone_name


@pytest.fixture
def asked(monkeypatch, tmp_path):
    """The places that the map was asked for, as (longitude, latitude)."""
    places, look_up = [], time_zone_names.tzfpy.get_tz

    def noted(longitude_deg, latitude_deg):
        places.append((longitude_deg, latitude_deg))
        return look_up(longitude_deg, latitude_deg)

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(time_zone_names.tzfpy, "get_tz", noted)
    zone_name.cache_clear()
    yield places
    zone_name.cache_clear()


def test_another_session_knows_the_zone_without_the_map(asked):
    """Only the place that a session asks for first is kept: others find the map loaded."""
    assert zone_name(14.4, 50.1) == "Europe/Prague"
    assert zone_name(0.0, 51.5) == "Europe/London"
    zone_name.cache_clear()
    asked.clear()
    assert zone_name(14.4, 50.1) == "Europe/Prague"
    assert asked == []
    assert zone_name(0.0, 51.5) == "Europe/London"
    assert asked == [(0.0, 51.5)]

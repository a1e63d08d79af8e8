"""Text to places and instants: the meaning at the place, or a refusal."""

import re
from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import pytest
from hypothesis import example, given, reject
from hypothesis import strategies as st

from vrut_lite import place_time
from vrut_lite.errors import UserError
from vrut_lite.place_time import (
    Place,
    local_text,
    parse_instant,
    parse_place,
    same_hour_elsewhere,
    time_zone_at,
)
from vrut_lite.plain_numbers import plain_float, plain_int

PRAGUE = Place(50.0755, 14.4378)
LORD_HOWE = Place(-31.55, 159.08)
APIA = Place(-13.83, -171.76)
KWAJALEIN = Place(8.72, 167.73)
SITKA = Place(57.05, -135.33)
ATLANTIC = Place(40.0, -30.0)
DUBLIN = Place(53.35, -6.26)
PLACES = [PRAGUE, LORD_HOWE, APIA, KWAJALEIN, SITKA, ATLANTIC, DUBLIN]


def refusal(text: str, place: Place) -> str:
    with pytest.raises(UserError) as caught:
        parse_instant(text, place)
    return str(caught.value)


def test_a_place_is_two_or_three_numbers():
    """Latitude comes first and east is positive, as in ISO 6709; altitude is optional."""
    assert parse_place("50.0755,14.4378") == PRAGUE
    assert parse_place(" -33.9 , -70.5, 2400 ") == Place(-33.9, -70.5, 2400.0)
    assert parse_place("90,-180") == Place(90.0, -180.0)


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("91,0", "latitude 91"),
        ("nan,0", "latitude nan"),
        ("0,inf", "longitude inf"),
        ("0,-180.5", "longitude -180.5"),
        ("0,0,-12000", "altitude -12000"),
        ("0,0,1e300", "altitude 1e+300"),
        ("Prague", "'Prague' is no place"),
        ("50.0755", "is no place"),
        ("1,2,3,4", "is no place"),
        ("", "is no place"),
        ("1_0,14", "is no place"),
        ("５０,14", "is no place"),
        ("٥٠,١٤", "is no place"),
        ("−50,14", "is no place"),
        ("50°,14°", "is no place"),
        ("0x32,14", "is no place"),
        ("1e400,0", "latitude inf"),
        ("0,0," + "9" * 5000, "altitude inf"),
    ],
)
def test_a_wrong_place_is_refused_by_name(text, named):
    """One line that says which number is wrong, or how a place is written."""
    with pytest.raises(UserError, match=re.escape(named)) as caught:
        parse_place(text)
    assert "\n" not in str(caught.value)


def test_the_zone_is_of_the_coordinates_not_of_the_longitude():
    """Western China has Beijing's time, 2 hours from solar time; oceans have nautical time."""
    assert time_zone_at(PRAGUE).key == "Europe/Prague"
    assert time_zone_at(Place(39.47, 75.99)).key in ("Asia/Shanghai", "Asia/Urumqi")
    assert time_zone_at(LORD_HOWE).key == "Australia/Lord_Howe"
    assert datetime(2026, 6, 21, tzinfo=time_zone_at(ATLANTIC)).utcoffset() == timedelta(hours=-2)


@given(st.floats(-90, 90), st.floats(-180, 180))
@example(90.0, 0.0)
@example(-90.0, 180.0)
@example(0.0, -180.0)
def test_every_place_on_earth_has_a_zone(latitude_deg, longitude_deg):
    """All coordinates have a time zone, poles and date line included."""
    zone = time_zone_at(Place(latitude_deg, longitude_deg))
    offset = datetime(2026, 1, 1, tzinfo=zone).utcoffset()
    assert offset is not None
    assert abs(offset) <= timedelta(hours=14)


@pytest.mark.parametrize(
    ("longitude_deg", "hours"),
    [(0, 0), (7.4, 0), (7.6, 1), (-7.6, -1), (180, 12), (-180, -12), (-173, -12), (151, 10)],
)
def test_a_gap_in_the_map_of_zones_takes_the_nautical_one(monkeypatch, longitude_deg, hours):
    """Nautical zones are 15 degrees wide, centred on the full hours; Etc names flip the sign."""
    monkeypatch.setattr(place_time, "zone_name", lambda longitude, latitude: "")
    zone = time_zone_at(Place(0.0, longitude_deg))
    assert datetime(2026, 1, 1, tzinfo=zone).utcoffset() == timedelta(hours=hours)


@pytest.mark.parametrize(
    ("text", "place", "utc"),
    [
        ("2026-06-21T18:30", PRAGUE, "2026-06-21T16:30:00"),
        ("2026-12-21 18:30", PRAGUE, "2026-12-21T17:30:00"),
        ("2026-06-21T18:30Z", PRAGUE, "2026-06-21T18:30:00"),
        ("2026-06-21t18:30:15z", PRAGUE, "2026-06-21T18:30:15"),
        ("2026-06-21 18:30:00.25 -0330", PRAGUE, "2026-06-21T22:00:00.250000"),
        ("2026-06-21T18:30+02", APIA, "2026-06-21T16:30:00"),
        ("2026-06-21T18:30", ATLANTIC, "2026-06-21T20:30:00"),
        ("1800-02-20T14:00", DUBLIN, "1800-02-20T14:25:21"),
        ("1800-02-20T14:00:00-00:25:21", PRAGUE, "1800-02-20T14:25:21"),
    ],
)
def test_local_times_and_offsets(text, place, utc):
    """An offset in the text wins; without one the place's IANA zone applies."""
    instant = parse_instant(text, place)
    assert instant.tzinfo is UTC
    assert instant == datetime.fromisoformat(utc).replace(tzinfo=UTC)


@pytest.mark.parametrize(
    ("text", "place", "first", "second"),
    [
        # Skipped by an hour, by half an hour, and by whole days at the date line.
        ("2026-03-29T02:30", PRAGUE, "2026-03-29T01:30+01:00", "2026-03-29T03:30+02:00"),
        ("2026-10-04T02:15", LORD_HOWE, "2026-10-04T01:45+10:30", "2026-10-04T02:45+11:00"),
        ("2011-12-30T00:00", APIA, "2011-12-29T00:00-10:00", "2011-12-31T00:00+14:00"),
        ("2011-12-30T23:59:59", APIA, "2011-12-29T23:59:59-10:00", "2011-12-31T23:59:59+14:00"),
        ("1993-08-21T12:00", KWAJALEIN, "1993-08-20T12:00-12:00", "1993-08-22T12:00+12:00"),
        # Doubled by an hour, by half an hour, and by a day as Alaska changed hands.
        ("2026-10-25T02:30", PRAGUE, "2026-10-25T02:30+02:00", "2026-10-25T02:30+01:00"),
        ("2026-04-05T01:45", LORD_HOWE, "2026-04-05T01:45+11:00", "2026-04-05T01:45+10:30"),
        ("1867-10-19T12:00", SITKA, "1867-10-19T12:00+14:58:47", "1867-10-19T12:00-09:01:13"),
    ],
)
def test_a_skipped_or_doubled_time_is_refused_with_both_readings(text, place, first, second):
    """The two readings can be pasted back, are real times at the place and differ by the shift."""
    message = refusal(text, place)
    assert message.endswith(f"write {first} or {second}")
    early, late = parse_instant(first, place), parse_instant(second, place)
    for reading, instant in ((first, early), (second, late)):
        there = instant.astimezone(time_zone_at(place))
        assert there.replace(tzinfo=None) == datetime.fromisoformat(reading).replace(tzinfo=None)
    assert early < late


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("2026-03-29T01:59:59", PRAGUE),
        ("2026-03-29T03:00", PRAGUE),
        ("2026-10-25T01:59:59", PRAGUE),
        ("2026-10-25T03:00", PRAGUE),
        ("2026-10-04T02:30", LORD_HOWE),
        ("2011-12-29T23:59:59", APIA),
        ("2011-12-31T00:00", APIA),
    ],
)
def test_the_last_and_first_times_around_a_change_are_accepted(text, place):
    """Times just outside the skipped or doubled interval are accepted."""
    local = parse_instant(text, place).astimezone(time_zone_at(place))
    assert local.replace(tzinfo=None) == datetime.fromisoformat(text)


@pytest.mark.parametrize(
    "text",
    [
        "2026-02-30T10:00",
        "2026-02-20T25:00",
        "2026-02-20T24:00",
        "2026-02-20T10:60",
        "2026-02-20T10:00+25:00",
        "2026-02-20T10:00+01:60",
        "2026-02-20T10:00-00:00:60",
        "tomorrow",
        "2026-06-21",
        "18:30",
        "2026-W25-1T18:30",
        "20260621T1830",
        "٢٠٢٦-٠٦-٢١T١٨:٣٠",
        "",
    ],
)
def test_an_impossible_time_is_refused_with_an_example(text):
    """One line that quotes the text and shows the right form."""
    message = refusal(text, PRAGUE)
    assert f"'{text}'" in message
    assert "write " in message
    assert "\n" not in message


@pytest.mark.parametrize("year", ["0001", "1599", "2601", "9999"])
def test_years_beyond_the_ephemeris_are_refused(year):
    """The sentence states the range; the ends of the calendar do not overflow."""
    assert "outside 1600 to 2600" in refusal(f"{year}-01-01T00:00", APIA)
    assert "outside 1600 to 2600" in refusal(f"{year}-12-31T23:59+14:00", APIA)


@given(
    st.datetimes(datetime(1600, 1, 1), datetime(2600, 12, 31)),
    st.sampled_from(PLACES),
)
@example(datetime(2026, 10, 25, 2, 30), PRAGUE)
@example(datetime(2011, 12, 30, 2, 30), APIA)
def test_every_accepted_local_time_round_trips(wall, place):
    """Converted back to local time, the instant shows the text."""
    try:
        instant = parse_instant(wall.isoformat(), place)
    except UserError:
        reject()
    assert instant.astimezone(time_zone_at(place)).replace(tzinfo=None, fold=0) == wall


@given(
    st.datetimes(datetime(1860, 1, 1), datetime(2037, 12, 31), timezones=st.just(UTC)),
    st.sampled_from(PLACES),
)
@example(datetime(2026, 10, 25, 0, 30, tzinfo=UTC), PRAGUE)
@example(datetime(2026, 10, 25, 1, 30, tzinfo=UTC), PRAGUE)
def test_every_instant_can_be_written(instant, place):
    """The local time of any instant is accepted, or refused with that instant as a reading."""
    local = instant.astimezone(time_zone_at(place))
    assert parse_instant(local.isoformat(), place) == instant
    try:
        readings = [parse_instant(local.replace(tzinfo=None).isoformat(), place)]
    except UserError as error:
        _, _, offered = str(error).partition(": write ")
        readings = [parse_instant(text, place) for text in offered.split(" or ")]
    assert instant in readings


def test_captions_name_the_clock_at_the_place():
    """Letters where the zone has them, else the offset; seconds only where there are any."""
    instant = datetime(2026, 6, 21, 16, 30, tzinfo=UTC)
    assert local_text(instant, PRAGUE) == "2026-06-21 18:30 CEST"
    assert local_text(instant, ATLANTIC) == "2026-06-21 14:30 UTC-02:00"
    assert local_text(instant, APIA) == "2026-06-22 05:30 UTC+13:00"
    later = instant + timedelta(seconds=7.5)
    assert local_text(later.astimezone(ZoneInfo("Asia/Tokyo")), PRAGUE) == (
        "2026-06-21 18:30:07 CEST"
    )


def test_captions_refuse_a_naive_time():
    """A naive time is refused; it would be taken for the machine's time zone."""
    with pytest.raises(ValueError, match="needs a time zone"):
        local_text(datetime(2026, 6, 21, 16, 30), PRAGUE)


@given(
    st.text(
        st.characters(categories=["Nd", "Pc", "Pd", "Zs"], include_characters="+-.eE_"), max_size=8
    )
)
@example("1_0")
@example("３")
@example(" +1.5e1 ")
def test_numbers_have_plain_form(text):
    """Only Python's numbers in ASCII without underscores are accepted, floats and integers."""
    plain = text.strip().isascii() and "_" not in text
    for ours, pythons in ((plain_float, float), (plain_int, int)):
        try:
            expected = pythons(text)
        except ValueError:
            expected = None
        if expected is None or not plain:
            with pytest.raises(ValueError, match="number"):
                ours(text)
        else:
            assert ours(text) == expected


def test_an_hour_is_taken_along_to_another_place():
    """18:40 stays 18:40, also where its date is another in UTC; what is skipped comes after."""
    prague, tokyo, los_angeles = Place(50.0, 14.4), Place(35.68, 139.69), Place(34.05, -118.24)
    evening = datetime(2026, 6, 21, 16, 40, tzinfo=UTC)
    assert same_hour_elsewhere(evening, prague, tokyo) == datetime(2026, 6, 21, 9, 40, tzinfo=UTC)
    there = same_hour_elsewhere(evening, prague, los_angeles)
    assert there == datetime(2026, 6, 22, 1, 40, tzinfo=UTC)
    assert same_hour_elsewhere(there, los_angeles, prague) == evening
    # Clocks of Los Angeles go from 2:00 to 3:00 on 8 March 2026.
    skipped = datetime(2026, 3, 8, 1, 30, tzinfo=UTC)
    assert f"{skipped.astimezone(time_zone_at(prague)):%H:%M}" == "02:30"
    shown = same_hour_elsewhere(skipped, prague, los_angeles).astimezone(time_zone_at(los_angeles))
    assert f"{shown:%d %H:%M}" == "08 03:30"

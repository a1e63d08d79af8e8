"""EPW files: what is read, what is filled in and said, and what is refused in one line."""

from datetime import UTC, datetime

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from vrut_lite.errors import UserError
from vrut_lite.weather.weather_file import read_weather

HEAD = 8
DEW, GLOBAL, DIRECT, DIFFUSE, TOTAL, OPAQUE = 7, 13, 14, 15, 22, 23


def with_cells(text, cells):
    """The year with cells (row, column) replaced; the row None is every row."""
    lines = text.splitlines()
    for (row, column), value in cells.items():
        for n in range(HEAD, len(lines)) if row is None else [HEAD + row]:
            parts = lines[n].split(",")
            parts[column] = value
            lines[n] = ",".join(parts)
    return "\n".join(lines)


@pytest.fixture
def read(tmp_path):
    def read_text(text, encoding="ascii"):
        path = tmp_path / "year.epw"
        path.write_bytes(text.encode(encoding))
        return read_weather(path)

    return read_text


def test_a_year_is_read(year_file, year_text):
    """Place, standard time and the hours' means, each in its row; nothing lacks."""
    weather = read_weather(year_file)
    assert (weather.latitude_deg, weather.longitude_deg) == (50.1, 14.4)
    assert (weather.altitude_m, weather.utc_offset_h, weather.name) == (200.0, 1.0, "Prague")
    assert weather.lacks == ()
    noon = HEAD + 24 * 171 + 12
    cells = year_text.splitlines()[noon].split(",")
    assert cells[1:4] == ["6", "21", "13"]
    hour = weather.hour_at(datetime(2026, 6, 21, 11, 30, tzinfo=UTC))
    assert hour.direct_normal_w_m2 == float(cells[DIRECT])
    assert hour.diffuse_horizontal_w_m2 == float(cells[DIFFUSE])
    assert hour.dew_point_c == float(cells[DEW])
    assert hour.cloud_cover == pytest.approx(0.1 * float(cells[TOTAL]))


def test_an_hour_ends_at_its_label(year_file):
    """Hour 13 is from noon to one o'clock of standard time: summer time moves no weather."""
    weather = read_weather(year_file)
    row = 24 * 171 + 12
    for minute, expected in ((0, row), (59, row), (60, row + 1)):
        when = datetime.fromtimestamp(
            datetime(2026, 6, 21, 11, tzinfo=UTC).timestamp() + 60 * minute, UTC
        )
        assert weather.row_at(when) == expected
    # The year turns in standard time too.
    assert weather.row_at(datetime(2025, 12, 31, 23, 30, tzinfo=UTC)) == 0


def test_leap_days(year_file, read):
    """The 29th has the 28th's weather where the file has none; with one, no other day moves."""
    common = read_weather(year_file)
    assert common.row_at(datetime(2024, 2, 29, 11, tzinfo=UTC)) == 24 * 58 + 12
    assert common.row_at(datetime(2024, 3, 1, 11, tzinfo=UTC)) == 24 * 59 + 12
    assert common.row_at(datetime(2024, 12, 31, 22, 59, tzinfo=UTC)) == 8759
    lines = year_file.read_text().splitlines()
    end = HEAD + 24 * 59
    added = [line.replace(",2,28,", ",2,29,", 1) for line in lines[end - 24 : end]]
    text = "\n".join([*lines[:end], *added, *lines[end:]])
    leap = read(text.replace("\n2023,", "\n2024,"))
    assert len(leap.dew_point_c) == 8784
    assert leap.row_at(datetime(2023, 3, 1, 11, tzinfo=UTC)) == 24 * 60 + 12
    assert leap.row_at(datetime(2024, 12, 31, 22, 59, tzinfo=UTC)) == 8783


def test_missing_values_are_filled_and_said(year_text, read):
    """9999 is the same hour of the nearest day; what stands in is said a line each."""
    row = 24 * 100 + 12
    weather = read(
        with_cells(
            year_text,
            {(row, DIRECT): "9999", (row + 1, DIRECT): "99999", (row, DEW): "99.9",
             (None, TOTAL): "99", (None, OPAQUE): "99"},
        )
    )  # fmt: skip
    assert weather.direct_normal_w_m2[row] == weather.direct_normal_w_m2[row - 24]
    assert weather.dew_point_c[row] == weather.dew_point_c[row - 24]
    assert weather.cloud_cover == ()
    assert weather.lacks == (
        "2 hours lack direct normal irradiance: the same hour of the nearest day stands in",
        "1 hour lacks the dew point: the same hour of the nearest day stands in",
        "no cloud cover: the time bar shows no clouds",
    )


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "utf-16"])
def test_names_of_towns_may_be_in_any_encoding(year_text, read, encoding):
    """Files are written all over the world: the name is read as its town spells it."""
    head, _, rows = year_text.partition("\n")
    head = head.replace("Prague", '"Zürich, Kloten"')
    assert read(f"{head}\n{rows}", encoding).name == "Zürich  Kloten"


@pytest.mark.parametrize("night", ["-1", "", "9999", "-9999", " "])
def test_light_that_is_missing_by_night_is_none(year_text, read, night):
    """Instruments rest while the sun is down: what they then write is no lack of the file. Within
    a degree of the horizon the light of a day nearby stands in, tens of watts."""
    rows = [line.split(",") for line in year_text.splitlines()[HEAD:]]
    dark = [n for n, row in enumerate(rows) if row[GLOBAL] == row[DIRECT] == row[DIFFUSE] == "0"]
    blank = {(n, column): night for n in dark for column in (DIRECT, DIFFUSE)}
    expected, found = read(year_text), read(with_cells(year_text, blank))
    for name in ("direct_normal_w_m2", "diffuse_horizontal_w_m2"):
        apart = np.array(getattr(found, name)) - np.array(getattr(expected, name))
        assert apart.max() < 30.0
        assert np.count_nonzero(apart) < 40


def test_an_hour_that_is_never_observed_has_the_nearest_hours_clouds(year_text, read):
    """Observers write clouds down every six hours, or by day alone."""
    rows = [row for row in range(8760) if row % 6]
    cover = np.array(read(with_cells(year_text, {(row, TOTAL): "99" for row in rows})).cloud_cover)
    by_day, observed = cover.reshape(-1, 24), np.repeat([0, 6, 12, 18], [4, 6, 6, 8])
    assert np.array_equal(by_day, by_day[:, observed])


@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.integers(0, 8759), st.integers(0, 34), st.text(max_size=8) | st.floats().map(str))
def test_any_cell_is_read_or_refused_in_one_line(year_text, read, row, column, cell):
    """Rows come from loggers and spreadsheets: none of them ends in a traceback."""
    refusal = ""
    try:
        read(with_cells(year_text, {(row, column): cell}), "utf-8").check()
    except UserError as error:
        refusal = str(error)
    places = f"line {HEAD + row + 1}:", f"row {row + 1} ", "rows:", "line "
    assert not refusal or any(place in refusal for place in places)


def test_files_as_editors_and_older_programs_leave_them(year_text, read):
    """A byte order mark, a Mac's line ends, and rows without the last columns change nothing."""
    expected = read(year_text)
    short = year_text.splitlines()
    short[HEAD:] = [line.rsplit(",", 3)[0] for line in short[HEAD:]]
    for text in ("\ufeff" + year_text, "\r".join(year_text.splitlines()), "\n".join(short)):
        assert read(text, "utf-8") == expected


def test_a_year_of_the_south(year_text, read):
    """South and west are negative, half hours of standard time are kept."""
    head = "LOCATION,Adelaide,-,-,x,0,-34.9,138.6,9.5,50"
    weather = read(head + "\n" + year_text.partition("\n")[2])
    assert (weather.latitude_deg, weather.utc_offset_h) == (-34.9, 9.5)
    assert weather.row_at(datetime(2026, 1, 1, 2, 29, tzinfo=UTC)) == 11
    assert weather.row_at(datetime(2026, 1, 1, 2, 31, tzinfo=UTC)) == 12


BROKEN = {
    "another file": (lambda t: "{}", "is no EPW file"),
    "empty": (lambda t: "", "is no EPW file"),
    "bad place": (lambda t: t.replace(",50.1,", ",north,", 1), "cannot read the weather file"),
    "beyond the pole": (lambda t: t.replace(",50.1,", ",95,", 1), "latitude_deg of weather"),
    "a day short": (lambda t: "\n".join(t.splitlines()[:-24]), "has 8,736 rows"),
    "an hour twice": (
        lambda t: t.replace("2023,3,5,7,", "2023,3,5,8,", 1),
        "another hour in row 1519 than month 3, day 5, hour 7",
    ),
    "no direct sun in an hour": (
        lambda t: with_cells(t, {(row, DIRECT): "" for row in range(12, 8760, 24)}),
        "has no direct normal irradiance in hour 13 of any day, though the sun is up",
    ),
    "no direct sun": (
        lambda t: with_cells(t, {(None, DIRECT): "9999"}),
        "has no direct normal irradiance",
    ),
    "words": (lambda t: t.replace("2023,3,5,7,", "2023,March,5,7,", 1), "line 1527: must hold"),
    "no such day": (
        lambda t: t.replace("2023,3,5,7,", "2023,2,30,7,", 1),
        "date 2023-2-30 does not exist",
    ),
    "a row cut off": (lambda t: t.replace("2023,3,5,7,", "2023,3,5,7\n", 1), "line 1527: must"),
    "no time zone": (lambda t: t.replace(",1.0,200.0", ",,200.0", 1), "time zone and altitude of"),
    "a zone of no earth": (lambda t: t.replace(",1.0,200.0", ",99,200.0", 1), "of this earth"),
    "no rows": (lambda t: "\n".join(t.splitlines()[:HEAD]), "the weather file"),
    "only a head": (lambda t: t.splitlines()[0], "the weather file"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_broken_files_are_refused_in_one_line(case, year_text, read):
    """Never a traceback: what is wrong, and with which file."""
    change, said = BROKEN[case]
    with pytest.raises(UserError, match=r"^[^\n]+$") as refusal:
        read(change(year_text))
    assert said in str(refusal.value)
    assert "year.epw" in str(refusal.value)


def test_files_that_are_none(tmp_path):
    """A missing file and a folder."""
    for path in (tmp_path / "none.epw", tmp_path):
        with pytest.raises(UserError, match="cannot open the weather file"):
            read_weather(path)


def test_values_are_numbers_of_their_range(year_file):
    """What a file says beyond physics is missing, not light."""
    weather = read_weather(year_file)
    assert np.min(weather.direct_normal_w_m2) == 0.0
    assert 0.0 <= min(weather.cloud_cover) <= max(weather.cloud_cover) <= 1.0

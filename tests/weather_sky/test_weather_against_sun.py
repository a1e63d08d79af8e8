"""Weather that contradicts the sun of its place, or itself, is reported with the better reading."""

from pathlib import Path

import numpy as np
import pytest
from command_output import shared_options
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from vrut_lite.errors import UserError
from vrut_lite.messages.weather import SetWeather
from vrut_lite.project import Project
from vrut_lite.weather.weather_checks import contradictions
from vrut_lite.weather.weather_file import read_weather

PLACE = ",50.1,14.4,1.0,"
HEAD, DNI, GHI, DHI = 8, 14, 13, 15
UNKNOWN = np.full(8760, np.nan)


def with_columns(text, change):
    """The year with its columns global, direct and diffuse changed by a function of the three."""
    lines = text.splitlines()
    for n in range(HEAD, len(lines)):
        parts = lines[n].split(",")
        changed = change(*(float(parts[column]) for column in (GHI, DNI, DHI)))
        for column, value in zip((GHI, DNI, DHI), changed, strict=True):
            parts[column] = f"{value:.0f}"
        lines[n] = ",".join(parts)
    return "\n".join(lines)


@pytest.fixture
def told(tmp_path):
    def read_text(text):
        path = tmp_path / "year.epw"
        path.write_text(text)
        return read_weather(path).lacks

    return read_text


@pytest.mark.parametrize(
    ("place", "says"),
    [
        (",50.1,14.4,0.0,", "hours 1 h earlier (time zone 1 instead of 0)"),
        (",50.1,14.4,1.5,", "hours 0.5 h later (time zone 1 instead of 1.5)"),
        (",50.1,14.4,-8.0,", "hours 9 h earlier (time zone 1 instead of -8)"),
        (",50.1,-14.4,1.0,", "longitude 14.4 (east) instead of -14.4"),
        (",-50.1,14.4,1.0,", "latitude 50.1 (north) instead of -50.1"),
    ],
)
def test_a_false_head_is_told(place, says, year_text, told):
    """Light at the wrong hours gives autonomies of 27 % for 100: the reading that fits is named."""
    (line,) = told(year_text.replace(PLACE, place, 1))
    assert line == f"the light does not follow the sun of this place: it fits with {says}"


def test_columns_that_contradict_each_other_are_told(year_text, told):
    """More diffuse than global light; a global that its parts do not make. One sentence each."""
    (line,) = told(with_columns(year_text, lambda g, b, d: (0.5 * d, 0.0, d)))
    assert "more diffuse than global light" in line
    (line,) = told(with_columns(year_text, lambda g, b, d: (g, 0.3 * b, d)))
    assert "another global light than direct and diffuse make together" in line
    (line,) = told(with_columns(year_text, lambda g, b, d: (0.0, 0.0, 0.0)))
    assert "no hour of the year has any light" in line
    # Without a global column there is nothing to compare.
    assert told(with_columns(year_text, lambda g, b, d: (9999.0, 0.3 * b, d))) == ()


@pytest.mark.parametrize("file", ["723170TYA.CSV", "703165TY.csv"])
@pytest.mark.parametrize("late_h", [0.0, 0.5, -0.5, 1.0])
def test_real_years(file, late_h):
    """Greensboro and Sand Point by TMY3: no line as they are, one when half an hour off."""
    pvlib = pytest.importorskip("pvlib")
    table, head = pvlib.iotools.read_tmy3(
        Path(pvlib.__file__).parent / "data" / file, map_variables=True
    )
    direct, diffuse, level = (tuple(table[name].astype(float)) for name in ("dni", "dhi", "ghi"))
    weather = SetWeather(
        path=file, name=file, latitude_deg=head["latitude"], longitude_deg=head["longitude"],
        altitude_m=head["altitude"], utc_offset_h=head["TZ"] - late_h, dew_point_c=(9.0,) * 8760,
        direct_normal_w_m2=direct, diffuse_horizontal_w_m2=diffuse,
    )  # fmt: skip
    lines = contradictions(weather, np.array(level))
    if late_h:
        assert [f"(time zone {head['TZ']:g} instead of" in line for line in lines] == [True]
    else:
        assert lines == ()


@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_any_shift_is_found(year_file, data):
    """Whole and half hours (2 h are 28.8 degrees of longitude, too), at any level of light."""
    weather = read_weather(year_file)
    half_hours = data.draw(st.integers(-22, 22).filter(lambda n: n not in (0, -4)))
    scale = data.draw(st.floats(0.2, 1.3))
    lost = np.random.default_rng(data.draw(st.integers(0, 9))).random(8760) < 0.3
    light = [np.array(values) * scale * ~lost for values in
             (weather.direct_normal_w_m2, weather.diffuse_horizontal_w_m2)]  # fmt: skip
    changed = replace(
        weather, utc_offset_h=1.0 + 0.5 * half_hours,
        direct_normal_w_m2=tuple(light[0]), diffuse_horizontal_w_m2=tuple(light[1]),
    )  # fmt: skip
    (line,) = contradictions(changed, UNKNOWN)
    assert f"(time zone 1 instead of {1.0 + 0.5 * half_hours:g})" in line


@settings(max_examples=15, deadline=None)
@given(
    rows=st.lists(st.integers(0, 8759), min_size=1, max_size=40),
    values=st.lists(
        st.one_of(
            st.floats(-1e4, 1e4).map(lambda v: f"{v:.1f}"),
            st.sampled_from(["9999", "99999", "9999.0", "-9999", "", "nan", "inf", "x", "1e400"]),
        ),
        min_size=3,
        max_size=3,
    ),
)
def test_any_row_is_light_or_refused(rows, values, year_text, tmp_path_factory):
    """Any cells give finite light within the sun's, or a refusal."""
    lines = year_text.splitlines()
    for row in rows:
        parts = lines[HEAD + row].split(",")
        parts[GHI], parts[DNI], parts[DHI] = values
        lines[HEAD + row] = ",".join(parts)
    path = tmp_path_factory.mktemp("rows") / "year.epw"
    path.write_text("\n".join(lines))
    try:
        weather = read_weather(path)
    except UserError:
        return
    for name in ("direct_normal_w_m2", "diffuse_horizontal_w_m2"):
        light = np.array(getattr(weather, name))
        assert np.isfinite(light).all()
        assert 0.0 <= light.min() <= light.max() <= 1500.0


@pytest.mark.parametrize(
    ("place", "says"),
    [
        ("50.0755,14.4378,200", ""),
        ("-33.9,151.2", "a place 16,088 km away, at 50.1,14.4: its light does not follow this sun"),
    ],
)
def test_weather_of_another_place_is_told(year_file, place, says):
    """A project may hold weather of one place and the sun of another; a town apart is the same."""
    _, told = shared_options(project=Project(weather=str(year_file), place=place))
    assert told.endswith(f"{says}\n") if says else told == ""


def test_a_projects_weather_is_told_too(year_text, tmp_path):
    """A file that a project names is as wrong as one that an option names."""
    path = tmp_path / "year.epw"
    path.write_text(year_text.replace(PLACE, ",50.1,14.4,0.0,", 1))
    assert "time zone 1 instead of 0" in shared_options(project=Project(weather=str(path)))[1]

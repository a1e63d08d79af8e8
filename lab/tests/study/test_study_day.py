"""Measured skies of any day: what is known of it is read, its sources are told, models follow."""

from datetime import date

import numpy as np
import pytest
from scan_writer import FIRST_NM, LAST_NM, STAMP, write_scan
from test_study_measurements import write_npz

from vrut_lite.errors import UserError
from vrut_lite_lab.study.framework.atmosphere import STUDY, StudyAtmosphere
from vrut_lite_lab.study.framework.day import KIDER, MeasuredDay
from vrut_lite_lab.study.framework.measurements import read_measurements
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.models.registry import MODELS
from vrut_lite_lab.study.report.by_angle import EDGES_DEG, errors_by_angle
from vrut_lite_lab.study.report.choices import on_day
from vrut_lite_lab.study.report.moments import Moment, measured_moments

DAY = """place = "Golden, Colorado"
date = 2014-06-03
latitude_deg = 39.74
longitude_deg = -105.18
utc_offset_h = -6
optical_depth_550 = 0.12
angstrom_exponent = 1.4
ozone_du = 320
sources = { optical_depth_550 = "AERONET, NREL-Golden", ozone_du = "OMI" }
"""
TIMES = np.array(["2014-06-03T09:00:00", "2014-06-03T12:00:00"])


@pytest.fixture
def another_day(tmp_path):
    (tmp_path / "day.toml").write_text(DAY)
    nm = np.arange(FIRST_NM, LAST_NM + 1)
    sky = (1.0 + np.arange(81.0)[:, None] + nm / 1000.0)[None]
    return write_npz(
        tmp_path / "skies.npz",
        time=TIMES,
        radiance=np.concatenate([sky, sky]),
    )


def test_another_day_is_read(another_day):
    """Place, clock and sun are those of the file beside the scans."""
    first, noon = read_measurements(another_day)
    assert first.day.place == "Golden, Colorado"
    assert noon.time.isoformat() == "2014-06-03T12:00:00-06:00"
    # An hour before solar noon, at 39.74 degrees north, declination 22.3.
    assert 90.0 - np.degrees(noon.sun_zenith_rad) == pytest.approx(69.0, abs=1.0)


def test_every_input_is_told_with_its_source(another_day):
    """What was given, by whom; what was computed or assumed says so."""
    said = read_measurements(another_day)[0].day.in_words
    assert said.startswith("Golden, Colorado, 3 June 2014: optical depth 550 0.12 (AERONET, NREL")
    assert "ozone du 320 (OMI)" in said
    assert "angstrom exponent 1.4 (no source given)" in said
    assert "sun distance au 1.014 (computed from the date)" in said


def test_the_suns_distance_is_that_of_the_date():
    """Perihelion in January, aphelion in July; Kider's day as the Almanac has it."""
    for month, expected in ((1, 0.9833), (7, 1.0167)):
        day = MeasuredDay(place="", date=date(2014, month, 4), latitude_deg=0, longitude_deg=0,
                  utc_offset_h=0, optical_depth_550=0.1)  # fmt: skip
        assert day.sun_distance == pytest.approx(expected, abs=2e-4)
    computed = MeasuredDay(place="", date=KIDER.date, latitude_deg=0, longitude_deg=0,
                           utc_offset_h=0, optical_depth_550=0.1).sun_distance  # fmt: skip
    assert computed == pytest.approx(KIDER.sun_distance, abs=2e-4)


def test_models_follow_the_day(another_day):
    """Every model gets the day's aerosol; on Kider's day all stay as published."""
    day = read_measurements(another_day)[0].day
    depth = StudyAtmosphere.of_day(day).mie_extinction * STUDY.mie_scale_height_m
    assert np.interp(550.0, WAVELENGTHS_NM, depth) == pytest.approx(0.12, rel=0.01)
    for make in MODELS.values():
        published = make()
        assert on_day(published, KIDER) is published
        other = on_day(published, day)
        assert (other.name, type(other)) == (published.name, type(published))
        assert other is not published


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda text: text.replace("06-03", "06-04"), "is of 2014-06-04, but the skies are of"),
        (lambda text: text.replace("0.12", '"much"'), "optical_depth_550"),
        (lambda text: text + "moon = 1\n", "moon"),
        (lambda text: "{", "day.toml"),
        (None, "need a file day.toml beside them"),
    ],
)
def test_bad_days_are_refused_in_one_line(another_day, change, said):
    """Which file, and what is missing."""
    file = another_day.parent / "day.toml"
    file.unlink() if change is None else file.write_text(change(DAY))
    with pytest.raises(UserError, match=r"^[^\n]+$") as refusal:
        read_measurements(another_day)
    assert said in str(refusal.value)


def test_scans_of_two_days_are_refused(tmp_path):
    """They would share one sun and one aerosol."""
    write_scan(tmp_path / STAMP)
    other = tmp_path / STAMP.replace("27", "28", 1)
    write_scan(other)
    for path in other.iterdir():
        path.rename(path.with_name(path.name.replace("2013-05-27", "2013-05-28")))
    with pytest.raises(UserError, match="holds skies of 2013-05-27 and 2013-05-28"):
        read_measurements(tmp_path)


class TenPercentMore:
    """A model that is a tenth too bright within 45 degrees of the sun."""

    name = title = "more"

    def sky_radiance(self, sun_zenith_rad, view_zenith_rad, relative_azimuth_rad):
        nu = np.sin(sun_zenith_rad) * np.sin(view_zenith_rad) * np.cos(relative_azimuth_rad)
        near = nu + np.cos(sun_zenith_rad) * np.cos(view_zenith_rad) > np.cos(np.radians(45))
        return np.where(near, 1.1, 1.0)[:, None] * np.ones(40)


def test_errors_are_sorted_by_angle_from_the_sun():
    """A model that errs beside the sun alone is told apart from one that errs everywhere."""
    moment = Moment("12:00", 0.7, 2.0, np.ones((81, 40)))
    found = errors_by_angle(TenPercentMore(), [moment], np.ones((1, 81, 40)))
    for low, error in zip(EDGES_DEG[:-1], found.from_sun, strict=True):
        assert np.isnan(error) or error == pytest.approx(0.1 if low < 45 else 0.0, abs=1e-9)
    assert 0.0 < found.of_moments[0] < 0.1
    assert measured_moments([]) == []

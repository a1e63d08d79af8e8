"""Measured skies: order and sense of their samples, three forms of file, and damaged ones."""

from datetime import timedelta

import numpy as np
import pytest
from scan_writer import (
    FIRST_NM,
    LAST_NM,
    STAMP,
    file_content,
    file_lines,
    file_name,
    pack,
    scan_files,
    write_scan,
)

from vrut_lite.errors import UserError
from vrut_lite_lab.study.framework.directions import directions
from vrut_lite_lab.study.framework.measurements import read_measurements
from vrut_lite_lab.study.framework.scan_files import parse_scan, parse_spectrum
from vrut_lite_lab.study.framework.scan_order import sample_of_direction, scan_directions
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM


@pytest.fixture(scope="module")
def whole_scan(tmp_path_factory):
    """A scan that nothing is wrong with."""
    return write_scan(tmp_path_factory.mktemp("scans") / STAMP)


@pytest.fixture
def files():
    """Its files, to damage."""
    return scan_files()


def write_npz(path, **changed):
    """The same sky at one time as npz, with some arrays changed or, if None, left out."""
    nm = np.arange(FIRST_NM, LAST_NM + 1)
    azimuth, elevation = np.array(scan_directions(), dtype=float).T
    arrays = {
        "time": np.array(["11:45:00"]),
        "file_azimuth_deg": azimuth,
        "elevation_deg": elevation,
        "wavelength_nm": nm,
        "radiance": (np.arange(81.0)[:, None] + nm / 1000.0)[None],
    }
    arrays.update(changed)
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    return path


def test_every_direction_gets_the_sample_taken_there():
    """The angles tell: the file's azimuth runs against the usual one."""
    zenith, azimuth = directions()
    samples = sample_of_direction()
    assert sorted(samples) == list(range(81))
    file_azimuth, elevation = np.array(scan_directions(), dtype=float)[samples].T
    np.testing.assert_allclose(90.0 - np.degrees(zenith), elevation, atol=5e-5)
    turn = np.angle(np.exp(1j * (azimuth + np.radians(file_azimuth))))
    np.testing.assert_allclose(turn[samples != 80], 0.0, atol=1e-12)


def test_a_scan_is_resampled_in_order_and_its_faulty_sample_replaced(whole_scan):
    """Linear between whole nm; sample 0, north and low, becomes the mean of samples 1 and 31."""
    (sky,) = read_measurements(whole_scan)
    expected = np.arange(81.0)[:, None] + WAVELENGTHS_NM / 1000.0
    expected[0] = 0.5 * (expected[1] + expected[31])
    np.testing.assert_allclose(sky.radiance, expected[sample_of_direction()], atol=1e-5)
    assert sky.time.isoformat() == "2013-05-27T11:45:00-04:00"


def test_a_folder_an_archive_and_an_npz_tell_the_same(whole_scan, tmp_path):
    """To the digits that the texts have."""
    archive = tmp_path / "scan.7z"
    pack(whole_scan, archive)
    (first,) = read_measurements(whole_scan)
    (packed_sky,) = read_measurements(archive)
    (from_npz,) = read_measurements(write_npz(tmp_path / "sky.npz"))
    np.testing.assert_array_equal(packed_sky.radiance, first.radiance)
    np.testing.assert_allclose(from_npz.radiance, first.radiance, atol=1e-5)
    assert packed_sky.time == from_npz.time == first.time


def test_a_folder_of_scans_is_read_in_the_order_of_time(whole_scan, tmp_path):
    """Folders and archives side by side."""
    write_scan(tmp_path / "b", stamp="2013-05-27___12.00.00")
    pack(whole_scan, tmp_path / "a.7z")
    first, second = read_measurements(tmp_path)
    assert second.time - first.time == timedelta(minutes=15)


def refusal(path):
    """The sentence that reading a path ends with."""
    with pytest.raises(UserError) as refused:
        read_measurements(path)
    return str(refused.value)


def changed_line(number, text):
    """The lines of sample 7 with one of them, counted from 1, changed or, if None, left out."""
    lines = file_lines(7)
    lines[number - 1 : number] = [] if text is None else [text]
    return lines


@pytest.mark.parametrize(
    ("lines", "number", "word"),
    [
        (changed_line(5, "362"), 5, "1 columns"),
        (changed_line(5, "362 0.1 0.2"), 5, "3 columns"),
        (changed_line(5, ""), 5, "0 columns"),
        (changed_line(9, "366 bright"), 9, "'bright' is not a number"),
        (changed_line(9, "366 NaN"), 9, "finite"),
        (changed_line(9, "366 -inf"), 9, "finite"),
        (changed_line(9, "366.5 0.1"), 9, "not a whole number of nm"),
        (changed_line(9, "-366 0.1"), 9, "not a whole number of nm"),
        (changed_line(9, None), 9, "367 follows 365"),
        (changed_line(9, "365 0.1"), 9, "365 follows 365"),
        (file_lines(7)[:400], 400, "359 to 757 nm, but 360 to 819 nm are needed"),
        ([file_lines(7)[0], *file_lines(7)[4:]], 460, "362 to 820 nm, but 360 to 819 nm"),
        (file_lines(7)[1:], 1, "must begin with 'Wavelength'"),
        ([], 1, "must begin with 'Wavelength'"),
        (file_lines(7)[:1], 1, "none"),
        (changed_line(9, "366 0.1°"), 9, "not plain text"),
    ],
)
def test_a_damaged_file_is_refused_by_name_and_line(lines, number, word):
    """Whatever line of it is not a wavelength and a radiance."""
    with pytest.raises(UserError) as refused:
        parse_spectrum(file_content(lines), file_name(7))
    assert str(refused.value).startswith(f"{file_name(7)}, line {number}: ")
    assert word in str(refused.value)


def test_a_damaged_file_of_a_folder_is_refused(tmp_path):
    """The same when a whole folder is read."""
    write_scan(tmp_path)
    (tmp_path / file_name(7)).write_bytes(file_content(changed_line(9, "366 NaN")))
    assert refusal(tmp_path).startswith(f"{file_name(7)}, line 9: ")


def scan_refusal(files):
    """The sentence that a scan of these files ends with."""
    with pytest.raises(UserError) as refused:
        parse_scan(files, "here")
    return str(refused.value)


def test_a_missing_direction_is_refused(files):
    """The sentence names its sample and direction."""
    del files[file_name(33)]
    assert scan_refusal(files).startswith(
        "here: sample 33 of 0 to 80 (file azimuth 330.0, elevation 33.749 deg) is missing"
    )


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ({"azimuth": "11.5"}, "sample 7 must have azimuth 78.75 deg, not 11.5"),
        ({"azimuth": "78.750"}, "sample 7 must have azimuth 78.75 deg, not 78.750"),
        ({"elevation": "33.749"}, "sample 7 must have elevation 12.1151 deg, not 33.749"),
        ({"stamp": "2013-05-27___12.00.00"}, "is of another time than"),
        ({"stamp": "2013-13-27___12.00.00"}, "is no day and hour"),
        ({"stamp": "noon"}, "is not named as a scan's files are"),
    ],
)
def test_a_wrong_name_is_refused(files, name, word):
    """Azimuth and elevation must be the sample's own, and the time one for all."""
    files[file_name(7, **name)] = files.pop(file_name(7))
    sentence = scan_refusal(files)
    assert file_name(7, **name) in sentence
    assert word in sentence


@pytest.mark.parametrize(
    ("extra", "word"),
    [
        (file_name(80).replace("_-_80_", "_-_81_"), "sample 81 is beyond the last one, 80"),
        (file_name(80, stamp="2013-05-27___12.00.00"), "are both sample 80"),
    ],
)
def test_a_sample_too_many_is_refused(files, extra, word):
    """Beyond 80, or one twice."""
    files[extra] = files[file_name(80)]
    sentence = scan_refusal(files)
    assert extra in sentence
    assert word in sentence


def test_files_of_different_wavelengths_are_refused(files):
    """All of a scan must span the same."""
    files[file_name(7)] = file_content(file_lines(7)[:-1])
    assert scan_refusal(files).startswith(f"{file_name(7)}: has wavelengths 359 to 819 nm, but ")


@pytest.mark.parametrize(
    ("changed", "word"),
    [
        ({"radiance": None}, "holds no array radiance"),
        ({"radiance": np.zeros((1, 80, 462))}, "radiance must be of the shape"),
        ({"radiance": np.full((1, 81, 462), np.nan)}, "radiance at 11:45:00, sample 0, 359 nm"),
        ({"file_azimuth_deg": np.zeros(81)}, "file_azimuth_deg is not that of the samples"),
        ({"elevation_deg": np.zeros(80)}, "elevation_deg is not that of the samples"),
        ({"wavelength_nm": np.arange(462) * 2.0}, "wavelength_nm must rise by 1 nm"),
        ({"wavelength_nm": np.arange(400, 862)}, "wavelength_nm must span 360 to 818.25 nm"),
        ({"wavelength_nm": np.array(["360"] * 462)}, "wavelength_nm must hold numbers"),
        ({"time": np.array(["noon"])}, "'noon' among the times is no hour"),
    ],
)
def test_a_damaged_npz_is_refused(tmp_path, changed, word):
    """The sentence names file and array."""
    path = write_npz(tmp_path / "sky.npz", **changed)
    sentence = refusal(path)
    assert sentence.startswith(f"{path}: ")
    assert word in sentence


@pytest.mark.parametrize(
    ("name", "content", "word"),
    [
        ("sky.npz", b"PK\x03\x04 cut short", "is no whole npz"),
        ("sky.npz", b"", "is no whole npz"),
        ("scan.7z", b"7z\xbc\xaf\x27\x1c cut short", "is no whole 7z archive"),
        ("scan.7z", b"", "is no whole 7z archive"),
        ("sky.csv", b"1,2", "come as a folder, a .7z or an .npz"),
    ],
)
def test_a_file_that_is_none_of_them_is_refused(tmp_path, name, content, word):
    """Cut short, empty, or of another kind."""
    path = tmp_path / name
    path.write_bytes(content)
    sentence = refusal(path)
    assert sentence.startswith(f"{path}: ")
    assert word in sentence


def test_an_archive_cut_short_is_refused(whole_scan, tmp_path):
    """As a broken download leaves it."""
    archive = tmp_path / "scan.7z"
    pack(whole_scan, archive)
    content = archive.read_bytes()
    archive.write_bytes(content[: len(content) // 2])
    assert "is no whole 7z archive" in refusal(archive)


def test_an_empty_place_is_refused(tmp_path):
    """A folder without scans, and nothing at all."""
    assert "holds no scans" in refusal(tmp_path)
    assert "there are no measurements" in refusal(tmp_path / "nowhere")


def test_the_published_archive_is_the_npz_at_its_time(one_scan, measured_skies):
    """Kider's own files of 11:45 and the collection of 15 times, to the last digit but one."""
    (scan,) = read_measurements(one_scan)
    (same,) = [sky for sky in measured_skies if sky.time == scan.time]
    np.testing.assert_allclose(scan.radiance, same.radiance, rtol=1e-14)


@pytest.mark.long
def test_the_suns_azimuth_is_estimated_at_all_15_times(measured_skies, reference):
    """The zenith angles of the 15 steps are the published ones of the 17, and the estimate drifts.

    The instrument's north was off by 7 deg at 9:30 and by 17 deg at 13:30: always towards the
    same side, and never at the end of the range of 20 deg, where it would mean nothing.
    """
    minutes = [sky.time.hour * 60 + sky.time.minute for sky in measured_skies]
    steps = (np.array(minutes) - 570) // 15
    zenith_deg = np.degrees([sky.sun_zenith_rad for sky in measured_skies])
    np.testing.assert_allclose(zenith_deg, reference["sun_coordinates_deg"][steps, 0], atol=1e-9)
    off_deg = np.degrees(
        [sky.sun_azimuth_rad - sky.expected_sun_azimuth_rad for sky in measured_skies]
    )
    assert len(off_deg) == 15
    np.testing.assert_allclose(off_deg[[0, 9, 14]], [-7.0, -13.8, -17.2], atol=0.01)
    assert np.all((off_deg > -18.0) & (off_deg < -6.0))

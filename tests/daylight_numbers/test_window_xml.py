"""Measured glazing in LBNL's Window XML: numbers as written, and one sentence for a broken file."""

import numpy as np
import pytest
from daylight_numbers.glazing.angle_basis import KLEMS, KLEMS_FULL
from daylight_numbers.glazing.window_xml import read_window_xml
from window_xml_files import diffuser, opening, window_xml

from vrut_lite.errors import UserError

BASES = list(KLEMS.values())


def read(tmp_path, text):
    path = tmp_path / "glass.xml"
    path.write_text(text)
    return read_window_xml(path)


@pytest.mark.parametrize("basis", BASES, ids=lambda basis: basis.name)
def test_patches_fill_the_hemisphere_and_hold_their_middles(basis):
    """Klems (1994) has 145, 73 and 41; solid angles sum to 2 pi, weighted by the cosine to pi."""
    assert len(basis) in (145, 73, 41)
    np.testing.assert_allclose(basis.solid_sr.sum(), 2 * np.pi)
    np.testing.assert_allclose(basis.projected_sr.sum(), np.pi)
    np.testing.assert_array_equal(basis.patch_of(basis.middles), np.arange(len(basis)))


@pytest.mark.parametrize("basis", BASES, ids=lambda basis: basis.name)
def test_random_directions_hit_patches_by_their_solid_angles(basis):
    """An independent count: even directions over the hemisphere, in each patch by its share."""
    random = np.random.default_rng(1)
    z, turn = random.random(400_000), 2 * np.pi * random.random(400_000)
    level = np.sqrt(1 - z * z)
    patch = basis.patch_of(np.stack([level * np.cos(turn), level * np.sin(turn), z], axis=1))
    expected = basis.solid_sr / (2 * np.pi) * len(z)
    counted = np.bincount(patch, minlength=len(basis))
    assert np.abs((counted - expected) / np.sqrt(expected)).max() < 5.0


def test_azimuth_turns_from_x_to_y_around_the_first_patch_of_a_ring():
    """As bsdf_m.c: patch 0 of a ring has its middle at azimuth 0, the next ones follow to y."""
    ring = np.radians(10.0)
    x = [np.sin(ring), 0.0, np.cos(ring)]
    y = [0.0, np.sin(ring), np.cos(ring)]
    np.testing.assert_array_equal(KLEMS_FULL.patch_of(np.array([x, y])), [1, 3])


@pytest.mark.parametrize("structure", ["Columns", "Rows"])
def test_columns_are_incident_directions_and_rows_where_light_goes(tmp_path, structure):
    """Rows where the file says so; the numbers are those of the text."""
    matrix = np.zeros((145, 145))
    matrix[70, 3] = 0.5
    written = matrix if structure == "Columns" else matrix.T
    found = read(tmp_path, window_xml({"Transmission Front": written}, structure=structure))
    np.testing.assert_array_equal(np.argwhere(found.transmission), [[70, 3]])
    np.testing.assert_allclose(found.hemispherical[3], 0.5 * KLEMS_FULL.projected_sr[70])


def test_transmission_back_alone_is_reversed(tmp_path):
    """By reciprocity: light from 3 to 70 takes the way from 70 to 3.

    The number of a direction is that of its continuation: seen from behind, half a turn further.
    Radiance 6 (`rtrace`, BSDF) has the same light by the file of one side and by that of the other.
    """
    turned = KLEMS_FULL.patch_of(KLEMS_FULL.middles[[3, 70]] * [-1.0, -1.0, 1.0])
    assert turned[0] == 7
    matrix = np.zeros((145, 145))
    matrix[turned[0], turned[1]] = 0.5
    found = read(tmp_path, window_xml({"Transmission Back": matrix}, told=False))
    np.testing.assert_array_equal(np.argwhere(found.transmission), [[70, 3]])


@pytest.mark.parametrize("basis", BASES, ids=lambda basis: basis.name)
def test_a_beam_that_goes_straight_on_is_found_and_a_diffuser_has_none(tmp_path, basis):
    """A half-open diffuser passes 0.4 straight and scatters 0.3 evenly, to what patches resolve."""
    clear = read(tmp_path, window_xml({"Transmission Front": opening(0.9, basis)}, basis))
    np.testing.assert_allclose(clear.straight, 0.9, rtol=1e-6)
    assert clear.scattered.max() == 0.0
    even = read(tmp_path, window_xml({"Transmission Front": diffuser(0.3, basis)}, basis))
    assert even.straight.max() == 0.0
    np.testing.assert_allclose(even.hemispherical, 0.3, rtol=1e-6)
    both = opening(0.4, basis) + diffuser(0.3, basis)
    mixed = read(tmp_path, window_xml({"Transmission Front": both}, basis))
    np.testing.assert_allclose(mixed.straight, 0.4, rtol=1e-6)
    np.testing.assert_allclose(mixed.scattered, 0.3 / np.pi, rtol=1e-6)


def test_reflection_is_the_share_of_even_light(tmp_path):
    """Lambert's reflectance of 0.4 indoors and 0.2 outdoors; back is the side indoors."""
    sides = {
        "Transmission Front": diffuser(0.3),
        "Reflection Front": diffuser(0.2),
        "Reflection Back": diffuser(0.4),
    }
    found = read(tmp_path, window_xml(sides))
    np.testing.assert_allclose((found.reflectance_in, found.reflectance_out), (0.4, 0.2), rtol=1e-6)
    assert found.warnings() == []


def test_more_light_than_falls_in_is_warned_of(tmp_path):
    """With the first of the directions, and by how much."""
    matrix = diffuser(0.5)
    matrix[:, 7] *= 2.2
    found = read(tmp_path, window_xml({"Transmission Front": matrix}))
    (said,) = found.warnings()
    assert "1 of 145 incident directions" in said
    assert "number 8, at most 1.100 times" in said


FINE = window_xml({"Transmission Front": diffuser(0.5)})


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (FINE[:400], "is no XML"),
        ("<Window/>", "root is 'Window', not WindowElement"),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]><WindowElement/>", "defines entities"),
        (FINE.replace(">Columns<", ">TensorTree5<"), "IncidentDataStructure 'TensorTree5'"),
        (FINE.replace(">Columns<", ">Heap<"), "IncidentDataStructure 'Heap'"),
        (FINE.replace(">Visible<", ">Solar<"), "no data for the wavelength Visible; it has Solar"),
        (FINE.replace("Transmission Front", "Reflection Front"), "no visible Transmission Front"),
        (FINE.replace("<UpperTheta>15.0", "<UpperTheta>16.0"), "ring 3 of the angle basis"),
        (FINE.replace("<nPhis>8<", "<nPhis>9<"), "with 146 patches otherwise than LBNL does"),
        (FINE.replace("<nPhis>8<", "<nPhis>x<"), "nphis of an angle basis is 'x', no number"),
        (FINE.replace("RowAngleBasis>LBNL/Klems Full", "RowAngleBasis>Own"), "'Own' is not known"),
        (FINE.replace("0.159154943", "nan", 1), "has nan in row 1, column 1"),
        (FINE.replace("0.159154943", "-1", 1), "has -1 in row 1, column 1"),
        (FINE.replace("0.159154943", "dark", 1), "has no numbers"),
        (FINE.replace("0.159154943,", "", 1), "has 21,024 values: 145 rows of 145 columns"),
    ],
)
def test_a_broken_file_is_refused_in_one_sentence(tmp_path, text, sentence):
    with pytest.raises(UserError, match=sentence) as refusal:
        read(tmp_path, text)
    assert "\n" not in str(refusal.value)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(UserError, match="cannot read the Window XML"):
        read_window_xml(tmp_path / "none.xml")

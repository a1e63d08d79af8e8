"""Tensor trees against functions whose means over Klems's patches are known by hand."""

import numpy as np
import pytest
from daylight_numbers.glazing.angle_basis import KLEMS_FULL
from daylight_numbers.glazing.window_xml import read_window_xml
from tensor_trees import tree_of, tree_xml

from vrut_lite.errors import UserError

MIDDLES = KLEMS_FULL.middles
RING = np.repeat(np.arange(len(KLEMS_FULL.count)), KLEMS_FULL.count)
EDGES_DEG = np.array([0.0, *KLEMS_FULL.upper_deg])


def read(tmp_path, text):
    path = tmp_path / "tree.xml"
    path.write_text(text)
    return read_window_xml(path)


@pytest.mark.parametrize("rank", [3, 4])
@pytest.mark.parametrize(("depth", "grid"), [(0, 0), (1, 1), (2, 0)])
def test_a_constant_tree_is_a_diffuser(tmp_path, rank, depth, grid):
    """However it is divided: 0.6 / pi everywhere, and 0.6 of all light passes."""
    tree = tree_of(lambda at: np.full(len(at), 0.6 / np.pi), rank, depth, grid)
    found = read(tmp_path, tree_xml(tree, rank))
    assert found.incident is KLEMS_FULL
    np.testing.assert_allclose(found.transmission, 0.6 / np.pi, rtol=0.02)
    np.testing.assert_allclose(found.hemispherical, 0.6, rtol=0.003)


def towards(x, y):
    """Which patches (145,) lie wholly in a quadrant, and which touch it, by signs of x and y."""
    turn = np.degrees(np.arctan2(y * MIDDLES[:, 1], x * MIDDLES[:, 0]))
    half = 180.0 / np.array(KLEMS_FULL.count)[RING]
    wholly = (turn > half - 1e-6) & (turn < 90.0 - half + 1e-6) & (RING > 0)
    touching = ((turn > -half - 1e-6) & (turn < 90.0 + half + 1e-6)) | (RING == 0)
    return wholly, touching


def test_axes_of_rank_4_are_incident_x_and_y_then_exiting_x_and_y(tmp_path):
    """Light that would go on to +x and -y leaves to -x and +y: 1 sr^-1 in a quadrant of the
    exiting hemisphere, whose projected solid angle is pi / 4; no other light passes."""

    def scattered(at):
        return ((at > 0.5) == [True, False, False, True]).all(axis=1).astype(float)

    found = read(tmp_path, tree_xml(tree_of(scattered, 4, 1), 4))
    into, from_ = towards(-1, 1), towards(1, -1)
    np.testing.assert_allclose(found.transmission[np.ix_(into[0], from_[0])], 1.0, rtol=0.02)
    assert not found.transmission[~into[1]].any()
    assert not found.transmission[:, ~from_[1]].any()
    np.testing.assert_allclose(found.hemispherical[from_[0]], np.pi / 4, rtol=0.003)


def test_the_back_of_a_glazing_is_read_by_reversed_light(tmp_path):
    """The tree of the way from indoors: light to +x, -y leaves to -x, +y; so light from outdoors
    to +x, -y leaves to -x, +y too, as Helmholtz has it."""

    def scattered(at):
        return ((at > 0.5) == [True, False, False, True]).all(axis=1).astype(float)

    tree = tree_of(scattered, 4, 1)
    front = read(tmp_path, tree_xml(tree, 4)).transmission
    back = read(tmp_path, tree_xml(tree, 4, "Transmission Back")).transmission
    np.testing.assert_allclose(back, front, atol=0.02)


def test_trees_of_rank_3_turn_with_the_incident_azimuth(tmp_path):
    """Light below 30 degrees of incidence alone leaves within 90 degrees of where it would go on:
    (1 - sin 30) / 2 is a quarter of the first axis."""

    def scattered(at):
        return ((at[:, 0] > 0.25) & (at[:, 0] < 0.5) & (at[:, 1] > 0.5)).astype(float)

    found = read(tmp_path, tree_xml(tree_of(scattered, 3, 2), 3))
    # Half a hemisphere is pi / 2; of the ring from 25 to 35 degrees a part lies below 30.
    sine2 = np.sin(np.radians(EDGES_DEG)) ** 2
    share = np.clip((0.25 - sine2[:-1]) / np.diff(sine2), 0.0, 1.0)[RING]
    np.testing.assert_allclose(found.hemispherical, share * np.pi / 2, atol=0.005)
    lit = np.flatnonzero((share == 1.0) & (RING > 0))
    along = MIDDLES[:, :2] @ MIDDLES[lit, :2].T
    along /= np.linalg.norm(MIDDLES[lit, :2], axis=1)
    width = 2.0 * np.pi / np.array(KLEMS_FULL.count)
    # Patches away from the border by half their own and half the incident patch's azimuth.
    level = np.linalg.norm(MIDDLES[:, :2], axis=1)[:, None]
    margin = 0.5 * (width[RING][:, None] + width[RING[lit]][None])
    off = np.arcsin(np.clip(along / np.maximum(level, 1e-9), -1, 1))
    ahead = (off > margin) & (RING > 0)[:, None]
    behind = (off < -margin) & (RING > 0)[:, None]
    np.testing.assert_allclose(found.transmission[:, lit][ahead], 1.0, rtol=0.03)
    assert not found.transmission[:, lit][behind].any()
    # The same hemisphere in the other sense of turning would be 1 where y, not -y, is ahead.
    sideways = tree_of(lambda at: (at[:, 2] > 0.5).astype(float), 3, 1)
    turned = read(tmp_path, tree_xml(sideways, 3)).transmission
    first = 1 + np.arange(8)
    left = KLEMS_FULL.patch_of(np.array([[0.0, 0.6, 0.8], [0.0, -0.6, 0.8]]))
    np.testing.assert_allclose(turned[left, first[0]], [1.0, 0.0], atol=0.02)


def test_leaves_of_many_sizes_are_one_function(tmp_path):
    """A tree whose leaves differ in size beside one of equal leaves, for a function that is
    constant within the larger ones."""

    def steps(at):
        cell = np.floor(at * 2.0)
        return 0.05 + 0.1 * cell @ [1.0, 0.5, 0.25, 0.125]

    random = np.random.Generator(np.random.Philox(key=3))
    mixed = read(tmp_path, tree_xml(tree_of(steps, 4, 2, random=random), 4)).transmission
    even = read(tmp_path, tree_xml(tree_of(steps, 4, 1), 4)).transmission
    np.testing.assert_allclose(mixed, even, rtol=0.02)


GOOD = tree_of(lambda at: np.ones(len(at)), 4, 1)


@pytest.mark.parametrize(
    ("tree", "sentence"),
    [
        (GOOD[:-1], "its braces do not close one tree"),
        (GOOD + "}", "a brace closes that none has opened"),
        (GOOD + GOOD, "its braces do not close one tree"),
        ("{ 1 2 3 }", "a leaf has 3 values"),
        ("{ }", "a leaf has 0 values"),
        ("{ {1} {1} }", "a node has 2 branches in place of 16"),
        ("{" + "{1}" * 17 + "}", "a node has more than 16 branches"),
        ("{ 1 " + GOOD + "}", "a value stands beside a branch"),
        ("{ dark }", "could not convert string to float"),
        ("{ nan }", "values that are not finite"),
    ],
)
def test_what_is_no_tree_is_refused(tmp_path, tree, sentence):
    with pytest.raises(UserError, match=f"is no tensor tree of rank 4: .*{sentence}"):
        read(tmp_path, tree_xml(tree, 4))


def test_other_bases_of_trees_are_refused(tmp_path):
    text = tree_xml(GOOD, 4).replace("LBNL/Shirley-Chiu", "LBNL/Own")
    with pytest.raises(UserError, match="a tree has the angle basis LBNL/Shirley-Chiu, not"):
        read(tmp_path, text)

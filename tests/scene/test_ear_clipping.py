"""Concave polygons keep their shape: triangles of ear clipping cover them, once."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.ear_clipping import clip_ears
from vrut_lite.scene.obj_file import parse_obj

TESTS = 10**9


def areas(flat, triangles):
    """Signed areas of triangles of corners (k, 2)."""
    a, b, c = flat[triangles].transpose(1, 0, 2)
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def area_of(flat):
    """Area of a polygon by the shoelace formula."""
    x, y = flat.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def clipped(flat):
    flat = np.asarray(flat, float)
    return flat, clip_ears(flat, np.array([TESTS]))


@settings(deadline=None)
@given(st.lists(st.floats(0.05, 1.0), min_size=4, max_size=40))
def test_triangles_cover_a_polygon_once(radii):
    """Around a star as spiky as can be: none is turned over, and their areas add up."""
    angles = 2.0 * np.pi * np.arange(len(radii)) / len(radii)
    flat, triangles = clipped(np.stack([np.cos(angles), np.sin(angles)], axis=1) * np.c_[radii])
    found = areas(flat, triangles)
    assert found.min() >= -1e-12
    assert found.sum() == pytest.approx(area_of(flat))
    assert set(triangles.ravel()) == set(range(len(flat)))


def ring(sides, inner):
    """A disc with a hole, joined by a seam."""
    angles = 2.0 * np.pi * np.arange(sides + 1) / sides
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.concatenate([circle, inner * circle[::-1]])


@pytest.mark.parametrize("sides", [3, 4, 5, 12, 60])
@pytest.mark.parametrize("inner", [0.2, 0.45, 0.9])
def test_a_ring_with_a_seam_keeps_its_hole(sides, inner):
    """A fan makes a disc of it."""
    flat, triangles = clipped(ring(sides, inner))
    found = areas(flat, triangles)
    assert found.min() >= -1e-12
    assert found.sum() == pytest.approx(area_of(flat))
    middles = flat[triangles].mean(axis=1)[found > 1e-9]
    assert np.hypot(*middles.T).min() > 0.5 * inner * np.cos(np.pi / sides)


def test_a_polygon_that_crosses_itself_still_ends():
    """Every corner of any polygon is used, and the work is bounded."""
    flat, triangles = clipped([[0, 0], [1, 1], [1, 0], [0, 1], [0.5, 3], [0.5, -3]])
    assert triangles.shape == (4, 3)
    assert clip_ears(flat, np.array([0])).shape == (4, 3)


# An L of 3 square metres about a corner that a fan would cover twice, leaning in space.
L_SHAPE = [(2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 0)]


def obj_area(text):
    """Area of an OBJ's triangles, and the area that their normals say, all to one side."""
    obj = parse_obj(text.encode(), SceneBudget(2**30))
    a, b, c = obj.positions[obj.corners[..., 0]].transpose(1, 0, 2)
    normals = 0.5 * np.cross(b - a, c - a)
    return np.linalg.norm(normals, axis=1).sum(), np.linalg.norm(normals.sum(axis=0))


@pytest.mark.parametrize("first", range(6))
@pytest.mark.parametrize("padding", [0, 60_000])
@pytest.mark.parametrize("sign", ["", "-"])
def test_a_concave_face_of_an_obj_is_not_a_fan(first, padding, sign):
    """Whichever corner is its first, and whether the file is read word by word or by the kernel."""
    order = [(first + n) % 6 for n in range(6)]
    corners = " ".join(f"-{6 - n}" if sign else f"{n + 1}" for n in order)
    rows = "".join(f"v {x} {x + y} {y}\n" for x, y in L_SHAPE)
    padded = rows + f"f {corners} # an L\n" + "# padding\n" * padding
    total, to_one_side = obj_area(padded)
    assert total == pytest.approx(3.0 * 3.0**0.5)
    assert to_one_side == pytest.approx(total)


def test_triangles_that_a_file_says_are_left_as_they_are():
    """A cone's triangles follow each other as a fan's do, and are no polygon."""
    rows = "".join(f"v {x} {y} {z}\n" for x, y, z in [(0, 5, 0), (1, 0, 0), (0, 0, 1), (-1, 0, 0)])
    obj = parse_obj(f"{rows}f 1 2 3\nf 1 3 4\n".encode(), SceneBudget(2**30))
    assert obj.corners[..., 0].tolist() == [[0, 1, 2], [0, 2, 3]]


def test_corners_keep_their_coordinates_and_normals():
    """Concave faces are triangulated; attributes of a corner go with it."""
    rows = "".join(f"v {x} {y} 0\nvt {x} {y}\n" for x, y in L_SHAPE)
    corners = " ".join(f"{n}/{n}" for n in range(1, 7))
    obj = parse_obj(f"{rows}f {corners}\n".encode(), SceneBudget(2**30))
    assert np.array_equal(obj.corners[..., 0], obj.corners[..., 1])
    assert (obj.corners[..., 2] == -1).all()

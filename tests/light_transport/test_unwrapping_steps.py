"""Steps of the unwrapping by themselves: welding, packing, and how their work grows."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from light_transport.layout import facing_groups, overlaps, rectangle_packing, seams
from light_transport.layout.unwrapping import projected
from mesh_scenes import box, grid, sphere


def test_corners_at_one_place_are_one():
    """The first of each; minus zero is zero."""
    points = np.array([[1.0, 2, 3], [0.0, 0, 0], [1, 2, 3], [-0.0, 0, -0.0], [1, 2, 3.0000001]])
    assert seams.welded(points).tolist() == [0, 1, 0, 1, 4]


def test_a_closed_box_has_a_triangle_across_each_edge():
    """Symmetric, with both ends in common; an edge of three triangles has none."""
    corners = np.array(box()[1], np.int32)
    opposite = seams.opposite_edges(corners)
    assert (opposite >= 0).all()
    across = opposite.reshape(-1)
    np.testing.assert_array_equal(across[across], np.arange(36))
    begin, end = corners.reshape(-1), np.roll(corners, -1, axis=1).reshape(-1)
    np.testing.assert_array_equal(begin, end[across])
    fan = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]], np.int32)
    assert (seams.opposite_edges(fan) == seams.NO_EDGE).all()


@given(
    st.lists(st.tuples(st.integers(1, 40), st.integers(1, 40)), max_size=60), st.integers(40, 99)
)
def test_rectangles_lie_within_the_whole_and_apart(sizes, widest):
    """Each texel of the whole belongs to one of them at most."""
    sizes = np.array(sizes, np.int32).reshape(-1, 2)
    corners, (width, height) = rectangle_packing.pack(sizes, widest)
    assert width <= widest
    taken = np.zeros((height, width), int)
    for (x, y), (across, down) in zip(corners, sizes, strict=True):
        taken[y : y + down, x : x + across] += 1
    assert taken.sum() == sizes.prod(axis=1).sum()
    assert taken.max(initial=1) == 1


def test_equal_rectangles_leave_little_room():
    """Hundreds of small charts, as boxes have them."""
    packed = rectangle_packing.pack(np.full((500, 2), (5, 3), np.int32), 4096)
    assert 500 * 15 / np.prod(packed.size) > 0.9


class Counted(np.ndarray):
    """Counts how often elements or rows of it are read."""

    reads = 0

    def __getitem__(self, key):
        Counted.reads += 1
        return (
            np.asarray(super().__getitem__(key))
            if isinstance(key, slice)
            else super().__getitem__(key)
        )


def reads(function, *arrays):
    """How often an interpreted kernel reads its arrays."""
    Counted.reads = 0
    function.py_func(*(a.view(Counted) if isinstance(a, np.ndarray) else a for a in arrays))
    return Counted.reads


@pytest.mark.filterwarnings("ignore:overflow encountered:RuntimeWarning")
def test_work_grows_with_the_number_of_triangles_and_no_faster():
    """Four times the triangles, at most some four times the reads, of a sphere and of a sheet."""

    def place(s, t):
        return 9 * s, 0 * s, 9 * t

    for few, many in ((sphere(12, 6), sphere(24, 12)), (grid(8, 8, place), grid(16, 16, place))):
        work = []
        for points, triangles, *_ in (few, many):
            triangles = np.asarray(triangles, np.int32)
            corners = points[triangles]
            opposite = seams.opposite_edges(seams.welded(points)[triangles])
            across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            length = np.linalg.norm(across, axis=1)
            normals = across / np.maximum(length, 1e-12)[:, None]
            shading = np.repeat(normals[:, None], 3, axis=1)
            groups = facing_groups.facing_groups(normals, 0.5 * length, opposite, shading)
            uv, heights, sizes = projected(groups.of, groups.direction, corners, opposite)
            places, edges = points.view(np.uint64), triangles.astype(np.int64)
            smooth = (normals.copy(), 0.5 * length, opposite, shading)
            work.append([
                reads(seams._firsts_of_rows, places, seams._SCATTER),
                reads(seams._match_edges, edges, np.full_like(triangles, -1)),
                reads(facing_groups._smooth_surfaces, *smooth),
                reads(facing_groups.connected, groups.of, groups.of, opposite),
                reads(overlaps.layers, groups.of, uv, heights, sizes, opposite),
            ])  # fmt: skip
        growth = np.divide(work[1], work[0])
        assert (growth < 4.8).all(), growth

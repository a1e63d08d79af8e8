"""Texels of two charts that meet at a smooth edge: smoothing goes on across it."""

import numpy as np
import pytest
from light_transport.layout.layout import lay_out
from light_transport.surfaces.surfaces import surfaces_of
from mesh_scenes import box, grid, opened, sphere, turned


def laid(scene, texels=4000):
    surfaces = surfaces_of(scene)
    return surfaces, lay_out(scene, surfaces, texels=texels)


def places_m(surfaces, layout, texels):
    """Where texels lie: the middle of each, held inside its owner."""
    row, column = np.divmod(texels, layout.owner.shape[1])
    owner = layout.owner[row, column]
    places = []
    for number, x, y in zip(owner, column + 0.5, row + 0.5, strict=True):
        a, b, c = layout.uv_px[number].astype(float)
        share = np.linalg.lstsq(np.stack([b - a, c - a], axis=1), np.array([x, y]) - a, rcond=None)[
            0
        ]
        share = np.clip(share, 0.0, 1.0)
        share = np.array([1.0 - share.sum(), *share])
        places.append(share @ surfaces.corners_m[number])
    return np.array(places)


def test_a_sphere_is_seamed_all_along_its_charts():
    """Each end of a chart has pairs beside it, each of two texels that lie close together."""
    surfaces, layout = laid(opened(sphere(48, 24)))
    one, two = (places_m(surfaces, layout, texels) for texels in layout.seams.T)
    assert np.linalg.norm(one - two, axis=1).max() < 3.5 * layout.texel_m
    # On a cube's eight corners and twelve edges, wherever it is turned: the charts' borders are
    # the edges both of whose triangles' places in the map differ.
    ends = {}
    for number, corners in enumerate(np.round(surfaces.corners_m, 9)):
        for e in range(3):
            edge = frozenset(map(tuple, (corners[e], corners[(e + 1) % 3])))
            places = layout.uv_px[number, [e, (e + 1) % 3]]
            ends.setdefault(edge, []).append(places.mean(axis=0))
    borders = [
        np.mean(list(edge), axis=0)
        for edge, (first, *others) in ends.items()
        if len(edge) == 2 and any(np.abs(first - other).max() > 0.1 for other in others)
    ]
    assert len(borders) > 60
    for middle in borders:
        assert np.linalg.norm(one - middle, axis=1).min() < 2.0 * layout.texel_m


def test_pairs_are_told_once_and_are_of_two_used_texels():
    """The smaller first, sorted, none twice: who smooths adds each both ways."""
    layout = laid(
        opened(sphere(), grid(24, 1, lambda s, t: (np.sin(6.2 * s), t, np.cos(6.2 * s))))
    )[1]
    seams = layout.seams
    assert (seams[:, 0] < seams[:, 1]).all()
    np.testing.assert_array_equal(seams, np.unique(seams, axis=0))
    assert (layout.owner.reshape(-1)[seams] >= 0).all()


def test_hard_edges_have_no_seams():
    """The sides of a box keep their own light: its normals turn at the edges."""
    points, triangles = box()
    points = points[np.ravel(triangles)]
    sides = np.cross(points[1::3] - points[::3], points[2::3] - points[::3])
    normals = np.repeat(sides / np.linalg.norm(sides, axis=1, keepdims=True), 3, axis=0)
    layout = laid(opened((points, np.arange(36), normals)))[1]
    assert layout.charts == 6
    assert not len(layout.seams)


@pytest.mark.parametrize("turn", [np.eye(4), turned(0.5)], ids=["level", "turned"])
def test_parts_that_go_on_in_each_other_are_seamed(turn):
    """A landscape's tiles, or a floor in two meshes."""
    west = grid(4, 4, lambda s, t: (s, 0 * s, t))
    east = grid(4, 4, lambda s, t: (1 + s, 0 * s, t))
    surfaces, layout = laid(opened(west, east, places=[(0, turn), (1, turn)]))
    if turn is not None and np.allclose(turn, np.eye(4)):
        parts = surfaces.part[layout.owner.reshape(-1)[layout.seams]]
        assert len(parts) > 40
        assert (parts[:, 0] != parts[:, 1]).all()
    one, two = (places_m(surfaces, layout, texels) for texels in layout.seams.T)
    assert np.linalg.norm(one - two, axis=1).max(initial=0.0) < 3.0 * layout.texel_m

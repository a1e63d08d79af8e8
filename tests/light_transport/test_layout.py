"""Where surfaces lie in the light map: each once, little stretched, apart from the others."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from layout_checks import check, laid
from mesh_scenes import box, grid, helix, opened, sphere, turned


@pytest.mark.parametrize(
    ("mesh", "charts", "stretch"),
    [
        (box(), 6, 1.01),
        (sphere(), 6, 2.1),
        (helix(), 5, 1.7),
        (grid(6, 6, lambda s, t: (s, 0.1 * np.sin(9 * s + 7 * t), t)), 1, 1.7),
        (grid(24, 1, lambda s, t: (np.sin(6.2 * s), t, np.cos(6.2 * s))), 5, 2.1),
    ],
    ids=["box", "sphere", "winding ramp", "hills", "cylinder"],
)
@pytest.mark.parametrize("angle", [0.0, 0.6, np.pi / 4])
def test_each_place_of_a_surface_has_its_own_texels(mesh, charts, stretch, angle):
    """However it is turned: few charts, little stretch, no texel twice, no neighbour's light."""
    points, *rest = mesh
    turn = turned(angle)[:3, :3]
    scene = opened((points @ turn.T, rest[0], *(normals @ turn.T for normals in rest[1:])))
    layout = check(scene, stretch, texels=3000)
    assert layout.charts <= charts + (2 if angle else 0)
    assert 2000 < layout.texels < 3300


@given(
    st.integers(1, 30),
    st.integers(3, 30),
    st.integers(0, 2**32 - 1),
    st.sampled_from([3, 50, 2000]),
)
@settings(max_examples=25)
def test_whatever_triangles_there_are_no_two_share_a_texel(triangles, points, seed, texels):
    """Triangles that cross, meet three at an edge, have no area or are twice there."""
    rng = np.random.default_rng(seed)
    places = rng.normal(size=(points, 3)) * rng.choice([0.01, 1.0, 1.0], size=3)
    places = np.round(places, rng.integers(0, 4))
    check(opened((places, rng.integers(0, points, (triangles, 3)))), texels=texels)


def test_what_stands_often_has_one_shape_and_a_place_each():
    """Turned and mirrored boxes are cut alike; one that is stretched or larger is not."""
    mirror, wide, large = np.diag([-1.0, 1, 1, 1]), np.diag([2.0, 1, 1, 1]), np.diag([2.0, 2, 2, 1])
    matrices = [turned(angle, at=(9 * angle, 0, 0)) for angle in (0.0, 1.0, 2.0)]
    matrices += [mirror, wide, large, turned(1.0) @ wide]
    scene = opened(box(), places=[(0, matrix) for matrix in matrices])
    layout = check(scene, 1.01, texels=5000)
    assert layout.message.part_shape.values.tolist() == [0, 0, 0, 0, 1, 2, 1]
    assert len(np.unique(layout.message.part_corner_px.values, axis=0)) == len(matrices)


def test_a_crowd_that_is_turned_at_random_shares_one_shape():
    """Trees, cars: rounding of their matrices does not set them apart."""
    places = [(0, turned(angle, at=(3.0 * angle, 0, 0))) for angle in np.arange(200.0)]
    message = laid(opened(box(), places=places))[1].message
    assert message.shapes.shape[0] == 1
    assert (message.part_shape.values == 0).all()


def test_vertices_are_doubled_where_charts_end_alone():
    """A smooth sheet keeps its vertices; a box's eight become four on each side."""
    sheet = grid(5, 4, lambda s, t: (s, 0.0 * s, t))
    message = laid(opened(sheet, box()))[1].message
    assert [len(message.shape(0).source_vertex), len(message.shape(1).source_vertex)] == [30, 24]


def test_sheets_back_to_back_are_two_charts():
    """Each side of a wall has its own light; the sides' triangles have their edges in common."""
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]] * 2, float)
    layout = check(opened((points, [[0, 1, 2], [0, 2, 3], [6, 5, 4], [7, 6, 4]])), 1.01, texels=500)
    assert layout.charts == 2


def test_what_has_no_surface_gets_no_texels():
    """An empty scene, a scene of a line, an instance that is squeezed into a point."""
    nothing = opened()
    assert laid(nothing)[1].texels == 0
    assert laid(opened(ground=True))[1].texels == 96 * 96
    line = (np.arange(9).reshape(3, 3) * [1.0, 0.0, 0.0], [[0, 1, 2]])
    point = np.diag([0.0, 0.0, 0.0, 1.0])
    _, layout = laid(opened(line, box(), places=[(0, np.eye(4)), (1, point), (1, np.eye(4))]))
    assert layout.message.part_shape.values.tolist() == [-1, -1, 0]
    assert layout.message.probes is None


def test_a_single_triangle_gets_texels():
    """The smallest mesh there is."""
    triangle = (np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0]], float), [[0, 1, 2]])
    assert check(opened(triangle), 1.01, texels=300).charts == 1
    assert check(opened(triangle), 1.01, texel_m=10.0).texels == 1


def test_the_map_keeps_within_its_budget():
    """Texels grow where more would be needed; the wish for fine ones ends at 400,000."""
    assert 8000 < laid(opened(box()), texels=10_000)[1].texels < 10_600
    fine = laid(opened(box()), texel_m=1e-4)[1]
    assert fine.texels < 430_000
    assert fine.texel_m > 1e-3
    assert laid(opened(box()), texel_m=0.1)[1].texel_m == 0.1


def test_a_long_thin_part_fits_into_the_map():
    """A road of 100 km, 2 m wide, beside a house: its texels are longer, not the house's."""
    road = (np.array([[0, 0, 0], [1e5, 0, 0], [1e5, 0, 2], [0, 0, 2]]), [[0, 1, 2], [0, 2, 3]])
    _, layout = laid(opened(road, box((9, 6, 9))), texel_m=0.5)
    assert layout.message.size_px[0] <= 4096
    np.testing.assert_allclose(layout.part_texel_m, [1e5 / 4092, 0.5], rtol=0.01)


def test_foliage_takes_its_light_from_probes():
    """Ten thousand leaves far smaller than texels would fill the map; the wall keeps its texels."""
    rng = np.random.default_rng(1)
    leaves = rng.uniform(2, 3, (10_000, 1, 3)) + rng.normal(0, 1e-3, (10_000, 3, 3))
    wall = grid(1, 1, lambda s, t: (6 * s, 4 * t, 0 * s))
    _, layout = laid(opened((leaves.reshape(-1, 3), np.arange(30_000)), wall), texels=20_000)
    assert layout.message.part_shape.values.tolist() == [-1, 0]
    probes = layout.message.probes
    upper = np.add(probes.lower_m, np.multiply(probes.step_m, np.subtract(probes.counts, 1)))
    assert np.min(probes.lower_m) > 1.9
    assert np.max(upper) < 3.1


def test_a_landscape_is_one_chart():
    """A height field keeps its vertices, however rough it is, with a texel a triangle or so."""
    rng = np.random.default_rng(2)
    bumps = rng.uniform(0, 1, (4, 3))

    def place(s, t):
        height = sum(
            c / (k + 1) * np.sin(9 * (k + 1) * (s * a + t * b)) for k, (a, b, c) in enumerate(bumps)
        )
        return 30 * s, 2 * height, 30 * t  # fmt: skip

    _, layout = laid(opened(grid(60, 60, place)))
    assert layout.charts == 1
    assert layout.message.source_vertex.shape[0] == 61 * 61


def test_the_layout_is_the_same_each_time():
    """A cache finds what was baked by the layout's key."""
    one, two = (laid(opened(sphere(), box(), ground=True))[1] for _ in range(2))
    assert one.message == two.message
    np.testing.assert_array_equal(one.owner, two.owner)
    coarse = laid(opened(sphere(), box(), ground=True), texels=9000)[1]
    assert coarse.message.layout_key != one.message.layout_key

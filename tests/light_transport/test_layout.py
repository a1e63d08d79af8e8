"""Where surfaces lie in the light map: each once, little stretched, apart from the others."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from light_transport.layout import lay_out
from light_transport.surfaces import surfaces_of
from light_transport.texel_owners import UNUSED
from mesh_scenes import box, grid, helix, opened, sphere, turned


def laid(scene, **size):
    surfaces = surfaces_of(scene)
    layout = lay_out(scene, surfaces, **size)
    layout.message.check()
    layout.message.check_arrays()
    return surfaces, layout


def shares(triangle, points):
    """Barycentric coordinates (n, 3) of points (n, 2); None for a triangle without area."""
    a, b, c = np.asarray(triangle, float)
    matrix = np.stack([b - a, c - a], axis=1)
    if abs(np.linalg.det(matrix)) < 1e-7:
        return None
    uv = np.linalg.solve(matrix, (points - a).T).T
    return np.column_stack([1.0 - uv.sum(axis=1), uv])


def middles(layout):
    height, width = layout.owner.shape
    row, column = np.indices((height, width))
    return np.stack([column, row], axis=-1) + 0.5


def check_each_texel_lies_in_one_triangle(layout):
    """By barycentric coordinates of all middles about each triangle."""
    claims = np.zeros(layout.owner.shape, int)
    middle = middles(layout)
    for number, corners in enumerate(layout.uv_px):
        if np.isnan(corners).any():
            continue
        left, top = np.floor(corners.min(axis=0)).astype(int)
        right, bottom = np.ceil(corners.max(axis=0)).astype(int)
        area = (slice(top, bottom), slice(left, right))
        found = shares(corners, middle[area].reshape(-1, 2))
        if found is None:
            continue
        inside = (found > 1e-6).all(axis=1).reshape(bottom - top, right - left)
        claims[area] += inside
        assert (layout.owner[area][inside] == number).all()
    assert claims.max() <= 1


def check_bilinear_look_ups_stay_at_home(surfaces, layout, stretch=5.0, seed=0):
    """The four texels about any place of a triangle are of surfaces close to that place.

    The nearest point of each texel's owner lies within 2.9 texels of the map.
    """
    rng = np.random.default_rng(seed)
    for number, corners in enumerate(layout.uv_px.astype(float)):
        if np.isnan(corners).any():
            continue
        share = np.vstack([np.eye(3), rng.dirichlet(np.ones(3), 4)])
        first = np.floor(share @ corners - 0.5).astype(int)
        column, row = (first[:, None] + [[0, 0], [0, 1], [1, 0], [1, 1]]).reshape(-1, 2).T
        assert min(column.min(), row.min()) >= 0
        owner = layout.owner[row, column]
        assert (owner != UNUSED).all()
        part = surfaces.part[number]
        assert (surfaces.part[owner] == part).all()
        place = np.repeat(share @ surfaces.corners_m[number], 4, axis=0)
        away = np.linalg.norm(surfaces.corners_m[owner] - place[:, None], axis=2).min(axis=1)
        width = np.linalg.norm(np.ptp(surfaces.corners_m[owner], axis=1), axis=1)
        assert (away <= width + 2.95 * stretch * layout.part_texel_m[part]).all()


def check_uv_leads_back(scene, surfaces, layout, stretch=5.0):
    """Vertices of the message stand where the mesh has them; lengths are the texels' own."""
    message, geometry = layout.message, scene.geometry
    first = 0
    for part, mesh_number in enumerate(geometry.part_mesh.values):
        mesh = geometry.mesh(mesh_number)
        rows = slice(first, first + len(mesh.triangles))
        first = rows.stop
        if message.part_shape.values[part] < 0:
            assert np.isnan(layout.uv_px[rows]).all()
            continue
        shape = message.shape(message.part_shape.values[part])
        assert shape.mesh == mesh_number
        np.testing.assert_array_equal(shape.source_vertex[shape.triangles], mesh.triangles)
        uv = shape.uv[shape.triangles] + message.part_corner_px.values[part]
        np.testing.assert_array_equal(uv, layout.uv_px[rows])
        for corners, place in zip(surfaces.corners_m[rows], uv.astype(float), strict=True):
            flat = place[1:] - place[0]
            # Of what is thinner than a tenth of a texel the 1024ths tell no shape.
            if abs(np.linalg.det(flat)) <= 0.1 * max(np.linalg.norm(flat, axis=1).max(), 0.1):
                continue
            lengths = (corners[1:] - corners[0]) / layout.part_texel_m[part]
            widths = np.linalg.svd(np.linalg.solve(flat, lengths), compute_uv=False)
            assert 0.95 < widths[1] < 1.05
            assert 0.95 < widths[0] < stretch


def check(scene, stretch=5.0, **size):
    surfaces, layout = laid(scene, **size)
    check_each_texel_lies_in_one_triangle(layout)
    check_bilinear_look_ups_stay_at_home(surfaces, layout, stretch)
    check_uv_leads_back(scene, surfaces, layout, stretch)
    return layout


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
    assert check(opened(triangle), 1.01, texel_m=10.0).texels == 4


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

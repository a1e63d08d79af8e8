"""What must hold of any layout, checked by other rules than those that made it."""

import numpy as np
from light_transport.layout.layout import lay_out
from light_transport.layout.texel_owners import UNUSED
from light_transport.surfaces.surfaces import surfaces_of


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
    """The check: barycentric coordinates of all middles about each triangle."""
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


def look_ups(layout):
    """Where the corners (F, 3, 2) of triangles are looked up, by the message."""
    message, found = layout.message, np.full(layout.uv_px.shape, np.nan)
    first = 0
    for part, number in enumerate(message.part_shape.values.tolist()):
        if number < 0:
            first = first + np.argmax(~np.isnan(layout.uv_px[first:, 0, 0]))
            continue
        shape = message.shape(number)
        rows = slice(first, first + len(shape.triangles))
        found[rows] = shape.uv[shape.triangles] + message.part_corner_px.values[part]
        first = rows.stop
    return found


def check_bilinear_look_ups_stay_at_home(surfaces, layout, stretch=5.0, seed=0):
    """The texels that a look-up mixes at any place of a triangle are of surfaces close to it.

    The nearest point of each texel's owner lies within 2.9 texels of the map.
    """
    rng = np.random.default_rng(seed)
    for number, corners in enumerate(look_ups(layout)):
        if np.isnan(corners).any():
            continue
        share = np.vstack([np.eye(3), rng.dirichlet(np.ones(3), 4)])
        at = np.round(share @ corners - 0.5, 9)
        # What has no weight is not mixed in: in a chart of one texel's width that beside it.
        first, last = np.floor(at).astype(int), np.ceil(at).astype(int)
        corner = [[0, 0], [0, 1], [1, 0], [1, 1]]
        column, row = np.where(corner, last[:, None], first[:, None]).reshape(-1, 2).T
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
        # A chart of one texel's width is looked up in its middle, wherever it lies in the texel.
        assert np.abs(uv - layout.uv_px[rows]).max() < 0.5
        narrow = uv % 1.0 == 0.5
        np.testing.assert_array_equal(uv[~narrow], layout.uv_px[rows][~narrow])
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

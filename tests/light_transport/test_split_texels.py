"""Light on either side of what stands across a texel: walls thinner than texels, and sheets.

Closed rooms stand in the sun on a floor that goes on outdoors. Little light gets in.
"""

import numpy as np
import pytest
from boxes import box, floor, hour, quads
from light_transport.layout.layout import lay_out
from light_transport.rays.map_texels import CELLS, PLACES, has_place
from light_transport.rays.ray_table import columns_and_rays
from light_transport.surfaces.surfaces import surfaces_of
from light_transport.transport import SceneTransport
from light_transport.view.point_light import light_at
from mesh_scenes import box as mesh_box
from mesh_scenes import opened

HALF_M, HIGH_M, TEXELS = 1.0, 2.0, 16
# Of the floor, which is of 8 m.
TEXEL_M = 8.0 / TEXELS
SUN = hour(5.0, irradiance=100.0, key=(0.4, 0.7, 0.2))


def room_of(thick_m):
    """The quads of a room whose walls have two sides that are so far apart."""
    inner = box((-HALF_M, 0.0, -HALF_M), (HALF_M, HIGH_M, HALF_M), inwards=True)
    out = HALF_M + thick_m
    outer = box((-out, -0.01, -out), (out, HIGH_M + thick_m, out))
    return [*outer, *(side for k, side in enumerate(inner) if k != 3)]


def sheet_room():
    """Four walls and a lid without thickness, seen from outside, that reach beyond each other."""
    longer = HALF_M + 0.2
    sides = box((-HALF_M, 0.0, -HALF_M), (HALF_M, HIGH_M, HALF_M))
    walls = []
    for k in (0, 1, 2, 4, 5):
        side = np.array(sides[k])
        along = np.ptp(side, axis=0) > 0.0
        along[1] = False
        walls.append(np.where(along, np.sign(side) * (longer + 0.01 * k), side))
    return walls


def rows_inside(transport, scene):
    """Rows that lie in the room and face it: of the floor, and of walls."""
    surfaces, texels = scene[0], transport.texels
    place = texels.place.astype(float) * surfaces.radius_m + surfaces.centre_m
    towards = np.array([0.0, 0.5 * HIGH_M, 0.0]) - place
    faces = np.einsum("ni,ni->n", texels.normal, towards) > 0.0
    edge = np.array([HALF_M, HIGH_M, HALF_M]) + 1e-3
    on_floor = texels.triangle < 2
    inner = (np.abs(place[:, [0, 2]]) < HALF_M - 1e-3).all(axis=1)
    return faces & (np.abs(place) < edge).all(axis=1) & (~on_floor | inner)


def arrives(transport):
    """What rays bring to each row (N,), of one colour."""
    light = transport.column_light(SUN)[:, 1]
    column, rays = columns_and_rays(transport.table.entry)
    sums = np.add.reduceat(np.append(light[column] * rays, 0.0), transport.table.start[:-1])
    return np.where(
        np.diff(transport.table.start) > 0, sums / np.maximum(transport.table.valid, 1), 0.0
    )


@pytest.mark.parametrize("shift", [0.0, 0.11, 0.26, 0.37])
@pytest.mark.parametrize(
    ("thick_m", "share"), [(None, 0.25), (0.1 * TEXEL_M, 0.1), (0.6 * TEXEL_M, 1e-4)]
)
def test_a_room_of_thin_walls_is_dark_in_the_mean(thick_m, share, shift):
    """Wherever walls cross the texels of a floor that is one with that outdoors. The room is four
    of these wide: a quarter of a texel, which is told to lie on one side, is much of it."""
    ground = floor(-4.0 + shift, 4.0 + shift, -4.0 + 0.7 * shift, 4.0 + 0.7 * shift)
    walls = sheet_room() if thick_m is None else room_of(thick_m)
    scene = quads(ground, *walls, texels=TEXELS, reflectance=0.8, double_sided=thick_m is None)
    transport = SceneTransport(*scene, patch_texels=3.0)
    transport.add_rays(64)
    inside, light = rows_inside(transport, scene), arrives(transport)
    assert inside.sum() > 100
    found = light[: len(inside)][inside & transport.good[: len(inside)]].mean()
    assert found < share * np.median(light[: TEXELS**2])


def test_cells_lie_on_one_side_of_what_cuts_their_texel():
    """A sheet on a floor: by places in double precision, rays begin at all of a texel that lies on
    the side of its middle and nowhere else, and no cell that lies beyond shows the texel itself."""
    ground = floor(-4.0, 4.0, -4.0, 4.0)
    at = 0.3 * TEXEL_M
    sheet = [[-3.0, 0.0, at], [3.0, 0.0, at], [3.0, 2.0, at], [-3.0, 2.0, at]]
    scene = quads(ground, sheet, texels=TEXELS, double_sided=True)
    texels = SceneTransport(*scene).texels
    place = texels.place.astype(float) * scene[0].radius_m + scene[0].centre_m
    on_floor = np.flatnonzero((texels.triangle < 2) & (texels.side > 0.0))
    row = on_floor[(np.abs(place[on_floor, 0]) < 2.4)]
    row = row[np.abs(place[row, 2] - at) < 0.5 * TEXEL_M]
    assert len(row) > 5
    assert (texels.cut[row] >= 0).all()
    # Texels of the floor's quad run with z from its first corner, the south.
    cell = (np.arange(CELLS * CELLS) // CELLS + 0.5) / CELLS - 0.5
    place_row = (np.arange(PLACES * PLACES) // PLACES + 0.5) / PLACES - 0.5
    for i in row:
        z = place[i, 2] - cell * TEXEL_M
        same = (z - at) * (place[i, 2] - at) > 0.0
        straddles = np.abs(z - at) < 0.5 * TEXEL_M / CELLS
        begins = [has_place(texels.begins[i], k) for k in range(PLACES * PLACES)]
        begins_z = place[i, 2] - place_row * TEXEL_M
        np.testing.assert_array_equal(begins, (begins_z - at) * (place[i, 2] - at) > 0.0)
        shown = texels.cell_row[texels.cut[i]]
        assert (shown[same & ~straddles] == i).all()
        beyond = shown[~same & ~straddles]
        assert (beyond != i).all()
        assert ((place[beyond, 2] - at) * (place[i, 2] - at) < 0.0).all()


def test_rays_begin_evenly_in_what_a_chart_covers_of_its_border_texels():
    """A box whose sides are no whole number of texels: rays begin at the places of a texel that its
    own side covers, not on the edge instead of beyond, which would be as dark as the edge."""
    scene = opened(mesh_box((1.03, 0.58, 0.71)))
    surfaces = surfaces_of(scene)
    layout = lay_out(scene, surfaces, 0.1)
    texels = SceneTransport(surfaces, layout).texels
    places = np.array(list(np.ndindex(PLACES, PLACES)))[:, ::-1]
    partly = 0
    for i in np.flatnonzero(texels.side > 0.0):
        chart = layout.chart == layout.chart[texels.triangle[i]]
        lower, upper = layout.uv_px[chart].min(axis=(0, 1)), layout.uv_px[chart].max(axis=(0, 1))
        at = texels.pixel[i] + (places + 0.5) / PLACES
        inside = ((at >= lower) & (at <= upper)).all(axis=1)
        begins = [has_place(texels.begins[i], k) for k in range(PLACES * PLACES)]
        if inside.any():
            np.testing.assert_array_equal(begins, inside)
            partly += not inside.all()
    assert partly > 50


def test_what_sticks_out_of_a_wall_is_lit_as_outdoors():
    """Boxes without backs, most of each inside a house, where rays meet the other boxes too: of
    their tops, bottoms and ends, one texel each, the light is that of points outdoors."""
    house = box((-3.0, 0.0, -2.0), (0.0, 4.0, 2.0))
    out_m = 0.06
    ledges = []
    for y in (0.6, 1.4, 2.2):
        for z in (-1.2, -0.4, 0.4, 1.2):
            sides = box((-0.1, y, z - 0.3), (out_m, y + 0.4, z + 0.3))
            ledges += [side for k, side in enumerate(sides) if k != 1]
    scene = quads(floor(-8.0, 8.0, -8.0, 8.0), *house, *ledges, texels=1)
    transport = SceneTransport(*scene)
    transport.add_rays(64)
    texels, surfaces = transport.texels, scene[0]
    beside = np.abs(texels.normal[:, 0]) < 0.1
    rows = np.flatnonzero((surfaces.part[texels.triangle] > len(house)) & beside)
    assert len(rows) == 4 * 12
    place_m = texels.place[rows].astype(float) * surfaces.radius_m + surfaces.centre_m
    place_m[:, 0] = 0.5 * out_m
    even = hour(1.0)
    there = light_at(
        transport, place_m, texels.normal[rows].astype(float), transport.light(even), rays=512
    )
    column, line = texels.pixel[rows].T
    light = transport.light(even).texels[line, column, 1]
    assert light == pytest.approx(there.irradiance_rgb[:, 1], rel=0.15)

"""Sensors: found in rooms, or told in a file; what is wrong with them is said in one line."""

import numpy as np
import pytest
from boxes import box, floor, quads
from daylight_numbers.glazing.glass import no_glass
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors, read_sensors
from daylight_numbers.matrix.work_planes import work_planes
from daylight_numbers.sky_cells import CELLS, cell_directions, cell_of
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from light_transport.transport import SceneTransport

from vrut_lite.errors import UserError


def bake_of(*pieces):
    surfaces, layout = quads(*pieces)
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(64)
    return transport


def house(width, middle):
    """Two rooms side by side, 3 m high, with a table of 0.75 m in the first; walls are 0.2 m."""
    pieces = [*box((0, 0, 0), (middle - 0.1, 3, 4), inwards=True)]
    pieces += box((middle + 0.1, 0, 0), (width, 3, 4), inwards=True)
    return pieces + box((1, 0, 1), (2, 0.75, 3))


def test_a_grid_lies_in_each_room_above_its_table_and_not_in_walls():
    transport = bake_of(*house(8.0, 5.0))
    found = work_planes(transport, np.zeros(3), np.array([8.0, 3.0, 4.0]))
    assert found.names == ("room 1", "room 2")
    np.testing.assert_allclose(found.places_m[:, 1], 0.85, atol=2e-3)
    areas = np.bincount(found.plane) * found.step_m[0] ** 2
    np.testing.assert_allclose(areas, [4.9 * 4.0, 2.9 * 4.0], rtol=0.15)
    edge = np.abs(found.places_m[:, [2]] - [[0.0, 4.0]]).min(axis=1)
    assert not found.inner[edge < 0.49].any()
    assert found.inner[(edge > 0.51) & (np.abs(found.places_m[:, 0] - 2.5) < 1.5)].all()


def test_open_ground_has_a_grid_where_there_is_no_room():
    found = work_planes(
        bake_of(floor(-3, 3, -3, 3)), np.array([-3, 0, -3.0]), np.array([3, 1, 3.0])
    )
    assert found.names == ("open ground 1",)
    assert len(found) == 144


def planes_of(*pieces):
    """Names, heights of floors and areas of the planes that are found."""
    points = np.array(pieces, float).reshape(-1, 3)
    found = work_planes(bake_of(*pieces), points.min(axis=0), points.max(axis=0))
    areas = np.bincount(found.plane) * np.square(found.step_m)
    first = np.searchsorted(found.plane, np.arange(len(found.names)))
    return found.names, found.places_m[first, 1] - 0.85, areas


def test_a_flat_roof_is_no_floor_of_a_house():
    """A terrace with a parapet of 1.1 m lies on a room with a door to a garden."""
    room = box((0, 0, 0), (6, 3, 5), inwards=True)[1:]
    roof = box((-0.2, 3.2, -0.2), (6.2, 3.4, 5.2))
    parapet = [
        *box((-0.2, 3.4, -0.2), (0.0, 4.5, 5.2)), *box((6.0, 3.4, -0.2), (6.2, 4.5, 5.2)),
        *box((-0.2, 3.4, -0.2), (6.2, 4.5, 0.0)), *box((-0.2, 3.4, 5.0), (6.2, 4.5, 5.2)),
    ]  # fmt: skip
    names, floors, areas = planes_of(*room, *roof, *parapet, floor(-8, 14, -8, 13))
    assert names == ("room 1",)
    np.testing.assert_allclose(floors, 0.0, atol=2e-3)
    np.testing.assert_allclose(areas, 30.0, rtol=0.15)


def test_a_hall_that_is_open_at_one_end_is_a_room():
    """Neither its roof, which is as large, nor the sills of its windows are floors."""
    walls = [
        *box((-0.5, 0, 0), (0, 8, 20)), *box((10, 0, 0), (10.5, 8, 20)),
        *box((-0.5, 0, 20), (10.5, 3, 22)), *box((-0.5, 7, 20), (10.5, 8, 22)),
        *box((-0.5, 8, 0), (10.5, 8.5, 22)),
    ]  # fmt: skip
    names, floors, areas = planes_of(*walls, floor(0, 10, 0, 20))
    assert names == ("room 1",)
    np.testing.assert_allclose(floors, 0.0, atol=2e-3)
    np.testing.assert_allclose(areas, 200.0, rtol=0.15)


def test_a_yard_among_houses_is_a_court_and_a_street_is_open_ground():
    """Their roofs are larger."""
    sides = [*box((-9, 0, -14), (-4, 9, 14)), *box((4, 0, -14), (9, 9, 14))]
    ends = [*box((-4, 0, -14), (4, 9, -5)), *box((-4, 0, 5), (4, 9, 14))]
    names, floors, areas = planes_of(*sides, *ends, floor(-9, 9, -14, 14))
    assert names == ("court 1",)
    np.testing.assert_allclose(floors, 0.0, atol=2e-3)
    np.testing.assert_allclose(areas, 80.0, rtol=0.15)
    names, floors, areas = planes_of(*sides, floor(-9, 9, -14, 14))
    assert names == ("open ground 1",)
    np.testing.assert_allclose(floors, 0.0, atol=2e-3)
    np.testing.assert_allclose(areas, 224.0, rtol=0.15)


def test_a_roof_on_columns_is_no_room_unless_there_is_nothing_else():
    columns = [
        side for x in (0, 4.6) for z in (0, 4.6) for side in box((x, 0, z), (x + 0.4, 3, z + 0.4))
    ]
    pavilion = [*columns, *box((-0.5, 3, -0.5), (5.5, 3.3, 5.5))]
    names, floors, _ = planes_of(*pavilion, floor(-8, 12, -8, 12))
    assert names == ("open ground 1",)
    np.testing.assert_allclose(floors, 0.0, atol=2e-3)
    assert planes_of(*pavilion, floor(0, 5, 0, 5))[0] == ("covered ground 1",)


def test_a_scene_without_floors_has_no_work_planes():
    wall = [[[0, 0, 0], [0, 3, 0], [0, 3, 3], [0, 0, 3]]]
    with pytest.raises(UserError, match="no work plane"):
        work_planes(bake_of(*wall), np.zeros(3), np.array([0.1, 3.0, 3.0]))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "has no sensors"),
        ("x,y,z\n", "has no sensors"),
        ("1,2\n", "has 2 numbers"),
        ("1,2,nan\n", "sensor 1 .* no finite"),
        ("x,y,z\n1,2,3\n1,b,3\n", "line 3 of .* no numbers"),
        ("O,0.85,0\n1,2,3\n", "line 1 of .* no numbers: O,0.85,0"),
        ("# desks\n\n1;0,85;0\n", "line 3 of .* has 2 numbers.* commas between"),
        ("1,2,3\n1_0,2,3\n", "line 2 of .* no numbers"),
        ("1,2,3,0,0,0\n", "direction of no length"),
    ],
)
def test_a_bad_file_of_sensors_is_refused_in_one_line(tmp_path, text, sentence):
    path = tmp_path / "desks.csv"
    path.write_text(text)
    with pytest.raises(UserError, match=sentence):
        read_sensors(path)


ROWS = st.lists(
    st.tuples(*[st.floats(-50.0, 50.0, width=32)] * 3).map(lambda row: ",".join(map(repr, row))),
    min_size=1,
    max_size=6,
)
BESIDE = st.lists(st.sampled_from(["", "# desks", ",,", " "]), max_size=3)


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    ROWS,
    BESIDE,
    st.sampled_from(["", "x,y,z\n", '"East (m)",up,south,\n']),
    st.sampled_from(["\n", "\r\n", "\r"]),
    st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "utf-16-le"]),
    st.sampled_from(["", ",", " , ", "\x1a"]),
)
def test_every_row_is_a_sensor_whatever_program_wrote_the_file(
    tmp_path, rows, beside, heading, line_end, encoding, behind
):
    """Spreadsheets add marks, empty cells and rows; not one sensor may be lost to them."""
    text = "\n".join([*beside, heading + "\n".join(rows)]) + behind
    path = tmp_path / "desks.csv"
    path.write_bytes(text.replace("\n", line_end).encode(encoding))
    found = read_sensors(path).places_m
    assert np.array_equal(found, [[float(cell) for cell in row.split(",")] for row in rows])


def test_a_file_of_sensors_looks_up_unless_it_says_where(tmp_path):
    path = tmp_path / "desks.csv"
    path.write_text("x,y,z,dx,dy,dz\n1,2,3\n4,5,6,0,0,-2\n")
    found = read_sensors(path)
    np.testing.assert_allclose(found.normals, [[0, 1, 0], [0, 0, -1]])


def test_sensors_inside_a_body_are_refused():
    transport = bake_of(*box((0, 0, 0), (1, 1, 1)), floor(-3, 3, -3, 3))
    sensors = free_sensors([[2.0, 0.5, 0], [0.5, 0.5, 0.5]], [[0, 1.0, 0]] * 2, "desks")
    with pytest.raises(UserError, match=r"1 of 2 sensors lie inside .* 0.500, 0.500, 0.500"):
        operator_of(transport, no_glass(len(transport.texels.triangle)), sensors, 0.05)


def test_cells_of_the_sky_hold_the_directions_that_are_spread_over_them():
    directions = cell_directions().reshape(-1, 3)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)
    np.testing.assert_array_equal(cell_of(directions), np.repeat(np.arange(CELLS), 4))


def test_numbers_do_not_depend_on_threads():
    transport = bake_of(floor(-3, 3, -3, 3), *box((0, 0, 0), (1, 1, 1)))
    places = np.column_stack([np.linspace(-2, 2, 40), np.full(40, 1.5), np.zeros(40)])
    sensors = free_sensors(places, np.tile([0.0, 1.0, 0.0], (40, 1)), "row")
    glass = no_glass(14)
    one, two = (operator_of(transport, glass, sensors, 0.05, threads) for threads in (1, 2))
    assert (one.halves[0].seen[0] != two.halves[0].seen[0]).nnz == 0
    assert (one.halves[1].sent[0] != two.halves[1].sent[0]).nnz == 0

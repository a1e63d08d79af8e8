"""Blinds: light by sides of a room against the same room with a side walled up."""

import numpy as np
import pytest
from boxes import box, quads
from daylight_numbers.glazing.glass import no_glass
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.rooms import SIDES, room_box, room_of
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.blinds import shaded_year
from daylight_numbers.year.side_light import side_light
from daylight_numbers.year.year import annual, solved_year, year_matrices, year_of
from daylight_numbers.year.year_light import HOURS, YearLight
from light_transport.rays.sky_nodes import GROUND_NODE
from light_transport.transport import SceneTransport

EAST, SOUTH = SIDES.index("+x (east)"), SIDES.index("+z (south)")
PLACES = [[x, 0.8, z] for x in (-1.5, 0.0, 1.5) for z in (-1.5, 0.0, 1.5)]


def frame(corner, edge, other, hole):
    """Quads around a hole (shares of two edges) in a wall, and one that fills the hole."""
    corner, edge, other = (np.asarray(v, float) for v in (corner, edge, other))
    a0, a1, b0, b1 = hole
    return [
        [corner + u * edge + v * other for u, v in ((u0, v0), (u1, v0), (u1, v1), (u0, v1))]
        for u0, u1, v0, v1 in (
            (0, a0, 0, 1), (a1, 1, 0, 1), (a0, a1, 0, b0), (a0, a1, b1, 1), hole,
        )
    ]  # fmt: skip


def room(walled=None):
    """A room of 4 x 4 x 3 m with a window in the east and a door in the south.

    One of them may be walled up, in black: closed blinds send nothing back.
    """
    walls = box((-2, 0, -2), (2, 3, 2), inwards=True)
    window = frame((2, 0, -2), (0, 0, 4), (0, 3, 0), (0.25, 0.75, 1 / 3, 2 / 3))
    door = frame((2, 0, 2), (-4, 0, 0), (0, 3, 0), (0.5, 0.8, 0.05, 0.7))
    pieces = [walls[1], walls[2], walls[3], walls[5], *window[:4], *door[:4]]
    pieces += [{EAST: window, SOUTH: door}[walled][4]] if walled is not None else []
    surfaces, layout = quads(*pieces, reflectance=0.5)
    if walled is not None:
        surfaces.reflectance_rgb[-2:] = 0.0
    transport = SceneTransport(surfaces, layout, patch_texels=2.0)
    transport.add_rays(512)
    glass = no_glass(len(surfaces.part))
    sensors = free_sensors(PLACES, np.tile([0, 1.0, 0], (len(PLACES), 1)), "room")
    return DaylightWork(transport, glass, sensors, operator_of(transport, glass, sensors, 0.02))


def year_light(directions, sky=50.0, sun=100.0):
    """Noon of some days, with these suns."""
    towards = np.asarray(directions, float)
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    hours = np.arange(len(towards)) * HOURS + 12
    skies = np.full((len(towards), GROUND_NODE + 1, 3), sky, np.float32)
    return YearLight(
        hours, skies, towards, np.full((len(towards), 3), sun), np.full(3, 0.2), "test"
    )


@pytest.fixture(scope="module")
def open_room():
    return room()


def test_a_room_s_box_lies_on_its_walls(open_room):
    """Though a part of two walls is open."""
    found = room_box(open_room.transport, open_room.sensors.places_m, 0.0)
    np.testing.assert_allclose(found.lower_m[[0, 2]], [-2.0, -2.0], atol=1e-4)
    np.testing.assert_allclose(found.upper_m, [2.0, 3.0, 2.0], atol=1e-4)


def test_sides_bring_what_is_missing_where_the_other_is_walled_up(open_room):
    """Both sides together are the whole, and each alone is the room without the other."""
    light = year_light([[1.0, 0.8, 0.1]], sun=0.0)
    solved = solved_year(open_room.transport, light)
    sensors, operator = open_room.sensors, open_room.operator
    box_of, openings = room_of(open_room, 0)
    assert [opening.side for opening in openings] == [EAST, SOUTH]
    np.testing.assert_allclose([opening.area_m2 for opening in openings], [2.0, 2.34], rtol=0.1)
    found = side_light(open_room.transport, operator, sensors, box_of, openings, solved)
    by_side = {
        opening.side: found.of_year(n, light, solved)[:, 0] for n, opening in enumerate(openings)
    }
    whole = annual(open_room, light).total[:, 0]
    np.testing.assert_allclose(by_side[EAST] + by_side[SOUTH], whole, rtol=2e-3)
    walled = annual(room(walled=SOUTH), light).total[:, 0]
    print(by_side, walled, whole)
    np.testing.assert_allclose(by_side[EAST], walled, rtol=0.06)


def test_blinds_close_against_the_sun_and_let_their_share_through(open_room):
    """Of three hours the second has sun in the east; closed blinds let 5 % through, evenly."""
    light = year_light([[-1.0, 0.8, 0.1], [1.0, 0.5, 0.1], [0.1, 0.9, 0.0]])
    light.sun_irradiance_rgb[2] = 0.0
    solved = solved_year(open_room.transport, light)
    year = year_of(year_matrices(open_room, light, solved), light)
    known = room_of(open_room, 0)
    assert not known.is_lit_by_roof
    found = shaded_year(open_room, 0, known, year, light, solved)
    assert found.closed_h == {SIDES[EAST]: 1, SIDES[SOUTH]: 0}
    np.testing.assert_allclose(found.total[:, [0, 2]], year.total[:, [0, 2]], rtol=1e-4)
    opaque = shaded_year(open_room, 0, known, year, light, solved, transmittance=0.0)
    walled = annual(room(walled=EAST), light).total[:, 1]
    print(opaque.total[:, 1], walled, found.total[:, 1], year.total[:, 1])
    np.testing.assert_allclose(opaque.total[:, 1], walled, rtol=0.1, atol=0.03 * walled.mean())
    assert (found.total[:, 1] > opaque.total[:, 1]).all()

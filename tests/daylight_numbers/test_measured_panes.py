"""Panes of measured glazing against analytic truth: diffusers, openings, and energy."""

import numpy as np
import pytest
from boxes import box, hour, quads
from daylight_numbers.glazing.angle_basis import KLEMS, KLEMS_FULL
from daylight_numbers.glazing.glass import no_glass
from daylight_numbers.glazing.pane_materials import PaneMaterials
from daylight_numbers.glazing.window_xml import MeasuredGlazing
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.now import hour_at_sensors, sun_shares
from daylight_numbers.sky_cells import CELLS
from daylight_numbers.work import DaylightWork, bounces_of
from daylight_numbers.year.year import annual
from light_transport.transport import SceneTransport
from light_years import year_like
from pane_rooms import HALF, HEIGHT, NORMALS, PLACES, UP, Room, glazing
from scipy.sparse import csr_matrix
from window_xml_files import diffuser, opening

from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.geometry.cube_map import texel_directions

QUARTER = KLEMS["lbnl/klems quarter"]


def of_pane(place, normal, count=400):
    """Irradiance by a pane of radiance 1: the sum over its area."""
    y = HEIGHT * (np.arange(count) + 0.5) / count
    z = 2 * HALF * (np.arange(count) + 0.5) / count - HALF
    away = np.stack(np.broadcast_arrays(HALF, y[:, None], z[None]), axis=-1) - place
    distance = np.linalg.norm(away, axis=-1)
    cosine = np.maximum(away @ normal, 0.0) / distance
    return float(np.sum(cosine * away[..., 0] / distance**3) * HEIGHT * 2 * HALF / count**2)


@pytest.mark.parametrize("pane", ["inwards", "outwards", "body"])
def test_a_diffuser_shines_as_lamberts_law_says(pane):
    """Under an even sky and ground of radiance 2 a pane of 0.6 has the radiance 0.6 x 2 from all
    directions, whichever side of its triangles looks outdoors, also as a body 2 cm thick; walls
    are black."""
    room = Room(diffuser(0.6), pane=pane)
    found = room.lux(hour(2.0), PLACES, NORMALS)
    truth = [1.2 * LUMENS_PER_WATT * of_pane(*each) for each in zip(PLACES, NORMALS, strict=True)]
    np.testing.assert_allclose(found.total, truth, rtol=0.01)
    assert found.sun.max() == 0.0


def test_a_diffuser_in_the_sun_shines_by_the_light_that_falls_on_it():
    """A sun of 5 W m^-2 at 60 degrees from the pane's normal: 0.6 x 5 cos 60 / pi."""
    key = np.array([0.5, 0.5, np.sqrt(0.5)])
    found = Room(diffuser(0.6)).lux(hour(0.0, key=key, irradiance=5.0), PLACES, NORMALS)
    radiance = 0.6 * 5.0 * 0.5 / np.pi
    truth = [
        radiance * LUMENS_PER_WATT * of_pane(*each) for each in zip(PLACES, NORMALS, strict=True)
    ]
    np.testing.assert_allclose(found.surfaces, truth, rtol=0.01)
    assert found.sky.max() == 0.0


def gradient():
    """A sky that differs in all directions, and a sun."""
    directions = texel_directions(32)
    cube = 1.0 + directions[..., 1] + 0.5 * directions[..., 2]
    cube = np.repeat(cube[..., None], 3, axis=-1).astype(np.float32)
    return hour(0.5, key=(1.0, 0.8, 0.4), irradiance=3.0, ground=0.3, cube=cube)


@pytest.mark.parametrize("pane", ["inwards", "body"])
def test_what_lets_all_light_straight_on_is_an_opening(pane):
    """Sky, sun and bounces, beside the same room without a pane."""
    light = gradient()
    found = Room(opening(), 0.5, pane=pane).lux(light, PLACES, NORMALS)
    truth = Room(None, 0.5).lux(light, PLACES, NORMALS)
    np.testing.assert_allclose(found.sun, truth.sun, rtol=1e-5)
    np.testing.assert_allclose(found.sky, truth.sky, rtol=0.01)
    np.testing.assert_allclose(found.surfaces, truth.surfaces, rtol=0.03)


def test_walls_behind_a_diffuser_brighten_by_all_bounces():
    """Energy: what comes in by a pane of 0.6 that sends nothing back is what walls of 0.5 and the
    pane absorb, by the radiosity of patches."""
    room = Room(diffuser(0.6), 0.5, rays=1024)
    bounces, patches = room.bounces, room.transport.patches
    dark = np.zeros((len(patches.area), 3)), np.zeros((bounces.panes.exiting, 3))
    found = bounces.more_radiosity(
        np.full((CELLS + 1, 3), 2.0), *dark, UP[0], np.zeros(3), (0.2,) * 3
    )[:, 0]
    area = patches.area * room.surfaces.radius_m**2
    # A wall that sends a half of its light absorbs the other.
    by_walls = found @ area
    exchange = room.transport.cache.patch_transfer
    share = csr_matrix((exchange.share, exchange.column, exchange.start), (len(area),) * 2)
    by_pane = (share @ found)[bounces.panes.tile_of >= 0] @ area[bounces.panes.tile_of >= 0]
    entering = 0.6 * 2.0 * np.pi * HEIGHT * 2 * HALF
    np.testing.assert_allclose(by_walls + by_pane, entering, rtol=0.02)


def test_a_pane_that_turns_light_up_lights_the_ceiling():
    """All light leaves into the patch at azimuth 90 degrees: y of the pane, which is up."""
    turning = np.zeros((145, 145))
    ring = 1 + 8 + 16
    up_patch = ring + 20 // 4
    turning[up_patch] = 0.5 / KLEMS_FULL.projected_sr[up_patch]
    upright = [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]]
    places = [[0.0, 1.5, 0.0]] * 2
    up = Room(turning).lux(hour(1.0), places, upright).total
    down = Room(turning, up=-UP).lux(hour(1.0), places, upright).total
    assert up[1] > 100.0 * up[0]
    np.testing.assert_allclose(down[0], up[1], rtol=0.05)


def test_a_pane_between_two_rooms_is_refused():
    """Neither side sees the sky: which one is outdoors, nobody can say."""
    closed = box((-HALF, 0.0, -HALF), (HALF, HEIGHT, HALF), inwards=True)
    pane = [[0.0, 0.5, -1.0], [0.0, 0.5, 1.0], [0.0, 2.5, 1.0], [0.0, 2.5, -1.0]]
    surfaces, layout = quads(*closed, pane)
    of_triangle = np.where(np.arange(len(surfaces.part)) >= len(surfaces.part) - 2, 0, -1)
    materials = PaneMaterials(("pane",), (glazing(diffuser(0.5)),), UP, of_triangle)
    transport = SceneTransport(materials.opaque(surfaces), layout)
    transport.add_rays(64)
    with pytest.raises(UserError, match="no pane of the material 'pane' sees the sky"):
        bounces_of(transport, no_glass(len(surfaces.part)), materials)


def test_a_pane_behind_another_one_is_refused():
    """Light of the outer one would be missing on the inner: no number rather than a wrong one."""
    sides = box((-HALF, 0.0, -HALF), (HALF, HEIGHT, HALF), inwards=True)
    outer = sides.pop(0)
    inner = [[x - 0.5, y, z] for x, y, z in outer]
    surfaces, layout = quads(*sides, outer, inner)
    of_triangle = np.where(np.arange(len(surfaces.part)) >= len(surfaces.part) - 4, 0, -1)
    materials = PaneMaterials(("pane",), (glazing(diffuser(0.5)),), UP, of_triangle)
    transport = SceneTransport(materials.opaque(surfaces), layout)
    transport.add_rays(64)
    with pytest.raises(UserError, match="'pane' stands indoors behind another measured one"):
        bounces_of(transport, no_glass(len(surfaces.part)), materials)


def test_the_straight_beam_of_the_sun_is_as_bright_as_the_peak():
    """Half of the sun's light through a pane whose peak is 0.5, at every sensor that it reaches."""
    light = gradient()
    towards = np.array([light.key_direction])
    sensors = free_sensors(PLACES, NORMALS, "desk")
    half = Room(opening(0.5) + diffuser(0.2))
    bare = Room()
    found = sun_shares(half.transport, half.glass, sensors, towards, half.bounces.panes)
    truth = sun_shares(bare.transport, bare.glass, sensors, towards)
    assert truth.any()
    np.testing.assert_allclose(found, 0.5 * truth, rtol=1e-5)


def test_hours_of_a_year_behind_a_pane_have_the_light_of_single_hours():
    """Sky, straight and scattered sun and all bounces; suns are solved for the very hours."""
    room = Room(opening(0.3) + diffuser(0.4), 0.5)
    sensors = free_sensors(PLACES, NORMALS, "desk")
    operator = operator_of(room.transport, room.glass, sensors, 0.05, bounces=room.bounces)
    work = DaylightWork(room.transport, room.glass, sensors, operator)
    lights = [
        hour(0.5, key=(1.0, 1.0, 0.3), irradiance=4.0, ground=0.1),
        hour(1.0, key=(0.4, 0.5, -0.6), irradiance=2.0, ground=0.3),
    ]
    light = year_like([12, 37], lights)
    year = annual(work, light)
    for n, of_hour in enumerate(lights):
        single = hour_at_sensors(room.transport, room.glass, operator, sensors, of_hour)
        np.testing.assert_allclose(year.sun[:, n], single.sun, rtol=1e-5)
        np.testing.assert_allclose(year.total[:, n], single.total, rtol=0.01)
        without = single.total - single.sun
        assert (without > 100.0).all()


def lit_from_two_sides(facade, roof):
    """Lux of a room with a facade in Klems's full basis and a roof in the quarter basis."""
    sides = box((-HALF, 0.0, -HALF), (HALF, HEIGHT, HALF), inwards=True)
    surfaces, layout = quads(*sides[3:], sides[1], sides[0], sides[2], reflectance=0.5)
    of_triangle = np.full(len(surfaces.part), -1)
    of_triangle[-4:] = [0, 0, 1, 1]
    quarter = MeasuredGlazing("roof", QUARTER, QUARTER, roof, 0.0, 0.0)
    up = np.repeat(UP, 2, axis=0)
    materials = PaneMaterials(("facade", "roof"), (glazing(facade), quarter), up, of_triangle)
    transport = SceneTransport(materials.opaque(surfaces), layout)
    transport.add_rays(128)
    glass = no_glass(len(surfaces.part))
    bounces = bounces_of(transport, glass, materials)
    sensors = free_sensors(PLACES, NORMALS, "desk")
    operator = operator_of(transport, glass, sensors, 0.1, bounces=bounces)
    # y of the facade is up; of the level roof, whose up is along its normal, north.
    np.testing.assert_allclose(bounces.panes.tiles.axes[:, 1], [[0, 1, 0], [0, 0, -1]], atol=1e-6)
    return hour_at_sensors(transport, glass, operator, sensors, gradient()).total


def test_light_through_two_glazings_adds_up():
    """A clear facade and a diffusing roof together have the light of each beside a dark one."""
    facade, roof = opening(0.8), diffuser(0.6, QUARTER)
    whole = lit_from_two_sides(facade, roof)
    one = lit_from_two_sides(facade, np.zeros_like(roof))
    other = lit_from_two_sides(np.zeros_like(facade), roof)
    assert (np.minimum(one, other) > 10.0).all()
    np.testing.assert_allclose(one + other, whole, rtol=1e-4)

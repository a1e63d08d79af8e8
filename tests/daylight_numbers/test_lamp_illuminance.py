"""Lamps at sensors against analytic light: inverse square, form factors, shadows, glass, bounces.

Cases after CIE 171:2006, 5.2 and 5.3 (point and area sources) with truth computed here.
"""

from dataclasses import replace

import numpy as np
import pytest
from boxes import box, floor, quads
from daylight_numbers.glazing.glass import no_glass, stack
from daylight_numbers.lamps.lamp_light import (
    bounce_counts,
    bounced_by,
    direct_lux,
    lamps_at_sensors,
)
from daylight_numbers.lamps.lamp_places import (
    PlacedLuminaires,
    lamp_axes,
    opening_points,
    placed_luminaires,
    read_lamps,
)
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.work import DaylightWork
from lamp_maker import lamps_of
from light_transport.transport import SceneTransport
from luminaire_files import panel_ies, spot_ldt

from vrut_lite.errors import UserError
from vrut_lite.messages.lighting import LampPlacement
from vrut_lite.scene.luminaire import Luminaire, LuminousOpening
from vrut_lite.scene.luminaire_file import read_luminaire

UP = [0.0, 1.0, 0.0]


def work_of(places, normals, *corners, clear=(), rays=64, **how):
    """Work of sensors in a scene of quads, of which those in `clear` are clear panes."""
    surfaces, layout = quads(*corners, **how)
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(rays)
    glass = no_glass(len(surfaces.part))
    for quad in clear:
        glass.tint[2 * quad : 2 * quad + 2] = 1.0
    places = np.atleast_2d(places)
    sensors = free_sensors(places, np.broadcast_to(normals, places.shape), "test")
    return DaylightWork(transport, glass, sensors, operator_of(transport, glass, sensors, 0.02))


def lamp(text, place, aim=(0.0, -1.0, 0.0), rotation_deg=0.0, output=1.0):
    """One luminaire of a file's text."""
    return PlacedLuminaires(
        (read_luminaire(text.encode()),), np.zeros(1, int), np.array([place], float),
        lamp_axes(aim, rotation_deg)[None], np.array([output]), np.array([10.0]),
        np.zeros(1, int), ("lamps",),
    )  # fmt: skip


def test_a_point_has_inverse_square_and_cosine():
    """E = I(gamma) cos / d^2 to 1e-6, on level, upright and tilted sensors, for a turned aim."""
    places = np.array([[0.0, 0.5, 0.0], [1.5, 0.5, 0.7], [-2.0, 1.0, 1.0], [0.3, 0.2, -2.5]])
    normals = np.array([UP, UP, [1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])
    here, aim = np.array([0.4, 2.8, -0.1]), np.array([0.1, -0.9, 0.2])
    work = work_of(places, normals, floor(-4, 4, -4, 4))
    found = direct_lux(work, lamp(panel_ies(size_m=(0, 0, 0)), here, tuple(aim)), 0)
    away = here - places
    distance = np.linalg.norm(away, axis=1)
    to_sensor = -away / distance[:, None] @ (aim / np.linalg.norm(aim))
    # The file's own intensity at each angle: linear between its degrees.
    degrees = np.arange(91.0)
    intensity = np.interp(
        np.degrees(np.arccos(to_sensor)), degrees, 3000.0 / np.pi * np.cos(np.radians(degrees))
    )
    cosine = np.maximum(np.sum(away * normals, axis=1) / distance, 0.0)
    np.testing.assert_allclose(found, intensity * cosine / distance**2, rtol=1e-6)


@pytest.mark.parametrize("height", [0.15, 0.3, 0.6, 1.2, 2.4, 6.0])
def test_a_rectangle_has_its_form_factor(height):
    """Below the middle of a Lambertian rectangle a x b: E = M F, within 0.15 %, from an eighth of
    its length on; F of an element to a parallel rectangle, four quarters (Howell 1982)."""
    a, b, flux = 1.2, 0.6, 3000.0
    text = panel_ies(flux, (b, a, 0.0))
    work = work_of([0.0, 1.0, 0.0], UP, floor(-4, 4, -4, 4))
    found = direct_lux(work, lamp(text, (0.0, 1.0 + height, 0.0)), 0)[0]
    x, y = 0.5 * a / height, 0.5 * b / height
    p, q = np.sqrt(1 + x * x), np.sqrt(1 + y * y)
    factor = 4 / (2 * np.pi) * (x / p * np.arctan(y / p) + y / q * np.arctan(x / q))
    assert found == pytest.approx(flux / (a * b) * factor, rel=1.5e-3)


@pytest.mark.parametrize("height", [0.2, 0.5, 1.0, 3.0])
def test_a_disc_has_its_form_factor(height):
    """Below the middle of a Lambertian disc E = M r^2 / (r^2 + h^2), within 0.15 %."""
    radius, flux = 0.4, 2000.0
    text = panel_ies(flux, (-2 * radius, -2 * radius, 0.0))
    work = work_of([0.0, 1.0, 0.0], UP, floor(-4, 4, -4, 4))
    found = direct_lux(work, lamp(text, (0.0, 1.0 + height, 0.0)), 0)[0]
    exact = flux / (np.pi * radius**2) * radius**2 / (radius**2 + height**2)
    assert found == pytest.approx(exact, rel=1.5e-3)


def test_points_of_an_opening_share_its_area():
    """Shares sum to 1, and second moments are a rectangle's and an ellipse's."""
    for is_round, moment in ((False, 1 / 12), (True, 1 / 16)):
        points, shares = opening_points(LuminousOpening(0.5, 2.0, 0.0, is_round), [3, 2])
        assert shares.sum() == pytest.approx(1.0)
        np.testing.assert_allclose(shares @ points, 0.0, atol=1e-12)
        np.testing.assert_allclose(shares @ points**2, np.array([4.0, 0.25]) * moment, rtol=1e-9)


def test_the_length_of_a_luminaire_lies_as_it_is_turned():
    """Along +x at 0 degrees, along -z (north) at 90, counter-clockwise from above."""
    for turn, along in ((0.0, [1.0, 0.0, 0.0]), (90.0, [0.0, 0.0, -1.0])):
        axes = lamp_axes((0.0, -1.0, 0.0), turn)
        np.testing.assert_allclose(axes[1], along, atol=1e-12)
        np.testing.assert_allclose(np.cross(axes[1], axes[2]), -axes[0], atol=1e-12)
    level = lamp_axes((0.0, 0.0, -1.0), 0.0)
    np.testing.assert_allclose(level[1], [1.0, 0.0, 0.0], atol=1e-12)


def test_a_wall_hides_a_lamp_and_a_ceiling_around_it_does_not():
    """A recessed panel in the ceiling's own plane shines; behind a screen there is no light."""
    ceiling = box((-2, 0, -2), (2, 3, 2), inwards=True)
    screen = [[0.5, 0, -2], [0.5, 0, 2], [0.5, 2.9, 2], [0.5, 2.9, -2]]
    work = work_of([[0.0, 1.0, 0.0], [1.0, 1.0, 0.0]], UP, *ceiling, screen, double_sided=True)
    here = lamp(panel_ies(size_m=(0.3, 0.3, 0.0)), (-0.5, 3.0, 0.0))
    lux = direct_lux(work, here, 0)
    assert lux[0] > 100.0
    assert lux[1] == 0.0


def test_glass_passes_a_lamp_by_the_angle():
    """A clear pane between: Fresnel's share at the angle of incidence, to 1e-3."""
    pane = [[-1, 2, 1], [1, 2, 1], [1, 2, -1], [-1, 2, -1]]
    places = [[0.0, 1.0, 0.0], [0.9, 1.0, 0.0]]
    clear = work_of(places, UP, floor(-4, 4, -4, 4), pane, clear=(1,))
    bare = work_of(places, UP, floor(-4, 4, -4, 4))
    here = lamp(panel_ies(size_m=(0, 0, 0)), (0.0, 3.0, 0.0))
    share = direct_lux(clear, here, 0) / direct_lux(bare, here, 0)
    cosine = 2.0 / np.hypot(2.0, [0.0, 0.9])
    np.testing.assert_allclose(share, stack(cosine, 1.0, 1)[0], rtol=1e-3)


def test_bounces_of_a_closed_box_conserve_energy():
    """In a box of one reflectance r bounces absorb all: walls send r / (1 - r) of the flux."""
    reflectance = 0.5
    sides = box((-2, 0, -2), (2, 3, 2), inwards=True)
    work = work_of([0.0, 1.0, 0.0], UP, *sides, reflectance=reflectance, texels=24, rays=256)
    spot = lamp(spot_ldt(), (0.0, 2.9, 0.0))
    patches = work.transport.patches
    radiosity = bounced_by(work.transport, spot, 0, (0.2, 0.2, 0.2))[:, 0]
    light_w = spot.flux_lm[0] / 683.0
    area = patches.area * work.transport.surfaces.radius_m**2
    sent = float(np.sum(radiosity * area))
    assert sent == pytest.approx(light_w * reflectance / (1.0 - reflectance), rel=0.02)


def test_groups_are_apart_and_sensors_get_bounces():
    """Each group has its own column, and half the output half the light."""
    sides = box((-2, 0, -2), (2, 3, 2), inwards=True)
    work = work_of([0.5, 1.0, 0.0], UP, *sides, rays=128)
    one = lamp(spot_ldt(), (0.0, 2.9, 0.0))
    both = PlacedLuminaires(
        one.kinds, np.zeros(2, int), np.repeat(one.places_m, 2, axis=0),
        np.repeat(one.axes, 2, axis=0), np.array([1.0, 0.5]), np.array([10.0, 5.0]),
        np.array([0, 1]), ("a", "b"),
    )  # fmt: skip
    light = lamps_at_sensors(work, both, (0.2, 0.2, 0.2))
    np.testing.assert_allclose(light.total[:, 1], 0.5 * light.total[:, 0], rtol=1e-5)
    # By all walls the mean of bounces is 10 lx; the floor, which is brightest, is not in view.
    assert 3.0 < light.surfaces[0, 0] < 10.0
    np.testing.assert_allclose(both.group_watts, [10.0, 5.0])


def test_a_lamp_of_the_scene_has_its_light():
    """A point of the scene, by name: its candela is that of its luminance in W/sr times 683."""
    scene = lamps_of({"position_m": (0.0, 3.0, 0.0), "intensity_rgb": (0.5, 0.5, 0.5)})
    placed = placed_luminaires({"lamp": LampPlacement(watts=7.0)}, scene)
    work = work_of([0.0, 1.0, 0.0], UP, floor(-4, 4, -4, 4))
    assert direct_lux(work, placed, 0)[0] == pytest.approx(0.5 * 683.0 / 4.0, rel=1e-6)
    assert placed.group_watts == 7.0
    with pytest.raises(UserError, match="lamp desk has no file, and the scene has no lamp"):
        placed_luminaires({"desk": LampPlacement()}, scene)


def test_lumens_and_watts_go_before_a_files(tmp_path):
    """A file without true lumens: the placement's flux scales its intensity."""
    (tmp_path / "panel.ies").write_text(panel_ies())
    told = LampPlacement(str(tmp_path / "panel.ies"), [0.0, 3.0, 0.0], lumens=1500.0, dimming=0.5)
    placed = placed_luminaires({"desk": told}, None)
    assert placed.flux_lm == pytest.approx(750.0)
    assert placed.watts == pytest.approx(12.5)


def test_lamps_of_a_table_are_placed(tmp_path):
    (tmp_path / "panel.ies").write_text(panel_ies())
    path = tmp_path / "lamps.csv"
    path.write_text(
        "file,x,y,z,dx,dy,dz,rotation_deg,group\npanel.ies,1,3,0\n# a remark\n\n"
        "panel.ies,2,3,0,0,-1,0,90,row 2\n"
    )
    placed = placed_luminaires(read_lamps(path), None)
    assert placed.groups == ("lamps", "row 2")
    assert len(placed.kinds) == 1
    np.testing.assert_allclose(placed.places_m, [[1, 3, 0], [2, 3, 0]])
    np.testing.assert_allclose(placed.axes[1, 1], [0, 0, -1], atol=1e-12)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "has no lamps"),
        ("panel.ies,1,2\n", "line 1 of .* is no lamp: give file,x,y,z"),
        ("a.ies,1,2,3\nb.ies,1,2,up\n", "line 2 of .* is no lamp: 'up' is no number"),
        ("a.ies,1,2,nan\n", "line 1 of .* is no lamp: at holds a number that is not finite"),
        ("a.ies,1,2,3,0,0,0\n", "line 1 of .* is no lamp: aim is"),
    ],
)
def test_a_bad_table_of_lamps_is_refused_with_its_line(tmp_path, text, said):
    path = tmp_path / "lamps.csv"
    path.write_text(text)
    with pytest.raises(UserError, match=said):
        read_lamps(path)


def contour_lux(corners, place, normal, exitance):
    """Lux of a Lambertian polygon (4, 3), all above the sensor's plane (Lambert 1760)."""
    away = corners - place
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    total = 0.0
    for one, other in zip(away, np.roll(away, -1, axis=0), strict=True):
        across = np.cross(one, other)
        angle = np.arctan2(np.linalg.norm(across), one @ other)
        total += angle * (across @ normal) / np.linalg.norm(across)
    return abs(total) * exitance / (2.0 * np.pi)


def test_a_square_lights_floor_and_walls_of_a_black_room():
    """As CIE 171:2006 asks of area sources: 1 x 1 m at the ceiling of 4 x 4 x 3 m, six points of
    the floor and four of a wall, each within 0.15 % of Lambert's contour integral."""
    floor_points = [[-1.5 + 0.5 * n, 0.0, 0.3] for n in range(6)]
    wall_points = [[1.99, 0.5 + 0.5 * n, 0.4] for n in range(4)]
    places = np.array([*floor_points, *wall_points])
    places[:, 1] += 1e-3
    normals = np.array([UP] * 6 + [[-1.0, 0.0, 0.0]] * 4)
    sides = box((-2, 0, -2), (2, 3, 2), inwards=True)
    work = work_of(places, normals, *sides, reflectance=0.0)
    found = direct_lux(work, lamp(panel_ies(size_m=(1.0, 1.0, 0.0)), (0.0, 3.0, 0.0)), 0)
    corners = np.array([[-0.5, 3, -0.5], [0.5, 3, -0.5], [0.5, 3, 0.5], [-0.5, 3, 0.5]], float)
    truth = [contour_lux(corners, *pair, 3000.0) for pair in zip(places, normals, strict=True)]
    np.testing.assert_allclose(found, truth, rtol=1.5e-3)


@pytest.mark.parametrize("below", [0.05, 0.5])
def test_all_light_of_an_uplighter_arrives(below):
    """Half up, half down, 1.2 m long and close below the ceiling of a closed box: its whole flux
    falls on the patches, within 1 %, though no texel sees it as a point."""
    gamma = np.arange(0.0, 181.0)
    candela = 1500.0 / np.pi * np.abs(np.cos(np.radians(gamma)))
    opening = LuminousOpening(0.3, 1.2, 0.0, False)
    around = np.array([0.0, 360.0])
    both = Luminaire(gamma, around, np.repeat(candela[:, None], 2, axis=1), None, 25.0, opening)
    here = replace(lamp(panel_ies(), (0.5, 2.5 - below, 0.5)), kinds=(both,))
    sides = box((-2, 0, -2.5), (2, 2.5, 2.5), inwards=True)
    work = work_of([0.0, 1.2, 0.0], UP, *sides, texels=48)
    counts = bounce_counts(work.transport, here, 0)
    direct = work.transport.lamplit_patches(here.points(np.zeros(1, int), counts[None]))[:, 0]
    area = work.transport.patches.area * work.transport.surfaces.radius_m**2
    assert 683.0 * float(direct @ area) == pytest.approx(both.flux_lm, rel=0.01)

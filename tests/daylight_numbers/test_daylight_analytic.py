"""Daylight numbers against analytic truth, computed here after the list of CIE 171:2006.

Sky components through a roof opening and through a facade opening, with and without glass, under
several CIE skies, on level and upright sensors; light inside a closed diffuse box. A component of
more than 0.5 % of the light outdoors may err by 1 % at most.
"""

import numpy as np
import pytest
from boxes import box, hour, quads
from daylight_numbers.glazing.glass import no_glass, stack, tint_of
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.now import (
    cie_hour,
    daylight_factor,
    hour_at_sensors,
    relative_luminance,
    sun_shares,
)
from light_transport.transport import SceneTransport
from scipy.optimize import brentq

WORST, LEAST = 0.01, 0.5
SIZE, HEIGHT = 4.0, 3.0


def panel(corner, edge, other, hole):
    """Four quads around a hole, in the plane of two edges (3,) from a corner; shares of edges."""
    corner, edge, other = (np.asarray(v, float) for v in (corner, edge, other))
    a0, a1, b0, b1 = hole

    def quad(u0, u1, v0, v1):
        return [corner + u * edge + v * other for u, v in ((u0, v0), (u1, v0), (u1, v1), (u0, v1))]

    return [quad(0, a0, 0, 1), quad(a1, 1, 0, 1), quad(a0, a1, 0, b0), quad(a0, a1, b1, 1)]


def room(opening, hole, reflectance=0.0, pane=False):
    """A box seen from inside, with a hole in its roof or in its facade towards +x."""
    h = SIZE / 2
    sides = box((-h, 0.0, -h), (h, HEIGHT, h), inwards=True)
    if opening == "roof":
        frame = ((-h, HEIGHT, -h), (SIZE, 0, 0), (0, 0, SIZE))
        sides.pop(2)
    else:
        frame = ((h, 0, h), (0, 0, -SIZE), (0, HEIGHT, 0))
        sides.pop(0)
        frame = ((h, 0, -h), (0, 0, SIZE), (0, HEIGHT, 0))
    pieces = panel(*frame, hole)
    corner, edge, other = (np.asarray(v, float) for v in frame)
    a0, a1, b0, b1 = hole
    glazed = [corner + u * edge + v * other for u, v in ((a0, b0), (a1, b0), (a1, b1), (a0, b1))]
    surfaces, layout = quads(*sides, *pieces, *([glazed] if pane else []), reflectance=reflectance)
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(256)
    glass = no_glass(len(surfaces.part))
    if pane:
        glass.tint[-2:] = 1.0
    return transport, glass, (corner, edge, other)


def component(frame, hole, place, normal, sky, pane):
    """The sky component (%) through an opening, by summing over its area."""
    corner, edge, other = frame
    a0, a1, b0, b1 = hole
    n = 150
    u = a0 + (a1 - a0) * (np.arange(n) + 0.5) / n
    v = b0 + (b1 - b0) * (np.arange(n) + 0.5) / n
    at = corner + u[:, None, None] * edge + v[None, :, None] * other
    away = at - place
    distance = np.linalg.norm(away, axis=-1)
    towards = away / distance[..., None]
    out = np.cross(edge, other)
    area = np.linalg.norm(out) * (a1 - a0) * (b1 - b0) / n**2
    inclined = np.abs(towards @ (out / np.linalg.norm(out)))
    cosine = np.maximum(towards @ normal, 0.0)
    light = relative_luminance(sky, np.maximum(towards[..., 1], 0.0)) * (towards[..., 1] > 0)
    if pane:
        angles = np.linspace(1e-3, 1.0, 1000)
        light = light * np.interp(inclined, angles, pane_transmittance(angles))
    steps = (np.arange(100_000) + 0.5) / 100_000
    outside = 2.0 * np.pi * np.mean(relative_luminance(sky, steps) * steps)
    return 100.0 * float(np.sum(light * cosine * inclined / distance**2) * area / outside)


def pane_transmittance(cosine, ior=1.5, panes=1, inner=1.0):
    """Of panes by the light in each layer, both ways: a linear system of all faces, by Fresnel.

    `inner` is what the glass of a pane leaves on the shortest way through it.
    """
    bent = np.sqrt(1 - (1 - cosine**2) / ior**2)
    across = ((cosine - ior * bent) / (cosine + ior * bent)) ** 2
    along = ((ior * cosine - bent) / (ior * cosine + bent)) ** 2
    return 0.5 * sum(np.vectorize(layered)(r, inner ** (1 / bent), panes) for r in (across, along))


def layered(face, inner, panes):
    """Light through 2 `panes` faces; layers between them leave `inner` in glass, all in air."""
    faces = 2 * panes
    leaves = [1.0, *([inner, 1.0] * panes)]
    # Forward light at the end of layer n is unknown 2 n, backward light at its start 2 n + 1.
    system, told = np.eye(2 * faces + 2), np.zeros(2 * faces + 2)
    told[0] = 1.0
    for n in range(faces):
        ahead, behind = leaves[n + 1], leaves[n]
        system[2 * n + 2, 2 * n] -= (1 - face) * ahead
        system[2 * n + 2, 2 * n + 3] -= face * ahead
        system[2 * n + 1, 2 * n] -= face * behind
        system[2 * n + 1, 2 * n + 3] -= (1 - face) * behind
    return np.linalg.solve(system, told)[2 * faces]


PLACES = np.array([[x, 0.0, z] for x in (-1.5, 0.0, 1.5) for z in (-1.2, 0.4)])
DIRECTIONS = {"level": [0.0, 1.0, 0.0], "upright": [1.0, 0.0, 0.0]}
HOLES = {"roof": (0.375, 0.625, 0.375, 0.625), "facade": (0.25, 0.75, 1.0 / 3.0, 2.0 / 3.0)}


@pytest.mark.parametrize("opening", HOLES)
@pytest.mark.parametrize("pane", [False, True], ids=["open", "glazed"])
def test_sky_components_through_openings_are_analytic(opening, pane):
    """CIE 171's 5.2 to 5.8 in kind: nothing is reflected, and all light comes through a hole."""
    transport, glass, frame = room(opening, HOLES[opening], pane=pane)
    for direction, normal in DIRECTIONS.items():
        places = PLACES + np.array([0.0, 0.85, 0.0])
        sensors = free_sensors(places, np.tile(normal, (len(places), 1)), direction)
        operator = operator_of(transport, glass, sensors, 0.01)
        for sky in ("16", "1", "5"):
            light = cie_hour(sky, 0.0)
            found, _ = daylight_factor(transport, glass, operator, sensors, light)
            truth = np.array(
                [component(frame, HOLES[opening], p, np.array(normal), sky, pane) for p in places]
            )
            counted = truth > LEAST
            assert counted.any() or (opening, direction) == ("roof", "upright")
            error = np.abs(found / np.maximum(truth, 1e-9) - 1.0)[counted]
            print(opening, pane, direction, sky, truth.round(2), error.round(4), operator.rays)
            assert np.all(error < WORST), (direction, sky, found[counted], truth[counted])


@pytest.mark.parametrize("inner", [1.0, 0.6])
@pytest.mark.parametrize("panes", [1, 2, 3])
def test_glazing_of_several_panes_is_that_of_all_their_faces(panes, inner):
    """Panes added one by one against the light in all layers at once, at all angles."""
    cosine = np.linspace(0.05, 1.0, 20)
    passed, sent = stack(cosine, inner, panes)
    np.testing.assert_allclose(passed, pane_transmittance(cosine, panes=panes, inner=inner))
    if inner == 1.0:
        np.testing.assert_allclose(passed + sent, 1.0)
    else:
        assert (passed + sent < 1.0).all()


def test_rays_lose_what_double_panes_of_a_project_take():
    """Named glass passes its share and colour at right angles, and darkens as it is inclined."""
    transport, glass, _ = room("facade", HOLES["facade"], pane=True)
    told = np.array([0.6, 0.4, 0.9])
    glass.tint[-2:], glass.panes[-2:] = tint_of(told, 2), 2
    towards = np.array([[1.0, 0.0, 0.0], [1.0, 0.0, 0.5]])
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    sensors = free_sensors([[0.0, 1.5, 0.0]], [[1.0, 0.0, 0.0]], "eye")
    suns = towards + np.array([0.0, 1e-4, 0.0])
    passed = sun_shares(transport, glass, sensors, suns)[0] / towards[:, :1]
    np.testing.assert_allclose(passed[0], told, rtol=1e-3)
    clear = float(pane_transmittance(np.ones(1), panes=2)[0])
    assert told[2] > clear
    inner = [brentq(lambda t, T=T: layered(0.04, t, 2) - T, 0.0, 1.0) for T in told[:2]]
    expected = [pane_transmittance(towards[1:, 0], panes=2, inner=t)[0] for t in inner]
    coated = told[2] / clear * pane_transmittance(towards[1:, 0], panes=2)[0]
    np.testing.assert_allclose(passed[1], [*expected, coated], rtol=1e-3)


def test_configuration_factors_of_a_glowing_wall_are_analytic():
    """CIE 171's 5.9 in kind: a wall of a black room glows with M; a point on a plane that faces it,
    and one on a plane at right angles to it, get M times their factors (Hottel's formulas)."""
    h = SIZE / 2
    surfaces, layout = quads(*box((-h, 0.0, -h), (h, HEIGHT, h), inwards=True), reflectance=0.0)
    surfaces.emitted_rgb[:2] = 1.0
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(64)
    glass = no_glass(len(surfaces.part))
    places, normals = [[-1.0, 1.0, 0.5], [-1.0, 1.0, 0.5]], [[1.0, 0, 0], [0, 1.0, 0]]
    sensors = free_sensors(places, normals, "points")
    operator = operator_of(transport, glass, sensors, 0.01)
    found = hour_at_sensors(transport, glass, operator, sensors, hour()).total / 683.0
    distance = h + 1.0
    facing = sum(_facing(a, b, distance) for a in (h - 0.5, h + 0.5) for b in (1.0, HEIGHT - 1.0))
    upright = sum(_upright(a, HEIGHT - 1.0, distance) for a in (h - 0.5, h + 0.5))
    np.testing.assert_allclose(found, [facing, upright], rtol=0.01)


def _facing(a, b, c):
    """Factor of a point and a rectangle a x b that faces it, a corner straight ahead at c."""
    x, y = np.hypot(a, c), np.hypot(b, c)
    return (a / x * np.arctan(b / x) + b / y * np.arctan(a / y)) / (2.0 * np.pi)


def _upright(a, b, c):
    """Factor of a point and an upright rectangle, a along the point's plane and b above it."""
    d = np.hypot(b, c)
    return (np.arctan(a / c) - c / d * np.arctan(a / d)) / (2.0 * np.pi)


def test_light_in_a_closed_diffuse_box_is_analytic():
    """Walls of albedo rho that glow with M: irradiance is M / (1 - rho) everywhere."""
    surfaces, layout = quads(
        *box((-1, 0, -1), (1, 2, 1), inwards=True), reflectance=0.5, emitted=1.0
    )
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(256)
    glass = no_glass(len(surfaces.part))
    sensors = free_sensors([[0.3, 0.85, 0.2]], [[0.0, 1.0, 0.0]], "box")
    operator = operator_of(transport, glass, sensors, 0.01)
    found = hour_at_sensors(transport, glass, operator, sensors, hour())
    expected = 683.0 * 2.0
    np.testing.assert_allclose(found.total, expected, rtol=5e-3)

"""Lamps light surfaces and what these send on: nothing is lost, and what hides a lamp darkens."""

import numpy as np
import pytest
from boxes import box, floor, hour, quads
from lamp_maker import lamps_of, spot_table
from light_transport.hour.lamp_light import _share, lamps_in_radii
from light_transport.transport import SceneTransport

from vrut_lite.messages.lamps import MOST_DRAWN


def lit(scene, *lamps, rays=64):
    """The light that lamps alone make, those that the frame draws itself left out."""
    transport = SceneTransport(*scene)
    transport.lamps = lamps_of(*lamps)
    transport.add_rays(rays)
    return transport.light(hour()).texels[..., :3]


def on_quad(texels, number, count=8):
    return texels[number * (count + 2) : number * (count + 2) + count]


@pytest.mark.parametrize("albedo", [0.5, 0.9])
def test_what_a_lamp_sends_is_absorbed(albedo):
    """A point of 1 W per steradian in a shut room: 4 pi W go in, and all bounces bring the rest."""
    size, texels = np.array([2.0, 1.0, 3.0]), 16
    room = quads(*box((0, 0, 0), size, inwards=True), reflectance=albedo, texels=texels)
    light = lit(room, {"position_m": (0.8, 0.5, 1.2), "intensity_rgb": (1.0, 2.0, 0.0)}, rays=128)
    areas = [size[1] * size[2]] * 2 + [size[0] * size[2]] * 2 + [size[0] * size[1]] * 2
    arrived = sum(
        area * on_quad(light, side, texels).mean(axis=(0, 1)) for side, area in enumerate(areas)
    )
    # Without what comes straight, which the frame draws.
    expected = 4.0 * np.pi * albedo / (1.0 - albedo) * np.array([1.0, 2.0, 0.0])
    np.testing.assert_allclose(arrived, expected, rtol=0.01)


def test_lamps_beyond_those_that_are_drawn_are_in_the_map_itself():
    """On a black floor: the irradiance that the lamps' own values give, to 1 % of the largest."""
    texels = 24
    lamp = {"position_m": (0.5, 0.7, 0.4), "table": spot_table(), "intensity_rgb": (2.0, 1.0, 0.5)}
    brighter = {"position_m": (0.5, -1.0, 0.5), "intensity_rgb": (9.0, 9.0, 9.0)}
    scene = quads(floor(0, 1, 0, 1), reflectance=0.0, texels=texels)
    found = on_quad(lit(scene, *[brighter] * MOST_DRAWN, lamp), 0, texels)
    lamps = lamps_of(lamp)
    middles = (np.arange(texels) + 0.5) / texels
    # Texels of a quad go from its first corner to its second, then to its last.
    expected = np.array(
        [
            [lamps.irradiance_at(0, (x, 0.0, z), (0.0, 1.0, 0.0)) for x in middles]
            for z in middles[::-1]
        ]
    )
    np.testing.assert_allclose(found, expected, atol=0.03 * expected.max())
    np.testing.assert_allclose(found.mean(axis=(0, 1)), expected.mean(axis=(0, 1)), rtol=0.01)


def test_what_stands_before_a_lamp_hides_it():
    """A screen half way up keeps the lamp's light from the floor; one above the lamp does not."""
    lamp = {"position_m": (0.5, 0.5, 0.5)}
    behind = [{"position_m": (9.0, -9.0, 9.0), "intensity_rgb": (9.0,) * 3}] * MOST_DRAWN
    light = []
    for height in (0.25, 0.75):
        sheets = floor(0, 1, 0, 1), floor(-5, 6, -5, 6, y=height)
        scene = quads(*sheets, reflectance=0.0, double_sided=True)
        light.append(on_quad(lit(scene, *behind, lamp), 0))
    assert (light[0] == 0.0).all()
    assert (light[1] > 0.1).all()


def test_the_compiled_share_is_that_of_the_lamps_own_values():
    """The float64 twin: cones and tables into 500 directions, to 1e-6 of the axis."""
    lamps = lamps_of(
        {"position_m": (0, 0, 0), "cone_rad": (0.4, 0.9), "axis": (1.0, 2.0, -0.5)},
        {"position_m": (0, 0, 0), "table": spot_table(), "axis": (0.3, -1.0, 0.2)},
    )
    scene = quads(floor(0, 1, 0, 1))
    compiled = lamps_in_radii(lamps, scene[0])
    ways = np.random.default_rng(3).normal(size=(500, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    for lamp in range(2):
        found = [_share(compiled, lamp, *way) for way in ways]
        expected = lamps.intensity_towards(lamp, ways)[:, 0] / lamps.intensity_rgb.values[lamp, 0]
        np.testing.assert_allclose(found, expected, atol=1e-6)

"""Glass, second coats and reflectances in the path tracer, as the frame has them."""

import numpy as np
import pytest
from light_messages import light_messages
from long_parameters import mostly_long
from path_tracer.backend import PathTracedBackend
from path_tracer.settings import PathTracerSettings
from path_tracer_here import mitsuba_or_skip
from scene_stage import CORNERS, ORDER, look, square
from stateful_backend import StatefulBackend, opened
from term_stage import ALBEDO, F0, GROUND, material

mitsuba_or_skip()
SIZE = (4, 4)


def seen(path, elevation_deg=90.0, spp=64, sky=1.0, model="layered", ground=GROUND, **sun):
    """Mean radiance (3,) of the square's middle from so high above its horizon."""
    settings = PathTracerSettings(spp=spp, surfaces=model, variant="scalar", sun="sharp")
    backend = StatefulBackend(PathTracedBackend(settings), size_px=SIZE)
    backend.change(scene=opened(path, ground), ground_albedo_rgb=(ALBEDO,) * 3)
    background, key_light, ambient = light_messages(np.full((6, 8, 8, 3), sky), **sun)
    backend.change(background=background, key_light=key_light, ambient=ambient)
    angle = np.radians(elevation_deg)
    eye = (0.0, 3.0 * np.sin(angle), 3.0 * np.cos(angle) + 1e-6)
    return look(backend, eye, (0.0, 0.0, 0.0), 0.05).radiance.mean(axis=(0, 1))


@pytest.mark.parametrize("roughness", mostly_long([0.0, 0.3], (0.3).__eq__))
def test_a_pane_reflects_its_share_and_tints_the_rest(tmp_path, roughness):
    """4 % of the sky, and of what is behind what is left, times the colour."""
    colour = (0.2, 0.5, 0.9)
    pane = material(colour, roughness, transmission={"transmissionFactor": 1.0})
    shown = seen(square(tmp_path, pane, corners=CORNERS * 20.0), spp=64)
    # The ground gets its own sky through the pane, and sends it up again.
    behind = ALBEDO * 0.91 * np.array(colour)
    expected = F0 + (1.0 - F0) * behind * np.array(colour)
    np.testing.assert_allclose(shown, expected, rtol=0.2, atol=0.01)


@pytest.mark.long
def test_a_pane_before_a_like_sky_is_not_seen(tmp_path):
    """What it reflects it does not let through, at any angle: 1 before and behind shows 1."""
    pane = material(transmission={"transmissionFactor": 1.0})
    path = square(tmp_path, pane)
    for elevation_deg in (15.0, 90.0):
        shown = seen(path, elevation_deg, ground=None)
        np.testing.assert_allclose(shown, 1.0, rtol=0.02)


def test_the_sun_shines_through_a_pane(tmp_path):
    """Ground below it has 0.96 of the sun times its colour, and no black shadow."""
    pane = material((1.0, 0.5, 0.0), transmission={"transmissionFactor": 1.0})
    path = square(tmp_path, pane, corners=CORNERS * 20.0)
    sun = {"sun_direction": (0.0, 1.0, 1e-6), "sun_irradiance": (np.pi,) * 3, "sky": 0.0}
    shown = seen(path, 60.0, spp=16, **sun)
    # Twice through the pane: with the sun, and with the view.
    expected = ALBEDO * (1.0 - F0) ** 2 * np.array([1.0, 0.25, 0.0])
    np.testing.assert_allclose(shown, expected, rtol=0.06, atol=0.003)


def test_a_pane_may_have_a_map_of_normals_and_paint(tmp_path):
    """Half of it paint: as without the map, which lies flat."""
    pane = material((0.5, 0.5, 0.5), transmission={"transmissionFactor": 0.5})
    plain = seen(square(tmp_path, pane), ground=None)
    pane["normalTexture"] = {"index": 0}
    flat = np.full((2, 2, 3), (128, 128, 255), np.uint8)
    np.testing.assert_allclose(seen(square(tmp_path, pane, [flat]), ground=None), plain, rtol=0.05)


@pytest.mark.parametrize("model", ["layered", "gltf"])
def test_a_body_bends_light_and_takes_some_away(tmp_path, model):
    """A slab half a metre thick of what leaves a quarter after a metre: a half, twice 4 % less."""
    volume = {"thicknessFactor": 0.5, "attenuationDistance": 1.0, "attenuationColor": [0.25, 1, 1]}
    body = material(transmission={"transmissionFactor": 1.0}, volume=volume)
    upper, lower = CORNERS * 8.0, CORNERS[::-1] * 8.0 - [0.0, 0.5, 0.0]
    path = square(
        tmp_path,
        body,
        attributes={"TEXCOORD_0": np.zeros((8, 2))},
        corners=np.concatenate([upper, lower]),
        order=(*ORDER, *(4 + np.array(ORDER))),
    )
    shown = seen(path, spp=256, ground=None, model=model)
    # Of the light that enters, a half leaves after one way, and after two ways and a reflection.
    a, r = 0.5, F0
    expected = r + (1 - r) ** 2 * a * (1 + r * a) / (1 - (r * a) ** 2)
    np.testing.assert_allclose(shown, [expected, 1.0, 1.0], rtol=0.04)


@pytest.mark.parametrize("elevation_deg", mostly_long([15.0, 90.0], lambda deg: deg < 45.0))
@pytest.mark.parametrize(
    "extensions",
    [
        {"clearcoat": {"clearcoatFactor": 1.0, "clearcoatRoughnessFactor": 0.3}},
        {"ior": {"ior": 2.0}},
        {"specular": {"specularFactor": 0.3}},
        {"anisotropy": {"anisotropyStrength": 0.7}},
    ],
)
def test_white_stays_white_under_an_even_sky(tmp_path, extensions, elevation_deg):
    """What a coat reflects does not reach the paint, and nothing is lost: 3 %."""
    path = square(tmp_path, material(roughness=0.5, **extensions))
    shown = seen(path, elevation_deg, spp=128, ground=None)
    np.testing.assert_allclose(shown, 1.0, rtol=0.03)


@pytest.mark.gl
@pytest.mark.parametrize(
    "extensions",
    [
        {"clearcoat": {"clearcoatFactor": 0.7, "clearcoatRoughnessFactor": 0.3}},
        {"specular": {"specularFactor": 0.5, "specularColorFactor": [1.0, 0.5, 0.2]}},
        {"ior": {"ior": 1.9}},
        {"sheen": {"sheenColorFactor": [1.0, 0.5, 0.2], "sheenRoughnessFactor": 0.4}},
        {"anisotropy": {"anisotropyStrength": 0.7, "anisotropyRotation": 0.5}},
        {"iridescence": {"iridescenceFactor": 0.8, "iridescenceThicknessMaximum": 350.0}},
    ],
)
def test_sunlight_is_reflected_as_by_the_frame(gl_owner, tmp_path, extensions):
    """The same formulas twice: 1 %, also where sun and view graze the surface."""
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    path = square(tmp_path, material((0.5, 0.4, 0.3), 0.4, **extensions))
    backend = PyrenderBackend(gl_owner)
    frame = StatefulBackend(backend, size_px=SIZE)
    frame.change(scene=opened(path))
    for elevation_deg, height in ((60.0, 0.8), (15.0, 0.3)):
        towards = (0.0, height, -np.sqrt(1.0 - height**2))
        sun = {"sun_direction": towards, "sun_irradiance": (5.0,) * 3}
        background, key_light, ambient = light_messages(np.zeros((6, 8, 8, 3)), **sun)
        frame.change(background=background, key_light=key_light, ambient=ambient)
        angle = np.radians(elevation_deg)
        eye = (0.0, 3.0 * np.sin(angle), 3.0 * np.cos(angle) + 1e-6)
        expected = look(frame, eye, (0, 0, 0), 0.05).radiance.mean(axis=(0, 1))
        shown = seen(path, elevation_deg, spp=1, ground=None, **{**sun, "sky": 0.0})
        np.testing.assert_allclose(shown, expected, rtol=0.01)
    backend.close()

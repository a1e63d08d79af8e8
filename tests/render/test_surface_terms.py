"""Glass, second coats, fibres and the like: what glTF's extensions say, as radiance.

A square of a metre lies level under an even sky of radiance 1; its picture is what its reflectance
and transmittance make of that.
"""

import numpy as np
import pytest
from long_parameters import mostly_long
from scene_stage import CORNERS, light, look, square
from stateful_backend import opened
from term_stage import ALBEDO, F0, GROUND, material

from vrut_lite.geometry.thin_film import film_reflectance
from vrut_lite.render.still_picture import FEWER_SHIFTS_PX

pytestmark = pytest.mark.gl


@pytest.fixture
def backend(shared_gl_backend):
    return shared_gl_backend(size_px=(32, 32))


def seen(backend, folder, paint, ground=GROUND, elevation_deg=90.0, images=(), sky=1.0, **sun):
    """Radiance (3,) of the square's middle from so high above its horizon."""
    path = square(folder, paint, images)
    backend.change(scene=opened(path, ground), ground_albedo_rgb=(ALBEDO,) * 3)
    light(backend, np.full((6, 16, 16, 3), sky), **sun)
    angle = np.radians(elevation_deg)
    eye = (0.0, 3.0 * np.sin(angle), 3.0 * np.cos(angle) + 1e-6)
    return look(backend, eye, (0.0, 0.0, 0.0), 0.05).radiance[16, 16]


@pytest.mark.parametrize("roughness", [0.0, 0.4])
@pytest.mark.parametrize(
    "colour", mostly_long([(1.0, 1.0, 1.0), (0.2, 0.5, 0.9)], lambda colour: colour[0] < 1.0)
)
def test_a_pane_reflects_its_share_and_tints_the_rest(backend, tmp_path, roughness, colour):
    """4 % of the sky, and of the ground behind what is left, times the colour: 1 %."""
    pane = material(colour, roughness, transmission={"transmissionFactor": 1.0})
    shown = seen(backend, tmp_path, pane)
    expected = F0 + (1.0 - F0) * ALBEDO * np.array(colour)
    np.testing.assert_allclose(shown, expected, rtol=0.02, atol=0.004)


@pytest.mark.parametrize("elevation_deg", [90.0, 20.0])
def test_a_pane_before_a_like_sky_is_not_seen(backend, tmp_path, elevation_deg):
    """What it reflects it does not let through: 1 before and behind shows 1."""
    pane = material(transmission={"transmissionFactor": 1.0})
    shown = seen(backend, tmp_path, pane, None, elevation_deg)
    np.testing.assert_allclose(shown, 1.0, rtol=5e-3)


def test_a_rough_pane_blurs_by_an_angle(shared_gl_backend, tmp_path):
    """The horizon behind it is as wide in a small picture as in one of four times the pixels."""
    pane = material((1, 1, 1), 0.3, transmission={"transmissionFactor": 1.0})
    corners = 4.0 * CORNERS[:, [0, 2, 1]] * [1, -1, 1]
    path = square(tmp_path, pane, corners=corners)
    shares = []
    for size in (32, 128):
        backend = shared_gl_backend(size_px=(size, size))
        backend.change(scene=opened(path, GROUND), ground_albedo_rgb=(ALBEDO,) * 3)
        light(backend, np.full((6, 16, 16, 3), 1.0))
        shown = look(backend, (0.0, 0.0, 3.0), (0.0, 0.0, 0.0), 0.8).radiance[:, size // 2, 0]
        low, high = shown.min(), shown.max()
        between = (shown > low + 0.2 * (high - low)) & (shown < low + 0.8 * (high - low))
        shares.append(between.mean())
    assert shares[1] == pytest.approx(shares[0], rel=0.4)


def test_a_body_that_does_not_bend_shows_what_is_behind_in_its_place(shared_gl_backend, tmp_path):
    """Through glass of index 1, however thick, the horizon lies where it lies without the glass."""
    backend = shared_gl_backend(size_px=(48, 48))
    backend.change(ground_albedo_rgb=(ALBEDO,) * 3)
    glass = {"transmission": {"transmissionFactor": 1.0}, "ior": {"ior": 1.0}}
    corners = 4.0 * CORNERS[:, [0, 2, 1]] * [1, -1, 1]
    columns = []
    for thickness in ({}, {"volume": {"thicknessFactor": 0.5}}):
        pane = material((1, 1, 1), 0.0, **glass, **thickness)
        backend.change(scene=opened(square(tmp_path, pane, corners=corners), GROUND))
        light(backend, np.full((6, 16, 16, 3), 1.0))
        columns.append(look(backend, (0.0, 0.4, 3.0), (0.0, 0.0, 0.0), 0.8).radiance[:, 24, 0])
    thin, thick = columns
    assert np.ptp(thin) > 0.5 * thin.max()
    np.testing.assert_allclose(thick, thin, rtol=0.1)


def test_half_of_a_pane_is_paint(backend, tmp_path):
    """A transmission of a half: half of the paint, half of what is behind, one coat."""
    paint = material((0.6, 0.6, 0.6), transmission={"transmissionFactor": 0.5})
    shown = seen(backend, tmp_path, paint)
    expected = F0 + (1.0 - F0) * 0.5 * (0.6 + 0.6 * ALBEDO)
    np.testing.assert_allclose(shown, expected, rtol=0.02)


def test_a_map_of_transmission_leaves_its_frame_solid(backend, tmp_path):
    """Black texels are paint that hides the ground, white ones are glass."""
    glass = {"transmissionFactor": 1.0, "transmissionTexture": {"index": 0}}
    paint = material((0.6, 0.6, 0.6), transmission=glass)
    for value, behind in ((0, 0.6), (255, 0.6 * ALBEDO)):
        texels = np.full((2, 2, 3), value, np.uint8)
        shown = seen(backend, tmp_path, paint, images=[texels])
        np.testing.assert_allclose(shown, F0 + (1.0 - F0) * behind, rtol=0.02)


def test_a_body_takes_light_away_by_beer_and_lambert(backend, tmp_path):
    """Half a metre of what leaves a quarter after one metre: a half."""
    volume = {
        "thicknessFactor": 0.5,
        "attenuationDistance": 1.0,
        "attenuationColor": [0.25, 1.0, 0.01],
    }
    body = material(transmission={"transmissionFactor": 1.0}, volume=volume)
    shown = seen(backend, tmp_path, body)
    expected = F0 + (1.0 - F0) * ALBEDO * np.array([0.5, 1.0, 0.1])
    np.testing.assert_allclose(shown, expected, rtol=0.02)


def test_glass_that_is_smooth_and_thin_needs_no_copy(backend, tmp_path):
    """Panes, as most windows are, are blended as they are drawn; a body looks up copies."""
    before = backend.counters.done.get("backdrop", 0)
    seen(backend, tmp_path, material(transmission={"transmissionFactor": 1.0}))
    assert backend.counters.done.get("backdrop", 0) == before
    volume = {"thicknessFactor": 0.1}
    seen(backend, tmp_path, material(transmission={"transmissionFactor": 1.0}, volume=volume))
    assert backend.counters.done["backdrop"] == before + len(FEWER_SHIFTS_PX)


@pytest.mark.parametrize("ior", [1.0, 1.33, 2.0])
def test_the_index_of_refraction_makes_the_reflectance(backend, tmp_path, ior):
    """((n - 1) / (n + 1))^2 of the sky from a black surface, seen from above."""
    shown = seen(backend, tmp_path, material((0, 0, 0), ior={"ior": ior}))
    np.testing.assert_allclose(shown, ((ior - 1) / (ior + 1)) ** 2, atol=2e-3)


def test_specular_scales_and_tints_the_reflection(backend, tmp_path):
    """Half of 4 %, of which red alone is left; none without any."""
    tinted = {"specularFactor": 0.5, "specularColorFactor": [1.0, 0.0, 0.0]}
    shown = seen(backend, tmp_path, material((0, 0, 0), specular=tinted))
    np.testing.assert_allclose(shown, [0.5 * F0, 0.0, 0.0], atol=1e-3)
    shown = seen(backend, tmp_path, material((0, 0, 0), specular={"specularFactor": 0.0}))
    np.testing.assert_allclose(shown, 0.0, atol=1e-4)


@pytest.mark.parametrize("elevation_deg", mostly_long([90.0, 15.0], lambda deg: deg < 45.0))
@pytest.mark.parametrize(
    "extensions",
    [
        {"clearcoat": {"clearcoatFactor": 1.0}},
        {"clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.4}},
        {"ior": {"ior": 2.2}},
        {"specular": {"specularFactor": 0.3}},
    ],
)
def test_white_stays_white_under_an_even_sky(backend, tmp_path, extensions, elevation_deg):
    """What a coat reflects does not reach the paint, and nothing is lost: 2 %."""
    shown = seen(backend, tmp_path, material(roughness=0.5, **extensions), None, elevation_deg)
    np.testing.assert_allclose(shown, 1.0, rtol=0.02)


@pytest.mark.parametrize("name", ["clearcoat", "ior"])
def test_white_gives_back_all_of_a_sun_on_average(backend, tmp_path, name):
    """Over views by their cosine, a rough white surface sends pi L = E: 6 %, by five views."""
    extensions = {"clearcoat": {"clearcoatFactor": 1.0, "clearcoatRoughnessFactor": 1.0}}
    extensions = extensions if name == "clearcoat" else {"ior": {"ior": 2.0}}
    sun = {"sun_direction": (0.6, 0.8, 0.0), "sun_irradiance": (np.pi / 0.8,) * 3, "sky": 0.0}
    white = material(roughness=1.0, **extensions)
    # Equal shares of cosine-weighted directions, across the sun's plane.
    cosines = np.sqrt((np.arange(5) + 0.5) / 5)
    views = np.degrees(np.arcsin(cosines))
    shown = [seen(backend, tmp_path, white, None, view, **sun)[0] for view in views]
    assert np.mean(shown) == pytest.approx(1.0, rel=0.06)


def test_a_second_coat_reflects_over_black(backend, tmp_path):
    """4 % more of the sky than the surface below, of which it covers 4 %."""
    bare = seen(backend, tmp_path, material((0, 0, 0), 1.0))[0]
    coated = material((0, 0, 0), 1.0, clearcoat={"clearcoatFactor": 1.0})
    shown = seen(backend, tmp_path, coated)[0]
    assert shown == pytest.approx(F0 + (1.0 - F0) * bare, rel=0.02)


def test_fibres_add_their_colour_and_keep_energy(backend, tmp_path):
    """Red fibres on black are red at grazing angles; on white nothing goes beyond the sky."""
    fibres = {"sheenColorFactor": [1.0, 0.0, 0.0], "sheenRoughnessFactor": 0.5}
    bare = seen(backend, tmp_path, material((0, 0, 0), 1.0), None, 10.0)
    shown = seen(backend, tmp_path, material((0, 0, 0), 1.0, sheen=fibres), None, 10.0)
    assert shown[0] > bare[0] + 0.1
    assert shown[1] < bare[1]
    white = {"sheenColorFactor": [1.0] * 3, "sheenRoughnessFactor": 0.5}
    for elevation_deg in (10.0, 90.0):
        shown = seen(backend, tmp_path, material(roughness=1.0, sheen=white), None, elevation_deg)
        np.testing.assert_allclose(shown, 1.0, rtol=0.03)


@pytest.mark.parametrize("elevation_deg", [90.0, 30.0])
def test_a_thin_film_reflects_the_sky_in_its_colours(backend, tmp_path, elevation_deg):
    """As wave optics says of a mirror under a film whose map sets its thickness: 1 %."""
    film = {
        "iridescenceFactor": 1.0,
        "iridescenceIor": 1.8,
        "iridescenceThicknessMinimum": 0.0,
        "iridescenceThicknessMaximum": 1000.0,
        "iridescenceThicknessTexture": {"index": 0},
    }
    for texel in (0, 102, 204):
        grey = material((0.6, 0.6, 0.6), metallic=1.0, iridescence=film)
        images = [np.full((2, 2, 3), texel, np.uint8)]
        shown = seen(backend, tmp_path, grey, None, elevation_deg, images)
        mu = np.sin(np.radians(elevation_deg))
        expected = film_reflectance(mu, 0.6, 1.8, 1000.0 * texel / 255.0)
        np.testing.assert_allclose(shown, expected, atol=0.012)
    assert np.ptp(shown) > 0.02


def test_anisotropy_stretches_the_suns_highlight(backend, tmp_path):
    """East to west, along u: 25 degrees off the mirror direction that way is brighter."""
    stretched = {"anisotropyStrength": 1.0}
    shown = {}
    for name, extensions in (("even", {}), ("stretched", {"anisotropy": stretched})):
        metal = material(roughness=0.3, metallic=1.0, **extensions)
        sun = {"sun_irradiance": (1.0,) * 3, "sky": 0.0}
        shown[name] = [
            seen(backend, tmp_path, metal, None, sun_direction=direction, **sun)[0]
            for direction in ((0.6, 0.8, 0.0), (0.0, 0.8, 0.6))
        ]
    assert shown["even"][0] == pytest.approx(shown["even"][1], rel=0.01)
    assert shown["stretched"][0] > 4.0 * shown["stretched"][1]


def test_an_unlit_surface_is_as_bright_as_open_ground_of_its_colour(backend, tmp_path):
    """Its colour, whichever way it faces: sky of 1 and a sun of pi / 2 on level ground make 1.5."""
    flat = material((0.2, 0.4, 0.6), unlit={})
    sun = {"sun_direction": (0.0, 1.0, 0.0), "sun_irradiance": (0.5 * np.pi,) * 3}
    shown = seen(backend, tmp_path, flat, GROUND, **sun)
    np.testing.assert_allclose(shown, 1.5 * np.array([0.2, 0.4, 0.6]), rtol=0.01)


def test_emissive_strength_multiplies_the_emission(backend, tmp_path):
    """Candelas per square metre: 683 of them are a radiance of 1."""
    glow = {**material((0, 0, 0), emissive_strength={"emissiveStrength": 1366.0}),
            "emissiveFactor": [0.5, 1.0, 0.0]}  # fmt: skip
    shown = seen(backend, tmp_path, glow, sky=0.0)
    np.testing.assert_allclose(shown, [1.0, 2.0, 0.0], rtol=1e-3, atol=1e-3)


def under_glass(backend, folder, extensions, at_x=0.0, height=0.5, direction=(0.0, 1.0, 1e-6)):
    """Radiance (3,) of ground of albedo 0.3, 1 m below a pane, seen from below the pane."""
    path = square(folder, material((1.0, 0.5, 0.1), **extensions), corners=4.0 * CORNERS)
    backend.change(scene=opened(path, GROUND), ground_albedo_rgb=(ALBEDO,) * 3)
    sun = {"sun_direction": direction, "sun_irradiance": (np.pi,) * 3}
    light(backend, np.zeros((6, 8, 8, 3)), **sun)
    eye = (at_x, -1.0 + height, 1e-3)
    return look(backend, eye, (at_x, -1.0, 0.0), 0.1).radiance[16, 16]


def test_the_sun_shines_through_glass(backend, tmp_path):
    """Below the pane what its coat and its colour leave, beside it all: no black shadow."""
    glass = {"transmission": {"transmissionFactor": 1.0}}
    shown = under_glass(backend, tmp_path, glass)
    np.testing.assert_allclose(shown, ALBEDO * 0.96 * np.array([1.0, 0.5, 0.1]), rtol=0.02)
    np.testing.assert_allclose(under_glass(backend, tmp_path, glass, 10.0), ALBEDO, rtol=0.02)


def test_what_stands_before_glass_is_not_tinted(backend, tmp_path):
    """On the sunny side of the pane all of the sun arrives."""
    glass = {"transmission": {"transmissionFactor": 1.0}}
    # The sun from below: ground above it would be lit through, the pane is behind.
    before = under_glass(backend, tmp_path, glass, 0.0, direction=(0.0, 1.0, 1e-6))
    path = square(
        tmp_path,
        material((1.0, 0.5, 0.1), **glass),
        corners=4.0 * CORNERS - [0.0, 1.5, 0.0],
    )
    backend.change(scene=opened(path, GROUND))
    shown = look(backend, (0.0, -0.5, 1e-3), (0.0, -1.0, 0.0), 0.1).radiance[16, 16]
    np.testing.assert_allclose(shown, ALBEDO, rtol=0.02)
    assert before[2] < 0.2 * shown[2]


def test_a_scene_without_glass_has_no_map_for_it(backend, tmp_path):
    """What a scene does not use costs nothing."""
    path = square(tmp_path, material())
    backend.change(scene=opened(path, GROUND))
    seen(backend, tmp_path, material())
    assert not backend.backend._scene.dims_sun

"""Surfaces lit by the light map: what a texel holds is what a pixel shows.

The sky is uniform with radiance 1 unless a test says so: the open sky's irradiance is pi.
"""

import numpy as np
import pytest
from air_stage import air_of, volume_of
from house_fixtures import filter_rounding
from light_map_stage import (
    PROBES,
    RECTANGLE_PX,
    even,
    fetched,
    laid,
    lit,
    on_chart,
    uneven,
)
from scene_stage import light, look, square, surface
from stateful_backend import opened

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.reflection import DIELECTRIC_F0, reflectance_table
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.light_map import GroundChart, LightMapLaid, SurfaceLightChanged
from vrut_lite.render.change_of_light import change_of_light
from vrut_lite.render.still_picture import FEWER_SHIFTS_PX
from vrut_lite.scene.scene_state import FrameSkips

pytestmark = pytest.mark.gl
SIZE = 48
ABOVE = ((0.0, 1.0, 1e-3), (0.0, 0.0, 0.0), 2 * np.arctan(0.4))
# Where the rays through the middles of the pixels of `ABOVE` meet the level through the origin.
ACROSS_M = 0.4 * ((np.arange(SIZE) + 0.5) / SIZE * 2.0 - 1.0)
PLACES_M = np.stack(np.meshgrid(ACROSS_M, ACROSS_M), axis=-1)
PIXEL_M = 0.8 / SIZE
CHART = GroundChart(corner_px=(14, 0), edge_px=16, half_width_m=8.0, warp=3.0)
GROUND = GroundDisc((0.0, 0.0), 0.0, 200.0)
FACES = ("+x", "-x", "+y", "-y", "+z", "-z")


@pytest.fixture
def backend(gl_backend):
    backend = gl_backend(size_px=(SIZE, SIZE), ground_albedo_rgb=(0.5,) * 3)
    light(backend, np.ones((6, 16, 16, 3)))
    return backend


def show(backend, path, texels=None, ground=None, probes=None, values=None, corners=((1, 2),)):
    """Open a file and light it by texels (h, w, 4), a function of the layout or None."""
    scene = opened(path, ground)
    layout = laid(scene, corners, CHART if ground else None, probes)
    made = (texels or even)(layout)
    backend.change(scene=scene)
    backend.hear(layout, lit(layout, made, values))
    return layout, made


def matte(folder, albedo, **more):
    return square(folder, surface(0.0, 1.0, albedo), **more)


def paint_alone(backend, folder, draw, **more):
    """What the paint of a square sends back: white less black, for their gloss is one."""
    shown = {}
    for albedo in (0.0, 1.0):
        draw(matte(folder, albedo, **more))
        shown[albedo] = look(backend, *ABOVE).radiance.astype(float)
    return shown[1.0] - shown[0.0]


def mean_of_pictures(found_at):
    """The mean of what is found at the places that a still's shifted pictures show."""
    shifts_m = np.multiply(FEWER_SHIFTS_PX, (PIXEL_M, -PIXEL_M))
    return np.mean([found_at(PLACES_M + shift_m) for shift_m in shifts_m], axis=0)


def test_a_surface_sends_back_the_irradiance_of_its_texels(backend, gl_owner, tmp_path):
    """Linearly between texels: paint under an uneven map over paint under an even one is E / pi.

    On a card within the rounding of its filter.
    """
    made = {}

    def lit_by(texels):
        def draw(path):
            made["layout"], made["texels"] = show(backend, path, texels)

        return draw

    level = paint_alone(backend, tmp_path, lit_by(even))
    found = paint_alone(backend, tmp_path, lit_by(uneven)) / level

    def expected_at(places_m):
        at_px = np.array([1, 2]) + 0.5 + (places_m + 0.5) * (RECTANGLE_PX - 1)
        return fetched(made["texels"], at_px)[..., :3] / np.pi

    expected = mean_of_pictures(expected_at)
    np.testing.assert_allclose(
        found, expected, rtol=2e-3, atol=filter_rounding(gl_owner) * np.ptp(expected)
    )


def test_every_instance_is_lit_from_its_own_rectangle(backend, tmp_path):
    """Two places of one square: their texels are 1 and 3, and so are they."""
    nodes = [{"mesh": 0, "translation": [x, 0, 0]} for x in (-0.5, 0.5)]

    def two(layout):
        texels = even(layout).copy()
        texels[:, :10, :3], texels[:, 10:, :3] = np.pi, 3.0 * np.pi
        return texels

    def draw(path):
        show(backend, path, two, corners=((1, 2), (11, 3)))

    paint = paint_alone(backend, tmp_path, draw, nodes=nodes)[SIZE // 2]
    left, right = paint[: SIZE // 2 - 2], paint[SIZE // 2 + 2 :][::-1]
    np.testing.assert_allclose(right, 3.0 * left, rtol=2e-3)


@pytest.mark.parametrize("far_m", [0.0, 2e5])
def test_the_ground_is_its_albedo_times_the_light_of_its_chart(backend, tmp_path, far_m):
    """Albedo E / pi by the formula in double precision, also where the world's origin is far."""
    ground = GroundDisc((far_m, -far_m), 0.0, 200.0)
    nodes = [{"mesh": 0, "translation": [far_m, -5.0, -far_m]}]
    _, texels = show(backend, matte(tmp_path, 0.5, nodes=nodes), uneven, ground)
    for height_m in (1.0, 10.0):
        eye = (far_m, height_m, -far_m + 1e-3)
        picture = look(backend, eye, (far_m, 0.0, -far_m), ABOVE[2])

        def expected_at(places_m, height_m=height_m):
            return 0.5 / np.pi * fetched(texels, on_chart(CHART, height_m * places_m))[..., :3]

        expected = mean_of_pictures(expected_at)
        np.testing.assert_allclose(picture.radiance, expected, rtol=0.02)
        np.testing.assert_allclose(picture.radiance.mean(), expected.mean(), rtol=1e-3)


def test_the_ground_goes_over_into_open_ground_without_an_edge(backend, tmp_path):
    """From half the light at its chart to the open sky's at its half width, and no step between.

    Beyond it the ground is that of a picture without any map, which continues into the sky's.
    """
    path = matte(tmp_path, 0.5, nodes=[{"mesh": 0, "translation": [0, -5.0, 0]}])
    view = ((0.0, 20.0, 1e-3), (0.0, 0.0, 0.0), 2 * np.arctan(0.5))
    show(backend, path, lambda layout: even(layout, np.pi / 2), GROUND)
    row = look(backend, *view).radiance[SIZE // 2, :, 0].astype(float)
    backend.forget(LightMapLaid, SurfaceLightChanged)
    bare = look(backend, *view).radiance[SIZE // 2, :, 0]
    away_m = np.abs(20.0 * 0.5 * ((np.arange(SIZE) + 0.5) / SIZE * 2.0 - 1.0))
    np.testing.assert_allclose(row[away_m < 5.5], 0.25, rtol=1e-3)
    np.testing.assert_allclose(row[away_m > 8.2], bare[away_m > 8.2], rtol=1e-5)
    # 0.25 over some seven pixels, smoothly.
    assert np.abs(np.diff(row)).max() < 0.08


def test_without_light_the_picture_is_that_of_the_open_sky_to_the_byte(backend, tmp_path):
    """A layout alone changes nothing, and nor does light that was taken back."""
    scene = opened(matte(tmp_path, 0.5), GROUND)
    backend.change(scene=scene)
    view = ((0.7, 0.8, 0.6), (0.0, 0.0, 0.0), 0.9)
    sun = {"sun_direction": (0.5, 0.6, 0.3), "sun_irradiance": (5.0,) * 3}
    light(backend, np.ones((6, 16, 16, 3)), **sun)
    plain = look(backend, *view).radiance
    layout = laid(scene, ((1, 2),), CHART, PROBES)
    backend.hear(layout)
    np.testing.assert_array_equal(look(backend, *view).radiance, plain)
    values = np.ones((5, 4, 5, 6, 4))
    backend.hear(lit(layout, even(layout, 1.0, 0.5), values))
    assert np.abs(look(backend, *view).radiance - plain).max() > 0.05
    backend.forget(SurfaceLightChanged)
    np.testing.assert_array_equal(look(backend, *view).radiance, plain)
    backend.forget(LightMapLaid)
    np.testing.assert_array_equal(look(backend, *view).radiance, plain)


def test_a_new_hour_uploads_its_light_alone(backend, tmp_path):
    """Neither the scene's buffers nor the layout again; the same hour uploads nothing."""
    layout, _ = show(backend, matte(tmp_path, 0.5))
    look(backend, *ABOVE)
    for light_of_hour, uploads in ((lit(layout, even(layout, 1.0)), 1), (None, 0)):
        before = backend.counters.done["upload"]
        backend.hear(light_of_hour or backend.state.shown(SurfaceLightChanged))
        look(backend, *ABOVE)
        assert backend.counters.done["upload"] - before == uploads


def test_light_is_scaled_by_its_message(backend, tmp_path):
    """A dusk below half precision's range shows the same digits as a noon."""
    scene = opened(matte(tmp_path, 0.5), GROUND)
    layout = laid(scene, ((1, 2),), CHART)
    eye = ((3.0, 1.0, 0.0), (3.0, 0.0, 1e-3), 0.3)
    backend.change(scene=scene)
    backend.hear(layout)
    for irradiance, scale in ((1e-7, 2.0**-30), (3e5, 2.0**10)):
        texels = even(layout, irradiance, 1.0)
        backend.hear(lit(layout, texels, scale=scale))
        found = look(backend, *eye).radiance[SIZE // 2, SIZE // 2]
        np.testing.assert_allclose(found, 0.5 * irradiance / np.pi, rtol=1e-3)


def gradient_sky():
    """Five above, one below."""
    return np.where(texel_directions(16)[..., 1:2] > 0.0, 5.0, 1.0) * np.ones(3)


@pytest.mark.parametrize(("tilt_deg", "expected"), [(0, 1.0), (30, None), (70, 0.5)])
def test_a_normal_map_tilts_the_light_of_the_map(backend, tmp_path, tilt_deg, expected):
    """As it tilts the open sky's, but no farther than by half: the sky says nothing indoors."""
    # From the zenith alone, so that light falls as the cosine.
    light(backend, np.where(texel_directions(16)[..., 1:2] > 0.9, 1.0, 0.0) * np.ones(3))
    turned = np.radians(tilt_deg)
    normal = np.array([np.sin(turned), 0.0, np.cos(turned)])
    pixel = np.uint8(np.round((normal + 1.0) * 127.5))
    mapped = {"normalTexture": {"index": 0}}
    shown = {}
    for name, texels in (("flat", [128, 128, 255]), ("tilted", pixel)):
        paint = {}
        for albedo in (0.0, 1.0):
            material = {**surface(0.0, 1.0, albedo), **mapped}
            path = square(tmp_path, material, [np.tile(np.uint8(texels), (2, 2, 1))])
            show(backend, path)
            # Gloss takes its own share of the light by the angle: look from where they are one.
            paint[albedo] = look(backend, *ABOVE).radiance[SIZE // 2, SIZE // 2].astype(float)
        shown[name] = paint[1.0] - paint[0.0]
    harmonics = backend.state.ambient.irradiance_sh_rgb.values
    up, there = (
        evaluate_irradiance(harmonics, np.array(n))
        for n in ((0.0, 1.0, 0.0), (np.sin(turned), np.cos(turned), 0.0))
    )
    wanted = expected or (there / up)[0]
    through = coat_through(np.cos(turned)) / coat_through(1.0)
    np.testing.assert_allclose(shown["tilted"] / shown["flat"], wanted * through, rtol=0.03)


def coat_through(cosine):
    """What the coat of a rough dielectric lets through to its paint at a cosine."""
    table = reflectance_table()
    column = np.sqrt(cosine) * (table.shape[1] - 1)
    a, b = (
        np.interp(column, np.arange(table.shape[1]), table[-1, :, channel]) for channel in (0, 1)
    )
    f0 = DIELECTRIC_F0
    return 1.0 - (f0 * a + b) * (1.0 + f0 * (1.0 / (a + b) - 1.0))


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_a_mirror_shows_the_share_of_the_sky_and_the_rest_evenly(backend, tmp_path, share):
    """o L_sky + (E - o pi) / pi of a white metal under L_sky = 1: E / pi for any share o."""
    path = square(tmp_path, surface(1.0, 0.3))
    shown = {}
    for irradiance in (np.pi, 2.0 * np.pi):
        show(backend, path, lambda layout, e=irradiance: even(layout, e, share))
        shown[irradiance] = look(backend, *ABOVE).radiance[SIZE // 2, SIZE // 2]
    np.testing.assert_allclose(shown[np.pi], 1.0, rtol=5e-3)
    np.testing.assert_allclose(shown[2.0 * np.pi], 2.0, rtol=5e-3)


@pytest.mark.parametrize(("towards", "expected"), [(1.0, 1.0), (-1.0, 0.0)])
def test_gloss_mirrors_the_sky_only_where_it_is_seen(backend, tmp_path, towards, expected):
    """A metal whose mirror direction is open shows all of the sky; where things hide it, things,
    which are black here: the same light from the other side makes the difference."""
    scene = opened(square(tmp_path, surface(1.0, 0.1)), None)
    layout = laid(scene, ((1, 2),))
    # Half of the sky, in the mean of the hemisphere: a line along x, past 0 and 1.
    sky = np.array([3.0 * towards, 0.0, 0.0, 0.5])
    seen = lit(layout, even(layout, 0.5 * np.pi, 0.5), sky=sky)
    backend.change(scene=scene)
    backend.hear(layout, seen)
    aslant = look(backend, (-1.0, 1.0, 0.0), (0.0, 0.0, 0.0), 2 * np.arctan(0.1))
    np.testing.assert_allclose(aslant.radiance[SIZE // 2, SIZE // 2], expected, atol=0.02)


def mean_of_lobe(nv, roughness):
    """The mean direction (2,), ahead and up, of what a black coat seen at a cosine mirrors."""
    n, f0, alpha = 200, DIELECTRIC_F0, roughness**2
    u, turn = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n * 2.0 * np.pi)
    nh = np.sqrt((1.0 - u) / (1.0 + (alpha**2 - 1.0) * u))
    across = np.sqrt(1.0 - nh**2)
    half = np.stack([across * np.cos(turn), across * np.sin(turn), nh], axis=-1)
    view = np.array([-np.sqrt(1.0 - nv**2), 0.0, nv])
    vh = half @ view
    to = 2.0 * vh[..., None] * half - view
    nl = np.maximum(to[..., 2], 0.0)
    shadowing = nl * np.sqrt(nv**2 * (1 - alpha**2) + alpha**2)
    shadowing += nv * np.sqrt(nl**2 * (1 - alpha**2) + alpha**2)
    weight = (f0 + (1.0 - f0) * np.clip(1.0 - vh, 0.0, 1.0) ** 5) * nl * vh / (shadowing * nh)
    weight[vh <= 0.0] = 0.0
    return (weight[..., None] * to).sum(axis=(0, 1))[[0, 2]] / weight.sum()


@pytest.mark.parametrize("roughness", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("height_m", [0.2, 1.0])
def test_a_coat_sees_of_the_sky_what_its_lobe_does(backend, tmp_path, roughness, height_m):
    """Half of the sky and 0.5 more or less straight ahead or behind: the lobe's mean says it all,
    but for what is taken back where lobes are as wide as the hemisphere."""
    scene = opened(matte_coat(tmp_path, roughness), None)
    layout, shown = laid(scene, ((1, 2),)), {}
    for slope, share in ((0.0, 1.0), (0.5, 0.5), (-0.5, 0.5)):
        seen = lit(layout, even(layout, share * np.pi, share), sky=np.array([slope, 0, 0, share]))
        backend.change(scene=scene)
        backend.hear(layout, seen)
        aslant = look(backend, (-1.0, height_m, 0.0), (0.0, 0.0, 0.0), 2 * np.arctan(0.02))
        shown[slope] = aslant.radiance[SIZE // 2, SIZE // 2, 1]
    ahead, _ = mean_of_lobe(height_m / np.hypot(1.0, height_m), roughness)
    for slope in (0.5, -0.5):
        expected = 0.5 + slope * ahead * (1.0 - roughness**4)
        assert shown[slope] / shown[0.0] == pytest.approx(expected, abs=0.06)


def matte_coat(folder, roughness):
    """A square that is black but for its coat."""
    return square(folder, surface(0.0, roughness, 0.0))


def test_a_mirror_in_the_shade_does_not_shine(backend, tmp_path):
    """Less light than the share of the sky says: the reflected sky alone is left, never less."""
    path = square(tmp_path, surface(1.0, 0.3))
    show(backend, path, lambda layout: even(layout, 0.1, 0.5))
    np.testing.assert_allclose(look(backend, *ABOVE).radiance[SIZE // 2, SIZE // 2], 0.5, rtol=5e-3)


def test_where_no_sky_arrives_none_is_filtered(backend, tmp_path):
    """The picture of a closed room whose texels see no sky is the same without the filter."""
    path = square(tmp_path, surface(1.0, 0.3))
    shown = []
    for skips in (FrameSkips(), FrameSkips(unlit=False)):
        backend.change(skips=skips)
        light(backend, np.ones((6, 16, 16, 3)))
        show(backend, path, lambda layout: even(layout, 1.0, 0.0))
        before = backend.counters.done["reflection slice"]
        shown.append(look(backend, *ABOVE).radiance)
        worked = backend.counters.done["reflection slice"] > before
        assert worked is not skips.unlit
    assert backend.counters.skipped["reflection: no sky reaches what is seen"] == 1
    np.testing.assert_array_equal(*shown)
    show(backend, path, lambda layout: even(layout, 1.0, 0.1))
    backend.change(skips=FrameSkips())
    light(backend, 2.0 * np.ones((6, 16, 16, 3)))
    before = backend.counters.done["reflection slice"]
    look(backend, *ABOVE)
    assert backend.counters.done["reflection slice"] > before


@pytest.mark.parametrize(("share", "glows"), [(0.0, False), (0.5, True)])
def test_air_in_a_room_without_windows_does_not_glow(backend, tmp_path, share, glows):
    """Where none of the sky's light arrives, none is in the air before it; elsewhere all of it."""
    light(backend, np.zeros((6, 16, 16, 3)))
    show(backend, matte(tmp_path, 0.0), lambda layout: even(layout, 0.0, share))
    dark = look(backend, *ABOVE).radiance
    assert dark.max() == 0.0
    backend.hear(air_of(volume_of(1e-2, 8.0)))
    glow = look(backend, *ABOVE).radiance
    backend.forget(LightMapLaid, SurfaceLightChanged)
    in_open_air = look(backend, *ABOVE).radiance
    assert in_open_air.min() > 0.01
    np.testing.assert_allclose(glow, in_open_air if glows else dark, rtol=1e-5)


def test_the_sun_does_not_enter_where_no_sky_does(backend, tmp_path):
    """A shadow map lets it through where walls meet; texels that see no sky see no sun."""
    sun = {"sun_direction": (0.0, 1.0, 0.0), "sun_irradiance": (9.0,) * 3}
    light(backend, np.zeros((6, 16, 16, 3)), **sun)
    for share, dark in ((0.0, True), (0.01, False)):
        show(backend, matte(tmp_path, 0.5), lambda layout, o=share: even(layout, 0.0, o))
        assert bool(look(backend, *ABOVE).radiance.max() == 0.0) is dark


def planes(**irradiance):
    """Probes that all have this irradiance on their planes, else none."""
    values = np.zeros((5, 4, 5, 6, 4))
    for face, value in irradiance.items():
        values[..., FACES.index(face), :3] = value
    return values


@pytest.mark.parametrize("tilt_deg", [0, 30, 60])
def test_what_has_no_texels_is_lit_by_probes(backend, tmp_path, tilt_deg):
    """E(n) is the sum of squared cosines times the light of the planes that n looks towards."""
    half = np.radians(tilt_deg) / 2
    nodes = [{"mesh": 0, "rotation": [0, 0, -np.sin(half), np.cos(half)]}]
    weights = {"+x": np.sin(2 * half) ** 2, "+y": np.cos(2 * half) ** 2}

    def paint(values):
        def draw(path):
            show(backend, path, probes=PROBES, values=values, corners=(None,))

        return paint_alone(backend, tmp_path, draw, nodes=nodes)[SIZE // 2, SIZE // 2]

    found = paint(planes(**{"+x": 1.0, "-x": 9.0, "+y": 2.0, "-y": 9.0, "+z": 9.0, "-z": 9.0}))
    even_light = paint(planes(**dict.fromkeys(FACES, 1.0)))
    expected = weights["+x"] + 2.0 * weights["+y"]
    np.testing.assert_allclose(found / even_light, expected, rtol=5e-3)


def test_probes_are_blended_and_end_at_their_grid(backend, tmp_path):
    """Linear between two probes; beyond the grid the light of its border, finite."""
    values = np.zeros((5, 4, 5, 6, 4))
    values[..., :3] = np.arange(1.0, 6.0)[:, None, None]
    shown = {}
    for x in (-50.0, -2.0, 0.25, 2.0, 50.0):
        nodes = [{"mesh": 0, "translation": [x, 0, 0]}]
        view = ((x, 1.0, 1e-3), (x, 0.0, 0.0), 0.02)
        paint = {}
        for albedo in (0.0, 1.0):
            path = matte(tmp_path, albedo, nodes=nodes)
            show(backend, path, probes=PROBES, values=values, corners=(None,))
            paint[albedo] = look(backend, *view).radiance[SIZE // 2, SIZE // 2, 0]
        shown[x] = float(paint[1.0] - paint[0.0])
    level = shown[-2.0]
    expected = {-50.0: 1.0, -2.0: 1.0, 0.25: 3.25, 2.0: 5.0, 50.0: 5.0}
    assert {x: value / level for x, value in shown.items()} == pytest.approx(expected, rel=5e-3)


def test_the_back_of_a_sheet_is_lit_from_its_own_side(backend, tmp_path):
    """From below: not the nine of the texels, which are its front's, but the probes' light."""
    material = {**surface(1.0, 1.0), "doubleSided": True}
    path = square(tmp_path, material)
    values = planes(**{"-y": np.pi})
    show(backend, path, lambda layout: even(layout, 9 * np.pi, 0.0), None, PROBES, values)
    below = look(backend, (0.0, -1.0, 1e-3), (0.0, 0.0, 0.0), 0.3).radiance[SIZE // 2, SIZE // 2]
    above = look(backend, *ABOVE).radiance[SIZE // 2, SIZE // 2]
    np.testing.assert_allclose(below, 1.0, rtol=0.01)
    np.testing.assert_allclose(above, 9.0, rtol=0.01)


def test_without_probes_the_back_of_a_sheet_is_lit_by_the_ratio_of_open_sky(backend, tmp_path):
    """The front's light times the sky's share below: one fifth under five above and one below."""
    light(backend, gradient_sky())
    path = square(tmp_path, {**surface(1.0, 1.0), "doubleSided": True})
    show(backend, path, lambda layout: even(layout, 5 * np.pi, 0.0))
    below = look(backend, (0.0, -1.0, 1e-3), (0.0, 0.0, 0.0), 0.3).radiance[SIZE // 2, SIZE // 2]
    np.testing.assert_allclose(below, 1.0, rtol=0.03)


def lux(backend, point_m, normal):
    measured = backend.backend.illuminance(backend.state, point_m, normal)
    assert measured.sun_lux == 0.0
    return measured.sky_lux


def test_the_light_meter_reads_the_map(backend, tmp_path):
    """On a part, on the ground, on a back and beside them all: what the texel there holds."""
    nodes = [{"mesh": 0, "translation": [x, 1.0, 0], "scale": [2, 1, 1]} for x in (0.0, 9.0)]
    path = square(tmp_path, {**surface(0.0, 1.0), "doubleSided": True}, nodes=nodes)
    ground = GroundDisc((3.0, 0.0), 0.0, 200.0)
    values = planes(**{"-y": 7.0, "+y": 5.0})
    corners = ((1, 2), None)
    _, texels = show(backend, path, uneven, ground, PROBES, values, corners)
    across = np.array([[-0.8, -0.3], [0.1, 0.4], [0.93, -0.45]])
    for x, z in across:
        at_px = np.array([1, 2]) + 0.5 + (np.array([x / 2.0, z]) + 0.5) * (RECTANGLE_PX - 1)
        expected = fetched(texels, at_px)[:3] @ [0.2126, 0.7152, 0.0722] * 683.0
        assert lux(backend, (x, 1.0, z), (0, 1, 0)) == pytest.approx(expected, rel=1e-3)
        assert lux(backend, (x, 1.0, z), (0, -1, 0)) == pytest.approx(7.0 * 683.0, rel=1e-3)
        assert lux(backend, (9.0 + x, 1.0, z), (0, 1, 0)) == pytest.approx(5.0 * 683.0, rel=1e-3)
        on_ground = fetched(texels, on_chart(CHART, np.array([x, z])))[:3]
        expected = on_ground @ [0.2126, 0.7152, 0.0722] * 683.0
        assert lux(backend, (3.0 + x, 0.0, z), (0, 1, 0)) == pytest.approx(expected, rel=1e-3)
    # In the air, and on open ground.
    for place in ((0.0, 5.0, 0.0), (60.0, 0.0, 0.0)):
        assert lux(backend, place, (0, 1, 0)) == pytest.approx(np.pi * 683.0, rel=1e-3)


def test_moving_pictures_take_over_light_that_changes_with_the_hour_alone(backend, tmp_path):
    """A finer round of rays or another layout is seen at once; with a sun that moves by a fifth of
    a degree other light comes by and by."""

    def sun_at(x):
        sun = {"sun_direction": (x, 1.0, 0.0), "sun_irradiance": (9.0,) * 3}
        light(backend, np.ones((6, 16, 16, 3)), **sun)

    sun_at(0.0)
    layout, _ = show(backend, matte(tmp_path, 0.5))
    before = backend.state
    np.testing.assert_array_equal(change_of_light(before, backend.state), np.ones(3))
    backend.hear(lit(layout, even(layout, 2.0)))
    assert change_of_light(before, backend.state) is None
    sun_at(0.004)
    np.testing.assert_allclose(change_of_light(before, backend.state), np.ones(3))
    finer = laid(backend.state.scene, ((1, 2),), key="finer")
    backend.hear(finer, lit(finer, even(finer, 2.0)))
    assert change_of_light(before, backend.state) is None

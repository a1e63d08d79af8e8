"""What glossy surfaces reflect of the sky: numbers, the filter on the GPU, and pixels."""

import ctypes
import gc
import weakref

import numpy as np
import pytest
from light_messages import light_messages
from long_parameters import mostly_long
from scene_stage import light, look, square, surface
from stateful_backend import opened

from vrut_lite.geometry import reflection
from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles
from vrut_lite.sky.relight_scale import age_factor

TOP = np.array([0.0, 1.0, 0.0])


def clear_sky(size):
    """A sky with what is hard in real ones: a horizon, a gradient and an aureole; per channel."""
    d = texel_directions(size)
    up, sun = d[..., 1], d @ np.array([0.6, 0.48, 0.64])
    sky = 1.0 + 2.0 * np.exp(-4.0 * np.maximum(up, 0.0)) + 8.0 * np.exp(-40.0 * (1.0 - sun))
    radiance = np.where(up > 0.0, sky, 0.4)
    return radiance[..., None] * np.array([0.7, 1.0, 1.4])


def brdf_integral(mu, roughness, steps=1500):
    """One bounce of a perfect mirror's facets, by the plain formula over the hemisphere."""
    theta = (np.arange(steps) + 0.5) / steps * np.pi / 2
    phi = (np.arange(300) + 0.5) / 300 * np.pi
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    out = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
    half = out + np.array([np.sqrt(1 - mu**2), 0.0, mu])
    nh = half[..., 2] / np.linalg.norm(half, axis=-1)
    a2, nl = roughness**4, out[..., 2]
    distribution = a2 / (np.pi * (nh**2 * (a2 - 1) + 1) ** 2)
    smith = nl * np.sqrt(mu**2 * (1 - a2) + a2) + mu * np.sqrt(nl**2 * (1 - a2) + a2)
    solid_angle = np.sin(theta) * (np.pi / 2 / steps) * (2 * np.pi / 300)
    return (distribution * 0.5 / smith * nl * solid_angle).sum()


def test_a_rough_mirror_from_above_returns_one_minus_ln_2():
    """For alpha 1, D = 1 / pi and V = 1 / (2 (1 + n.l)): the integral is 1 - ln 2, exactly."""
    a, b = reflection.reflectance(1.0, 1.0)
    assert a + b == pytest.approx(1.0 - np.log(2.0), rel=1e-3)


@pytest.mark.parametrize("roughness", [0.5, 0.8, 1.0])
@pytest.mark.parametrize("mu", [0.1, 0.5, 0.95])
def test_the_shares_are_the_integral_of_the_brdf(mu, roughness):
    """Facets sampled as they are visible, against glTF's formula summed over directions: 0.5 %."""
    a, b = reflection.reflectance(mu, roughness)
    assert a + b == pytest.approx(brdf_integral(mu, roughness), rel=5e-3)


def test_a_mirror_loses_nothing_and_no_surface_gives_more_than_it_gets():
    """a + b is 1 for a mirror, never more; with all bounces a white metal returns all."""
    table = reflection.reflectance_table()
    one_bounce = table[..., 0] + table[..., 1]
    np.testing.assert_allclose(one_bounce[0, 2:], 1.0, rtol=1e-3)
    assert one_bounce.max() <= 1.0 + 1e-6
    a, b = table[..., 0], table[..., 1]
    np.testing.assert_allclose(reflection.all_bounces(1.0, 1.0, a, b), 1.0, rtol=1e-12)
    assert np.all(reflection.all_bounces(0.04, 1.0, a, b) < 1.0)


def test_the_widest_lobe_is_the_cosine():
    """For alpha 1 the lobe is max(n.l, 0): of radiance 1 + l.n its mean is 1 + 2/3."""
    cube = 1.0 + texel_directions(32)
    mean = reflection.prefiltered(cube, np.eye(3), 1.0)
    np.testing.assert_allclose(np.diag(mean), 1.0 + 2.0 / 3.0, rtol=1e-3)
    np.testing.assert_allclose(mean[0, 1:], 1.0, rtol=1e-3)


@pytest.mark.parametrize("roughness", [0.2, 0.35, 0.6, 1.0])
def test_a_uniform_sky_is_uniform_however_blurred(roughness):
    """A mean of equals."""
    mean = reflection.prefiltered(np.full((6, 32, 32, 3), 2.5), texel_directions(2), roughness)
    np.testing.assert_allclose(mean, 2.5, rtol=1e-12)


# --- on the GPU -----------------------------------------------------------------------


@pytest.fixture
def backend(gl_backend):
    return gl_backend(size_px=(48, 48))


def filtered_levels(owner, cube):
    """The filter's levels, each (6, n, n, 3), of a cube map."""
    from OpenGL import GL
    from OpenGL.raw.GL.VERSION.GL_1_1 import glGetTexImage

    from vrut_lite.kernel.work_counters import WorkCounters
    from vrut_lite.render.light import SkyTexture
    from vrut_lite.render.passes.specular_filter import LEVEL_ROUGHNESS, SpecularFilter

    def work(context):
        size = cube.shape[1]
        rgba = np.ones((6, size, size, 4), np.float16)
        rgba[..., :3] = cube
        source = context.texture_cube((size, size), 4, rgba.tobytes(), dtype="f2")
        context.enable_direct(0x884F)
        ours = SpecularFilter(context, WorkCounters())
        ours.update(SkyTexture(source, 1.0, source), None)
        levels = []
        GL.glBindTexture(GL.GL_TEXTURE_CUBE_MAP, ours.texture.glo)
        for level in range(len(LEVEL_ROUGHNESS)):
            n = ours.texture.size[0] >> level
            texels = np.zeros((6, n, n, 4), np.float32)
            for face in range(6):
                target, at = GL.GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, texels[face].ctypes
                glGetTexImage(target, level, GL.GL_RGBA, GL.GL_FLOAT, at.data_as(ctypes.c_void_p))
            levels.append(texels[..., :3])
        ours.release()
        source.release()
        return dict(zip(LEVEL_ROUGHNESS, levels, strict=True))

    return owner.call(work)


@pytest.mark.gl
def test_the_gpus_filter_is_the_exact_one(gl_owner):
    """Every level against all texels weighed in float64: within 1 % of the brightest, 0.3 % rms."""
    cube = clear_sky(64).astype(np.float16).astype(float)
    for roughness, texels in filtered_levels(gl_owner, cube).items():
        step = max(1, texels.shape[1] // 8)
        some = (slice(None), slice(0, None, step), slice(0, None, step))
        exact = reflection.prefiltered(cube, texel_directions(texels.shape[1])[some], roughness)
        error = np.abs(texels[some] - exact) / exact.max()
        assert error.max() < 0.01
        assert np.sqrt(np.mean(error**2)) < 0.003


@pytest.mark.gl
@pytest.mark.parametrize(
    "roughness", mostly_long([0.0, 0.1, 0.3, 0.6, 1.0], (0.0, 0.3, 1.0).__contains__)
)
@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_white_surfaces_vanish_in_a_white_furnace(backend, tmp_path, metallic, roughness):
    """Under a uniform sky a white surface returns all it gets, from above and askew: 0.5 %.

    A metal whose facets shadow each other returns less by one bounce (31 % at roughness 1).
    """
    backend.change(scene=opened(square(tmp_path, surface(metallic, roughness))))
    light(backend, np.full((6, 16, 16, 3), 3.0))
    for eye in ([0.0, 1.0, 0.0], [1.0, 0.3, 0.2]):
        picture = look(backend, eye, (0, 0, 0), 0.1)
        np.testing.assert_allclose(picture.radiance, 3.0, rtol=5e-3)


@pytest.mark.gl
@pytest.mark.parametrize(
    ("metallic", "roughness"),
    [(0.0, 0.5), *(pytest.param(*p, marks=pytest.mark.long) for p in ((0.0, 1.0), (1.0, 0.7)))],
)
def test_white_surfaces_return_the_suns_light_too(backend, tmp_path, metallic, roughness):
    """The sun, summed over the hemisphere, is a uniform sky: white returns its radiance, to 1 %.

    Seen from above only the sun's height matters; Gauss's rule in the sine of it.
    """
    backend.change(scene=opened(square(tmp_path, surface(metallic, roughness))))
    nodes, weights = np.polynomial.legendre.leggauss(12)
    total = np.zeros(3)
    for sine, weight in zip(0.5 * nodes + 0.5, 0.5 * weights, strict=True):
        direction = (np.sqrt(1 - sine**2), sine, 0.0)
        irradiance = np.full(3, 2 * np.pi * weight)
        light(backend, np.zeros((6, 4, 4, 3)), sun_direction=direction, sun_irradiance=irradiance)
        total += look(backend, (0, 1, 0), (0, 0, 0), 0.02).radiance[24, 24]
    np.testing.assert_allclose(total, 1.0, rtol=0.01)


@pytest.mark.gl
def test_a_mirror_shows_the_sky_itself(backend, tmp_path):
    """A level mirror shows, upside down, what a camera below it sees through it: to 0.3 %."""
    light(backend, clear_sky(64))
    backend.change(scene=opened(square(tmp_path, surface(1.0, 0.0))))
    mirrored = look(backend, (0.0, 0.4, 0.5), (0.0, 0.0, 0.0), 0.4)
    elsewhere = square(tmp_path, nodes=[{"mesh": 0, "translation": [0, -50, 0]}])
    backend.change(scene=opened(elsewhere))
    direct = look(backend, (0.0, -0.4, 0.5), (0.0, 0.0, 0.0), 0.4)
    np.testing.assert_allclose(mirrored.radiance[::-1], direct.radiance, rtol=3e-3)


@pytest.mark.gl
@pytest.mark.parametrize(
    "roughness", mostly_long([0.12, 0.2, 0.27, 0.5, 0.8, 1.0], (0.12, 0.27, 1.0).__contains__)
)
def test_a_rough_metal_shows_the_mean_over_its_lobe(backend, tmp_path, roughness):
    """From above, where the split sum is exact, between the levels too: 4 %."""
    cube = clear_sky(256)
    light(backend, cube)
    for tilt_deg in (0.0, 40.0, 85.0):
        tilt = np.radians(tilt_deg)
        normal = np.array([np.sin(tilt), np.cos(tilt), 0.0])
        turn = {"mesh": 0, "rotation": [0, 0, -np.sin(tilt / 2), np.cos(tilt / 2)]}
        path = square(tmp_path, surface(1.0, roughness), nodes=[turn])
        backend.change(scene=opened(path))
        shown = look(backend, normal, (0, 0, 0), 0.02).radiance[24, 24]
        exact = reflection.prefiltered(cube, normal, roughness)
        np.testing.assert_allclose(shown, exact, rtol=0.04)


def coat_of_black(cube, normal, view, roughness):
    """What the coat of black paint reflects of a cube map: the BRDF's integral over directions."""
    d = texel_directions(cube.shape[1]).reshape(-1, 3)
    solid_angle = np.broadcast_to(texel_solid_angles(cube.shape[1]), cube.shape[:3]).ravel()
    nl, nv, a2 = d @ normal, view @ normal, roughness**4
    half = (d + view) / np.linalg.norm(d + view, axis=1, keepdims=True)
    distribution = a2 / (np.pi * ((half @ normal) ** 2 * (a2 - 1) + 1) ** 2)
    smith = nl * np.sqrt(nv**2 * (1 - a2) + a2) + nv * np.sqrt(nl**2 * (1 - a2) + a2)
    fresnel = 0.04 + 0.96 * (1 - np.clip(half @ view, 0, 1)) ** 5
    before = nl > 0
    weight = (distribution * fresnel * nl * solid_angle)[before] * 0.5 / smith[before]
    a, b = reflection.reflectance(nv, roughness)
    bounces = 1.0 + 0.04 * (1.0 / (a + b) - 1.0)
    return bounces * weight @ cube.reshape(-1, 3)[before]


@pytest.mark.gl
@pytest.mark.parametrize(("roughness", "most"), [(0.6, 0.28), (1.0, 0.12)])
def test_a_rough_coat_reflects_what_its_brdf_does(backend, tmp_path, roughness, most):
    """Slopes under a sky with an aureole, towards it and turned away, against the integral.

    The mean over a lobe about the mirror direction alone errs by 42 and 35 %: rough facets are
    seen from all around, and at grazing angles the surface itself cuts the lobe off.
    """
    cube = clear_sky(64)
    light(backend, cube)
    away = -np.array([0.6, 0.0, 0.8])
    for tilt_deg, height in ((0.0, 0.2), (25.0, 0.0), (60.0, 0.5), (-60.0, 3.0)):
        tilt = np.radians(tilt_deg)
        normal = np.array([0.0, np.cos(tilt), 0.0]) + np.sin(tilt) * away
        half_turn = np.append(np.sin(tilt / 2) * np.cross(TOP, away), np.cos(tilt / 2))
        turn = {"mesh": 0, "rotation": half_turn.tolist()}
        path = square(tmp_path, surface(0.0, roughness, albedo=0.0), nodes=[turn])
        backend.change(scene=opened(path))
        view = away + height * TOP
        shown = look(backend, view, (0, 0, 0), 0.02).radiance[24, 24]
        exact = coat_of_black(cube, normal, view / np.linalg.norm(view), roughness)
        np.testing.assert_allclose(shown, exact, rtol=most)


@pytest.mark.gl
def test_a_film_follows_the_sky_in_slices_and_a_still_is_finished(backend, tmp_path):
    """Another colour reaches a rough metal some frames later, whole; a still shows it at once."""
    backend.change(scene=opened(square(tmp_path, surface(1.0, 0.8))))
    cube = np.full((6, 16, 16, 3), 1.0)
    light(backend, cube)
    view = ((0, 1, 0), (0, 0, 0), 0.1)
    np.testing.assert_allclose(look(backend, *view, still=False).radiance, 1.0, rtol=5e-3)
    green = np.array([0.0, 1.0, 0.0])
    light(backend, green * cube)
    shown = [look(backend, *view, still=False).radiance for _ in range(40)]
    reds = [round(float(picture[..., 0].mean()), 2) for picture in shown]
    # White of green's luminance, then green: nothing between.
    assert sorted(set(reds)) == [0.0, 0.72]
    assert backend.counters.done["reflection slice"] == 2 * 24
    np.testing.assert_allclose(shown[-1][..., 1], 1.0, rtol=5e-3)
    light(backend, 3.0 * cube)
    look(backend, *view, still=False)
    light(backend, 4.0 * cube)
    np.testing.assert_allclose(look(backend, *view).radiance, 4.0, rtol=5e-3)


@pytest.mark.gl
def test_a_reflection_that_lags_is_as_bright_as_the_present_sky(backend, tmp_path):
    """A sky that falls to a thousandth between two moving pictures: no old light outshines it."""
    backend.change(scene=opened(square(tmp_path, surface(1.0, 0.8))))
    view = ((0, 1, 0), (0, 0, 0), 0.1)
    day = np.full((6, 16, 16, 3), 8.0)
    light(backend, day)
    look(backend, *view, still=False)
    for factor in (1e-1, 1e-2, 1e-3):
        light(backend, factor * day)
        shown = look(backend, *view, still=False).radiance
        np.testing.assert_allclose(shown, 8.0 * factor, rtol=1e-2)


@pytest.mark.gl
def test_a_leap_into_another_light_is_mirrored_at_once(backend, tmp_path):
    """From day to a green night: no moving picture mirrors the day's white, however dim."""
    backend.change(scene=opened(square(tmp_path, surface(1.0, 0.8))))
    view = ((0, 1, 0), (0, 0, 0), 0.1)
    day = np.full((6, 16, 16, 3), 8.0)
    light(backend, day)
    look(backend, *view, still=False)
    light(backend, 1e-3 * np.array([0.0, 1.0, 0.0]) * day)
    shown = look(backend, *view, still=False).radiance
    np.testing.assert_allclose(shown[..., 1], 8e-3, rtol=1e-2)
    assert shown[..., 0].max() < 1e-5


def test_what_is_of_the_present_sky_is_left_exactly_as_it_is():
    """Pictures that do not lag are the same to the bit; from darkness nothing is blown up."""
    assert age_factor(0.3, 0.3) == 1.0
    assert age_factor(0.0, 0.0) == 1.0
    assert age_factor(0.0, 0.5) == 0.0
    assert age_factor(1.0, 1e-9) == 16.0


@pytest.mark.gl
def test_the_sky_is_filtered_only_when_it_is_seen_to_change(backend, tmp_path):
    """Changes add up: two of 0.4 % are more than 0.5 %; the same sky twice is nothing."""
    backend.change(scene=opened(square(tmp_path, surface(1.0, 0.8))))
    view = ((0, 1, 0), (0, 0, 0), 0.1)
    work = []
    for factor in (1.0, 1.004, 1.008):
        light(backend, np.full((6, 16, 16, 3), 2.0 * factor))
        look(backend, *view)
        look(backend, *view)
        work.append(backend.counters.done["reflection slice"])
    assert work == [24, 24, 48]
    assert backend.counters.skipped["reflection: no change to be seen"] == 1
    assert backend.counters.skipped["reflection: the same sky"] == 3


@pytest.mark.gl
def test_a_bright_sky_keeps_its_reflection(gl_owner):
    """Near half precision's top the filter's sums must not overflow: to 0.1 % the same."""
    cube = clear_sky(32)
    plain, bright = filtered_levels(gl_owner, cube), filtered_levels(gl_owner, cube * 2.0**12)
    for roughness, texels in plain.items():
        np.testing.assert_allclose(bright[roughness], texels * 2.0**12, rtol=1e-3)


@pytest.mark.gl
def test_a_sky_that_is_no_longer_shown_is_let_go(backend, tmp_path):
    """Its texels are wanted for the next; the filter must not keep them."""
    backend.change(scene=opened(square(tmp_path, surface(1.0, 0.8))))
    view = ((0, 1, 0), (0, 0, 0), 0.1)
    background, sun, ambient = light_messages(np.ones((6, 8, 8, 3)))
    backend.change(background=background, key_light=sun, ambient=ambient)
    look(backend, *view)
    gone = weakref.ref(background.cube)
    del background
    light(backend, np.ones((6, 8, 8, 3)))
    look(backend, *view, still=False)
    gc.collect()
    assert gone() is None

"""Clouds in the frame: pixels worked out on paper, shadows, and nothing when off."""

import msgspec
import numpy as np
import pytest
from air_stage import air_of, volume_of
from cloud_stage import clouded, rough_layer, slab, slab_irradiance, slab_radiance
from clouds.drawing.cloud_pass import MARCHED, CloudPass, _picture
from clouds.model.cloud_density import distance_up_m
from clouds.sky_under_clouds import light_under_clouds
from light_messages import clear_sky_light, light_messages
from long_parameters import mostly_long
from scene_stage import light, look, square, surface
from stateful_backend import opened

from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.render.still_picture import SHIFTS_PX
from vrut_lite.sky.sky_layer import Viewpoint

pytestmark = pytest.mark.gl
EYE = (0.0, 2.0, 0.0)
BLACK = np.zeros((6, 16, 16, 3))
SUN = {"sun_direction": (0.6, 0.8, 0.0), "sun_irradiance": (90.0, 80.0, 70.0)}


@pytest.fixture
def backend(gl_backend):
    return gl_backend(size_px=(24, 16))


@pytest.fixture
def stage(backend, tmp_path):
    """A white square at the origin, on ground; black sky, sun at 53 degrees in the east."""
    backend.change(scene=opened(square(tmp_path, surface(1.0, 1.0)), GroundDisc((0, 0), 0, 600)))
    light(backend, BLACK, sun_direction=(0.6, 0.8, 0.0), sun_irradiance=(90.0, 80.0, 70.0))
    return backend


@pytest.mark.parametrize("extinction_per_m", mostly_long([2e-4, 1e-3, 5e-3], (1e-3).__ne__))
@pytest.mark.parametrize(
    "towards", mostly_long([(0.3, 1.0, 0.2), (-0.8, 0.9, 0.0)], (-0.8, 0.9, 0.0).__eq__)
)
def test_a_slab_shines_as_on_paper(stage, extinction_per_m, towards):
    """Discrete ordinates within 10 %, from thin to thick.

    The sky is black: what is seen is the slab's own light.
    """
    layer = slab(extinction_per_m=extinction_per_m)
    stage.change(**clouded(layer))
    target = np.array(EYE) + np.array(towards)
    picture = look(stage, EYE, target, 0.01)
    view = np.array(towards) / np.linalg.norm(towards)
    expected = slab_radiance(layer, EYE, view, np.array([0.6, 0.8, 0.0]))[0]
    # What the sky gives the clouds is nothing; what the ground gives, its harmonics hold: none.
    np.testing.assert_allclose(picture.radiance.mean(axis=(0, 1)), expected, rtol=0.1)


def test_a_slab_lets_the_sky_through(stage):
    """exp(-k d / mu) of a bright sky behind, to 1 %, each pixel to 2 %; the sun is off."""
    layer = slab(extinction_per_m=1e-3)
    bright = np.full((6, 16, 16, 3), 1000.0)
    light(stage, bright, sun_direction=(0.6, -0.8, 0.0))
    stage.change(ambient=light_messages(BLACK)[2])
    stage.change(**clouded(layer))
    view = np.array([0.0, 0.8, 0.6])
    picture = look(stage, EYE, np.array(EYE) + view, 0.01)
    transmittance = slab_radiance(layer, EYE, view, np.array([0.6, 0.8, 0.0]))[1]
    assert picture.radiance.mean() == pytest.approx(1000.0 * transmittance, rel=0.01)
    np.testing.assert_allclose(picture.radiance, 1000.0 * transmittance, rtol=0.02)


@pytest.mark.long
def test_ground_under_an_overcast_slab(stage):
    """albedo / pi (E mu exp(-k d / mu) + what the slab sends): within 5 %, as the meter says.

    The square is white and matte enough: a rough metal gives back all that falls on it.
    """
    layer = slab(extinction_per_m=1e-3)
    clear = light_messages(np.zeros((6, 32, 32, 3)), (0.6, 0.8, 0.0), (90.0, 80.0, 70.0))
    sky = clear_sky_light(*clear)
    view = Viewpoint(EYE, (0.0, 0.0, 0.0), 0.0)
    stage.change(**clouded(layer), sky_light=light_under_clouds((layer,), sky, view, 32, "test"))
    stage.change(ground_albedo_rgb=(0.5,) * 3)
    sun = np.array([0.6, 0.8, 0.0])
    irradiance = np.array([90.0, 80.0, 70.0])
    picture = look(stage, (0.0, 30.0, 60.0), (0.0, 0.0, 40.0), 0.05)
    bases = slab_irradiance(layer, sun)
    direct = irradiance * 0.8 * np.exp(-1e-3 * 1000.0 * 0.985 / 0.8)
    np.testing.assert_allclose(
        picture.radiance.mean(axis=(0, 1)), 0.5 / np.pi * (direct + bases), rtol=0.05
    )
    lux = stage.backend.illuminance(stage.state, (0.0, 0.0, 40.0), (0.0, 1.0, 0.0))
    weights = np.array([0.2126, 0.7152, 0.0722]) * 683.0
    assert lux.sun_lux == pytest.approx(direct @ weights, rel=0.01)
    assert lux.sky_lux == pytest.approx(bases @ weights, rel=0.05)


def test_a_cloud_is_seen_through_the_air(stage):
    """L T + (1 - T) S of an opaque layer as far off as its base: the air is even, to 1 %."""
    layer = slab(extinction_per_m=0.1)
    stage.change(**clouded(layer))
    view = np.array([0.0, 0.3, np.sqrt(1.0 - 0.09)])
    bare = look(stage, EYE, np.array(EYE) + view, 0.005).radiance.mean(axis=(0, 1))
    extinction, source = np.array([2e-5, 5e-5, 1e-4]), np.array([3.0, 5.0, 9.0])
    stage.hear(air_of(volume_of(extinction, source, sun_direction=(0.6, 0.8, 0.0))))
    seen = look(stage, EYE, np.array(EYE) + view, 0.005).radiance.mean(axis=(0, 1))
    # What is seen lies a mean free path behind where the slab's density is one: 20 m over its base.
    metres = distance_up_m(EYE[1], layer.base_m + 10.0, view[1]) + 10.0
    transmittance = np.exp(-extinction * metres)
    np.testing.assert_allclose(seen, bare * transmittance + (1 - transmittance) * source, rtol=0.01)


EYES = [
    ((0.0, 2.0, 0.0), (1.0, 2.2, 0.0)),
    ((0.0, 1500.0, 0.0), (1.0, 1500.0, 0.0)),
    ((0.0, 2500.0, 0.0), (1.0, 2499.9, 0.0)),
    ((0.0, 3e4, 0.0), (1.0, 3e4 - 0.3, 0.0)),
    ((0.0, 4e5, 0.0), (1.0, 4e5 - 0.4, 0.0)),
    ((0.0, 2e7, 0.0), (0.1, 2e7 - 1.0, 0.0)),
]


@pytest.mark.parametrize(
    "sun",
    mostly_long(
        [(0.6, 0.8, 0.0), (1.0, 0.01, 0.0), (1.0, -0.02, 0.0), (0, 1, 0)],
        (1.0, 0.01, 0.0).__eq__,
    ),
)
def test_clouds_are_finite_and_not_negative_for_every_eye(stage, sun):
    """Below, in and above the layer and from space, day and night: finite, not negative."""
    up = max(sun[1], 0.0)
    sky = np.full((6, 16, 16, 3), 4.0)
    light(stage, sky, sun_direction=sun, sun_irradiance=(90.0 * up,) * 3)
    stage.change(**clouded(rough_layer()))
    for eye, target in EYES:
        for still in (True, False):
            picture = look(stage, eye, target, 1.0, still)
            assert np.isfinite(picture.radiance).all(), eye
            assert picture.radiance.min() >= 0.0, eye


def test_a_still_is_the_full_march(gl_backend, tmp_path, monkeypatch):
    """What a still interpolates, and shares between its samples, is within 1.5 % rms of a march of
    each pixel; before a square and beside it."""
    backend = gl_backend(size_px=(96, 64))
    nodes = [{"mesh": 0, "translation": [40, 50, 0], "rotation": [0, 0, 0.70710678, 0.70710678]}]
    backend.change(scene=opened(square(tmp_path, surface(1.0, 1.0), nodes=nodes)))
    sky = np.full((6, 16, 16, 3), 4.0)
    light(backend, sky, sun_direction=(0.6, 0.8, 0.0), sun_irradiance=(90.0, 80.0, 70.0))
    layer = msgspec.structs.replace(rough_layer(), extinction_per_m=0.01)
    backend.change(**clouded(layer))
    view = EYE, (1.0, 3.2, 0.0), 0.9
    quick = look(backend, *view).radiance
    monkeypatch.setattr(CloudPass, "_still", _every_pixel)
    full = look(backend, *view).radiance
    off = quick / full - 1.0
    assert 0.0 < np.sqrt(np.mean(off * off)) < 0.015
    assert abs(off.mean()) < 0.002


def _every_pixel(drawing, clouds, view, defines, size, sample):
    """A still's clouds without another picture of them."""
    now = _picture(drawing._targets.get(size), clouds, view, defines, 0)
    drawing._march(clouds, now, 1, None)
    return now.target


def test_clouds_of_a_finished_still_lie_where_its_meshes_do():
    shown_px = [SHIFTS_PX[max(each for each in MARCHED if each <= sample)] for sample in range(8)]

    assert MARCHED[0] == 0
    assert np.abs(np.mean(shown_px, axis=0)).max() < 0.1
    assert np.abs(np.subtract(shown_px, SHIFTS_PX)).max() <= 0.4


DENSE = msgspec.structs.replace(rough_layer(), extinction_per_m=0.01)
# Where the eye is and how far it moves from one picture to the next; how far the wind blows.
MOVES = {
    "flying into clouds": ((0.0, 1500.0, 0.0), (150.0, 0.0, 0.0), 0.0),
    "flying below them": (EYE, (0.0, 0.0, 50.0), 0.0),
    "wind": (EYE, (0.0, 0.0, 0.0), 190.0),
}


@pytest.mark.parametrize("move", mostly_long(list(MOVES), "flying below them".__ne__))
def test_moving_clouds_leave_no_ghosts(gl_backend, tmp_path, move):
    """A moving picture is that which takes nothing over, within 5 % in the mean and 30 % in each
    block of 8 pixels: edges are by half a pixel beside their place."""
    eye, step_m, blown_m = MOVES[move]
    backend = gl_backend(size_px=(96, 64))
    backend.change(scene=opened(square(tmp_path, surface(1.0, 1.0))))
    _shine(backend, 1.0)
    for count in range(6):
        backend.change(**clouded(msgspec.structs.replace(DENSE, drift_m=(count * blown_m, 0.0))))
        at = np.array(eye) + count * np.array(step_m)
        view = at, at + np.array([1.0, 0.5, 0.0]), 0.9
        moving = look(backend, *view, still=False).radiance
    off = _off(moving, _taking_nothing_over(backend, view))
    assert off.any() != (move == "flying into clouds"), "all is near and new there"
    assert off.mean() < 0.05
    assert off.reshape(8, 8, 12, 8).mean(axis=(1, 3)).max() < 0.3


def test_light_on_clouds_that_is_set_is_seen_at_once(gl_backend, tmp_path):
    """A sky and a sun twice as bright: nothing is taken over from the picture before."""
    backend = gl_backend(size_px=(96, 64))
    backend.change(scene=opened(square(tmp_path, surface(1.0, 1.0))))
    backend.change(**clouded(DENSE))
    view = EYE, (1.0, 2.5, 0.0), 0.9
    for brighter in (1.0, 2.0):
        _shine(backend, brighter)
        moving = look(backend, *view, still=False).radiance
    assert _off(moving, _taking_nothing_over(backend, view, brighter)).max() < 1e-3


def _taking_nothing_over(backend, view, brighter=1.0):
    """A moving picture's radiance after one in another light, from which nothing is taken over."""
    for level in (4.0, brighter):
        _shine(backend, level)
        moving = look(backend, *view, still=False).radiance
    return moving


def _shine(backend, brighter):
    suns = {**SUN, "sun_irradiance": tuple(brighter * np.array(SUN["sun_irradiance"]))}
    light(backend, np.full((6, 16, 16, 3), 4.0 * brighter), **suns)


def _off(moving, fresh):
    """By how much of its value each pixel is off."""
    return np.abs(moving / fresh - 1.0).max(axis=-1)


def test_clouds_stand_behind_what_is_nearer(backend, tmp_path):
    """Seen from above, a thick slab hides a square under it and not the one over it."""
    layer = slab(extinction_per_m=0.1)
    for height, hidden in ((500.0, True), (2500.0, False)):
        nodes = [{"mesh": 0, "translation": [0, height, 0], "scale": [2000, 1, 2000]}]
        material = {
            "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 1.0},
            "emissiveFactor": [1, 0, 0],
        }
        backend.change(scene=opened(square(tmp_path, material, nodes=nodes)))
        light(backend, BLACK, sun_direction=(0.6, 0.8, 0.0), sun_irradiance=(90.0, 80.0, 70.0))
        backend.change(**clouded(layer))
        covered = look(backend, (0, 4000, 0), (0, 0, -1), 0.1).radiance.mean(axis=(0, 1))
        backend.change(**clouded())
        bare = look(backend, (0, 4000, 0), (0, 0, -1), 0.1).radiance.mean(axis=(0, 1))
        assert (covered[1] > 1.0) == hidden
        if not hidden:
            np.testing.assert_allclose(covered, bare, rtol=1e-6)


def test_off_costs_nothing(stage):
    """Before there were clouds and after they went: the same picture bit for bit, and no work."""
    before = look(stage, EYE, (1.0, 2.2, 0.0))
    stage.change(**clouded(rough_layer()))
    with_clouds = look(stage, EYE, (1.0, 2.2, 0.0))
    stage.change(**clouded())
    done = stage.counters.done.copy()
    after = look(stage, EYE, (1.0, 2.2, 0.0))
    assert np.array_equal(before.radiance, after.radiance)
    assert not np.array_equal(before.radiance, with_clouds.radiance)
    assert {name for name in stage.counters.done - done if "cloud" in name} == set()


@pytest.mark.long
def test_the_shadow_map_is_kept_while_it_holds(stage):
    """Wind alone moves the map; a sun that moved by 2 degrees needs another."""
    layer = rough_layer()
    stage.change(**clouded(layer))
    look(stage, EYE, (1.0, 2.2, 0.0))
    stage.change(**clouded(msgspec.structs.replace(layer, drift_m=(40.0, 10.0))))
    look(stage, EYE, (1.0, 2.2, 0.0))
    assert stage.counters.done["cloud shadow map"] == 1
    assert stage.counters.skipped["cloud shadow map: it still holds"] == 1
    light(stage, BLACK, sun_direction=(0.63, 0.777, 0.0), sun_irradiance=(90.0, 80.0, 70.0))
    look(stage, EYE, (1.0, 2.2, 0.0))
    assert stage.counters.done["cloud shadow map"] == 2

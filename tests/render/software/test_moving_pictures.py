"""Pictures while something moves: of the same things, colours and light as the finished one."""

import json
from dataclasses import replace

import numpy as np
import pytest
from box_stage import show_box, sun_at, uniform_sky
from scene_stage import light, look, square
from stateful_backend import opened
from sun_stage import box, show

from vrut_lite.messages.picture import SetExposure
from vrut_lite.render import device
from vrut_lite.render.change_of_light import change_of_light
from vrut_lite.render.device import Device
from vrut_lite.render.still_picture import FEWER_SHIFTS_PX

pytestmark = pytest.mark.gl
SUN = {"sun_direction": sun_at(35.0, 40.0), "sun_irradiance": (10.0, 9.0, 8.0)}
TARGET = (0.0, 1.0, 0.0)


@pytest.fixture
def backend(shared_gl_backend):
    return shared_gl_backend(size_px=(160, 120))


def around(angle_deg):
    angle = np.radians(angle_deg)
    return 7.0 * np.sin(angle), 3.0, 7.0 * np.cos(angle)


def test_a_camera_that_went_on_for_a_while_sees_the_finished_picture(backend, box_file):
    """What is taken over stays on its surface; what was hidden is drawn; colours are the same."""
    backend.change(scene=opened(box_file))
    light(backend, uniform_sky(1.0), **SUN)
    for angle_deg in range(0, 60, 3):
        moving = look(backend, around(angle_deg), TARGET, still=False).radiance
    finished = look(backend, around(57), TARGET).radiance
    off = np.abs(moving / finished - 1.0).max(axis=-1)
    # Edges differ, where the finished picture has more samples; rough coats by what is not seen.
    assert np.median(off) < 1e-3
    assert (off > 0.05).mean() < 0.02
    np.testing.assert_allclose(moving.mean((0, 1)), finished.mean((0, 1)), rtol=5e-3)


@pytest.mark.parametrize("far_m", [1e12, 1e30, 1e150, 1e300])
def test_a_camera_may_come_from_anywhere(backend, box_file, far_m):
    """Where the picture before was taken too far away, the next is drawn whole."""
    backend.change(scene=opened(box_file))
    light(backend, uniform_sky(1.0), **SUN)
    wanted = look(backend, around(20), TARGET, still=False).radiance
    for eye in ((far_m, 1.0, 0.0), (far_m, -far_m, far_m)):
        away = look(backend, eye, np.add(eye, (-far_m, 0.0, 0.0)), still=False)
        assert np.all(np.isfinite(away.radiance))
        found = look(backend, around(20), TARGET, still=False).radiance
        np.testing.assert_allclose(found, wanted, rtol=1e-3, atol=1e-3)


def test_another_exposure_of_a_finished_picture_draws_nothing_anew(backend, box_file):
    """It is the same to the bit; after other light, or of another view, all is drawn."""
    backend.change(scene=opened(box_file))
    light(backend, uniform_sky(1.0), **SUN)
    held = SetExposure(mode="manual", ev100=10.0)
    backend.change(exposure=held)
    wanted = look(backend, around(20), TARGET)
    drawn = backend.counters.done["picture"]
    for exposure in (SetExposure(), held):
        backend.change(exposure=exposure)
        again = backend.draw()
        assert (again.ev100 == 10.0) == (exposure is held)
    assert backend.counters.skipped["picture: the same but for its exposure"] == 2
    assert backend.counters.done["picture"] == drawn
    assert np.array_equal(again.display, wanted.display)
    assert np.array_equal(again.radiance, wanted.radiance)
    light(backend, uniform_sky(2.0), **SUN)
    assert backend.draw().radiance.mean() > 1.1 * again.radiance.mean()
    backend.change(exposure=SetExposure())
    other = look(backend, around(40), TARGET)
    assert backend.counters.done["picture"] == drawn + 2 * len(FEWER_SHIFTS_PX)
    # False colours are drawn into the same targets.
    backend.change(shows="illuminance")
    backend.draw()
    for exposure in (held, SetExposure()):
        backend.change(shows="picture", exposure=exposure)
        again = backend.draw()
    assert np.array_equal(again.display, other.display)


def test_a_camera_that_rests_soon_sees_what_is_drawn_anew(backend, box_file):
    """After sixteen pictures every pixel has had its turn, and nothing of the way there is left."""
    backend.change(scene=opened(box_file))
    light(backend, uniform_sky(1.0), **SUN)
    for angle_deg in (0, 8, 16, *17 * [24]):
        rested = look(backend, around(angle_deg), TARGET, still=False).radiance
    # Nothing is taken over under a light that is set by hand.
    light(backend, uniform_sky(0.5), **SUN)
    look(backend, around(0), TARGET, still=False)
    light(backend, uniform_sky(1.0), **SUN)
    anew = look(backend, around(24), TARGET, still=False).radiance
    np.testing.assert_allclose(rested, anew, rtol=1e-5)


def test_no_trail_stays_behind_an_edge_that_swings_past(backend, box_file):
    """Where no edge is near, the sky is the sky in the first picture that shows it again."""
    backend.change(scene=opened(box_file))
    light(backend, uniform_sky(1.0), **SUN)
    for angle_deg in range(0, 50, 10):
        moving = look(backend, around(angle_deg), TARGET, still=False).radiance[..., 1]
        finished = look(backend, around(angle_deg), TARGET).radiance[..., 1]
        sky = finished == finished[0, 0]
        for axis in (0, 1):
            sky = sky & np.roll(sky, 1, axis) & np.roll(sky, -1, axis)
        assert sky.mean() > 0.1
        np.testing.assert_allclose(moving[sky], finished[0, 0], rtol=1e-5)


@pytest.mark.parametrize("size_px", [(1, 20), (20, 1), (2, 2)])
def test_a_picture_may_be_as_small_as_a_pixel_across(backend, box_file, size_px):
    """Where nothing lies between pixels all is drawn anew; other sizes take over."""
    backend.change(scene=opened(box_file))
    light(backend, uniform_sky(1.0), **SUN)
    for angle_deg in range(3):
        for size in (size_px, (30, 20)):
            backend.change(size_px=size)
            moving = look(backend, around(angle_deg), TARGET, still=False).radiance
            assert moving.shape == (size[1], size[0], 3)
            assert np.isfinite(moving).all()
            assert moving.min() > 0.0
    backend.change(size_px=(160, 120))


def test_what_a_coat_mirrors_moves_with_the_eye(backend, tmp_path):
    """The sun's image on glossy ground is where the finished picture has it; it leaves no trace."""
    glossy = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.3}}
    backend.change(scene=opened(square(tmp_path, glossy)))
    light(backend, uniform_sky(1.0), **SUN)
    x, y, z = SUN["sun_direction"]
    for off_m in np.linspace(-0.6, 0.0, 13):
        eye = (-3.0 * x + off_m, 3.0 * y, -3.0 * z - off_m)
        moving = look(backend, eye, (0.0, 0.0, 0.0), 0.1, still=False).radiance
    finished = look(backend, eye, (0.0, 0.0, 0.0), 0.1).radiance
    assert finished.max() > 1.1 * finished.min()
    assert (np.abs(moving / finished - 1.0) > 0.05).mean() < 0.01


def test_what_is_seen_through_is_not_laid_over_itself(backend, tmp_path):
    """Half of a blended pane and half of what is behind it, in the tenth picture too."""
    pane = {"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]}}
    backend.change(scene=opened(square(tmp_path, pane)))
    light(backend, uniform_sky(1.0), **SUN)
    for _ in range(10):
        moving = look(backend, (0.0, 3.0, 0.1), (0.0, 0.0, 0.0), still=False).radiance
    finished = look(backend, (0.0, 3.0, 0.1), (0.0, 0.0, 0.0)).radiance
    np.testing.assert_allclose(np.median(moving, (0, 1)), np.median(finished, (0, 1)), rtol=1e-3)


def test_light_that_is_set_is_seen_at_once_and_that_of_the_hour_by_and_by(backend, box_file):
    """A sun half as bright shows in all of the next picture; one that moves is scaled."""
    show_box(backend, box_file)
    light(backend, uniform_sky(1.0), **SUN)
    bright = look(backend, around(0), TARGET, still=False).radiance
    before = backend.state
    light(backend, uniform_sky(0.5), **{**SUN, "sun_irradiance": (5.0, 4.5, 4.0)})
    assert change_of_light(before, backend.state) is None
    dark = look(backend, around(0), TARGET, still=False).radiance
    np.testing.assert_allclose(dark, 0.5 * bright, rtol=2e-2)

    before = backend.state
    light(backend, uniform_sky(0.49), **{**SUN, "sun_direction": sun_at(35.5, 40.0)})
    np.testing.assert_allclose(change_of_light(before, backend.state), 0.98, rtol=1e-3)
    np.testing.assert_array_equal(change_of_light(before, replace(before, size_px=(9, 9))), 1.0)
    assert change_of_light(before, replace(before, tolerance=0.1)) is None


def test_shadows_of_a_moved_sun_are_coarse_for_as_long_as_it_moves(backend, box_file):
    """A quarter of the texels show the same shadows, and no finished picture shows them."""
    show_box(backend, box_file)
    moved = {**SUN, "sun_direction": sun_at(25.0, 70.0)}
    light(backend, uniform_sky(0.1), **moved)
    finished = look(backend, around(0), TARGET).radiance
    light(backend, uniform_sky(0.1), **SUN)
    look(backend, around(0), TARGET)
    light(backend, uniform_sky(0.1), **moved)
    moving = look(backend, around(0), TARGET, still=False).radiance
    off = np.abs(moving / finished - 1.0).max(axis=-1)
    assert 0.0 < (off > 0.02).mean() < 0.03
    np.testing.assert_array_equal(look(backend, around(0), TARGET).radiance, finished)


def test_shadows_wait_in_moving_pictures_until_the_sun_has_left_its_width(backend, box_file):
    """Nearer than that shadows lie within their penumbra; a finished picture has its own sun's."""
    show_box(backend, box_file)
    light(backend, uniform_sky(0.1), **SUN)
    look(backend, around(0), TARGET)
    drawn = []
    for elevation_deg, still in ((35.4, False), (35.7, False), (36.2, False), (36.2, True)):
        before = backend.counters.done["shadow map"]
        moved = {**SUN, "sun_direction": sun_at(elevation_deg, 40.0)}
        light(backend, uniform_sky(0.1), **moved)
        look(backend, around(0), TARGET, still=still)
        drawn.append(backend.counters.done["shadow map"] - before)
    assert drawn == [0, 1, 0, 1]


def test_shadows_of_a_moving_sun_have_the_edges_of_a_picture_drawn_anew(backend, tmp_path):
    """A tower's shadow moves pixels at a time: no block of what was shaded or lit stays behind."""
    tower, ground = box((-0.5, 0.0, -0.5), (0.5, 6.0, 0.5)), box((-20, -1, -20), (20, 0, 20))
    show(backend, tmp_path, tower, ground)
    x, y, z = sun_at(36.0, 40.0)
    tip = np.array([-x, 0.0, -z]) * 5.0 / y
    eye = np.add(tip, (0.0, 5.0, 0.1))

    def seen(number, brighter=1.0):
        sun = {**SUN, "sun_direction": sun_at(35.0 + 0.2 * number, 40.0)}
        light(backend, uniform_sky(0.1 * brighter), **sun)
        return look(backend, eye, tip, still=False).radiance[..., 1]

    before = seen(0)
    for number in range(1, 10):
        moving = seen(number)
    # Nothing is taken over under a light that is set by hand.
    seen(9, 0.5)
    anew = seen(9)
    edge = 0.2 * (anew.max() - anew.min())
    assert (abs(before - anew) > edge).sum() > 100
    assert (abs(moving - anew) > edge).sum() == 0


def test_a_picture_of_few_pixels_shows_the_finer_shadows_that_it_finds(backend, box_file):
    """A wider one asks for finer shadows than those of a small one, which then shows them too."""
    show_box(backend, box_file)
    light(backend, uniform_sky(0.1), **{**SUN, "sun_direction": sun_at(30.0, 100.0)})
    drawn, seen = [], []
    for size_px in ((160, 120), (640, 480), (160, 120)):
        before = backend.counters.done["shadow map"]
        backend.change(size_px=size_px)
        seen.append(look(backend, around(0), TARGET, still=False).radiance.mean((0, 1)))
        drawn.append(backend.counters.done["shadow map"] - before)
    assert drawn == [1, 1, 0]
    np.testing.assert_allclose(seen[0], seen[1], rtol=1e-2)


def test_a_renderer_is_tried_once_and_its_row_of_the_table_known(gl_owner, tmp_path, monkeypatch):
    """Its time is kept by name and version; a damaged file is as none."""
    kept = tmp_path / "devices.json"
    monkeypatch.setattr(device, "_file", lambda: kept)
    first = gl_owner.call(device.device_of)
    kept.write_text(kept.read_text().replace(json.dumps(first.trial_ns), "2.5"))
    assert gl_owner.call(device.device_of) == first._replace(trial_ns=2.5)
    kept.write_text("{")
    assert gl_owner.call(device.device_of).trial_ns > 0.0
    assert not Device("a card", "1", 0.1).choices.takes_over
    assert Device("llvmpipe", "1", 90.0).choices.takes_over

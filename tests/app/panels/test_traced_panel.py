"""The panel of the path-traced picture, told of pictures that nobody traced."""

import msgspec
import numpy as np
import pytest
from path_tracer.messages import PathTracedPicture
from path_tracer.panel import TracedPanel, _developed
from path_tracer.remaining import Remaining, remaining_text
from PIL import Image

from vrut_lite.array import Array
from vrut_lite.messages.picture import SetExposure


def test_the_time_that_is_left_follows_from_the_paths_that_came():
    """Four paths a second: 60 more take 15 s; a picture that begins anew forgets its pace."""
    remaining = Remaining()
    assert remaining.seconds(64) is None
    for second in range(2):
        remaining.came(float(second), 4 * (second + 1))
    assert remaining.seconds(68) == pytest.approx(15.0)
    remaining.came(5.0, 1)
    assert remaining.seconds(64) is None


def test_times_are_said_roughly():
    """Nobody trusts an estimate to the second."""
    assert remaining_text(None) == remaining_text(0.0) == ""
    assert remaining_text(3.2) == "a few seconds to go"
    assert remaining_text(44.0) == "about 40 s to go"
    assert remaining_text(400.0) == "about 7 min to go"


def picture(samples, seed=1):
    noise = np.random.default_rng(seed).gamma(1.0, 1.0, (48, 64, 3)).astype(np.float32)
    return PathTracedPicture(
        radiance=Array(noise), width_px=64, height_px=48, samples=samples, samples_wanted=8
    )


def test_it_has_the_eyes_acuity_by_night():
    """By starlight grain of single pixels of 0.1 deg is finer than the eye makes out."""
    noise = picture(4)
    dim = Array((noise.radiance.values * 5e-8).astype(np.float32))
    wish = SetExposure(mode="manual", ev100=-15.0)
    grain = {}
    for angle in (0.0, np.radians(0.1)):
        told = msgspec.structs.replace(noise, radiance=dim, pixel_rad=angle)
        grain[angle] = _developed(told, -15.0, wish, denoises=False).pixels.std()
    assert grain[np.radians(0.1)] < 0.6 * grain[0.0]


@pytest.fixture
def panel(shared_headless_window, qtbot):
    panel = TracedPanel(shared_headless_window.session)
    qtbot.addWidget(panel)
    panel.driver = shared_headless_window
    panel._demand = lambda size: None
    panel.show()
    return panel


def test_a_picture_is_shown_and_saved(panel, tmp_path):
    """As shown to PNG, its radiance to EXR; another suffix is refused in a sentence."""
    assert not panel.keep.isEnabled()
    panel._hear(picture(4))
    panel.driver.until(lambda: panel.shown is not None)
    assert panel.progress.text() == "4 of 8 paths a pixel"
    panel.save(str(tmp_path / "traced.png"))
    with Image.open(tmp_path / "traced.png") as image:
        assert np.array_equal(np.asarray(image), panel.shown.pixels)
    panel.save(str(tmp_path / "traced.exr"))
    assert (tmp_path / "traced.exr").stat().st_size > 1000
    panel.save(str(tmp_path / "traced.gif"))
    assert "known are .png, .jpg, .exr" in panel.driver.problems[-1]


def test_a_panel_that_is_shown_again_has_no_picture_of_another_hour(panel):
    """It waits for the first paths of the hour that it is now."""
    panel._hear(picture(4))
    panel.driver.until(lambda: panel.shown is not None)
    panel.hide()
    panel.show()
    assert panel.shown is None
    assert not panel.keep.isEnabled()
    assert "paths a pixel" not in panel.progress.text()


def test_grain_is_taken_away_unless_asked_for(panel):
    """The preview has far less of it and about the same mean; the radiance to save is as traced."""
    pytest.importorskip("mitsuba_oidn", reason="the package mitsuba-oidn is not installed")
    assert panel.denoise.isChecked()
    panel._hear(picture(4))
    panel.driver.until(lambda: panel.shown is not None)
    smooth, radiance = panel.shown.pixels, panel.shown.radiance
    panel.denoise.click()
    panel.driver.until(lambda: panel.shown.pixels is not smooth)
    np.testing.assert_array_equal(panel.shown.radiance, radiance)
    smooth, grainy = (
        _developed(picture(4), 10.0, SetExposure(), denoises).pixels for denoises in (True, False)
    )
    assert smooth.std() < 0.6 * grainy.std()
    assert smooth.mean() == pytest.approx(grainy.mean(), rel=0.15)

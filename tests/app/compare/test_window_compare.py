"""Two skies side by side: what is shown is what the modules say at equal air."""

from datetime import UTC, datetime

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from window_driver import choose

from vrut_lite.app.compare.sky_comparison import ANGLES_DEG
from vrut_lite.app.compare.two_skies import luminance_of
from vrut_lite.kernel.messages import SetClock, SetSetting
from vrut_lite.messages.ground import ground_of
from vrut_lite.messages.haze import DEFAULT_HAZE, SetHaze
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import BackgroundChanged

NIGHT = datetime(2026, 6, 21, 23, 0, tzinfo=UTC)


@pytest.fixture
def driver(shared_headless_window):
    """The panel in sight, and what it was told since the project was opened."""
    window, panel = shared_headless_window, shared_headless_window.panel("compare")
    if window.window.docks["compare"].isVisible():
        if panel.choosers[1].currentData() != "bruneton_sky":
            choose(panel.choosers[1], "bruneton_sky")
        opening = window.comparisons[0].two.wish
        window.until(lambda: window.comparisons[-1].two.wish == opening)
        window.comparisons[:-1], window.spectra[:] = [], []
    else:
        show_comparison(window)
    return window


def show_comparison(window):
    """Show the panel, and collect what it is told."""
    panel = window.panel("compare")
    window.compare, window.comparisons, window.spectra = panel, [], []
    panel.comparison.compared.connect(window.comparisons.append)
    panel.comparison.spectra_seen.connect(window.spectra.append)
    window.window.docks["compare"].show()
    window.until(lambda: bool(window.comparisons))


def compared(driver, condition):
    """The first comparison that is as wished."""
    driver.until(lambda: any(condition(c) for c in driver.comparisons))
    return next(c for c in driver.comparisons if condition(c))


def spectra(driver, condition):
    """The first spectra that are as wished."""
    driver.until(lambda: any(condition(s) for s in driver.spectra))
    return next(s for s in driver.spectra if condition(s))


@pytest.mark.long
def test_two_models_are_shown_at_equal_haze(driver):
    """Hosek-Wilkie beside Bruneton at AOD 0.20, turbidity 3 (Preetham 1999), or itself."""
    two = driver.comparisons[0].two
    assert [look.module for look in two.looks] == ["dynamic_skylight", "bruneton_sky"]
    assert two.wish.haze == DEFAULT_HAZE
    ground = ground_of(driver.session)
    assert two.wish.shared == {"albedo": pytest.approx(ground.albedo)}
    assert [label.text() for label in driver.compare.hazes] == ["optical depth 0.201 at 550 nm"] * 2
    # What the model calls equal haze, from the table that was fitted to it.
    assert (
        "has the shape of continental haze of this depth at turbidity 7.6"
        in driver.compare.aerosol.text()
    )
    # Nothing was pointed at: no axes without a curve.
    assert driver.compare.plots.spectrum.isHidden()
    low, middle, high = driver.comparisons[0].ratios
    assert low < middle < high
    assert f"{middle:.2f} in the middle" in driver.compare.ratio.text()
    choose(driver.compare.choosers[1], "dynamic_skylight")
    same = compared(driver, lambda c: c.two.wish.modules == ("dynamic_skylight",) * 2)
    assert same.ratios == (1.0, 1.0, 1.0)
    assert np.array_equal(*same.discs)


@pytest.mark.long
def test_haze_of_both_is_slid_and_follows_the_window(driver):
    """More haze in both: the zenith near a high sun brightens; the window's own sky stays."""
    driver.compare.fields["haze"].spin.setValue(0.5)
    hazy = compared(driver, lambda c: c.two.wish.haze.optical_depth_550 == 0.5)
    zenith = ANGLES_DEG == 0.0
    assert (
        hazy.meridian_cd_m2[:, zenith] > 1.3 * driver.comparisons[0].meridian_cd_m2[:, zenith]
    ).all()
    assert "turbidity 5.98" in driver.compare.aerosol.text()
    assert driver.panel("sky").haze.value == pytest.approx(0.201)
    driver.session.send(SetHaze(optical_depth_550=0.1))
    compared(driver, lambda c: c.two.wish.haze.optical_depth_550 == 0.1)
    driver.session.send(SetSetting(module="dynamic_skylight", name="turbidity", value=4.5))
    own = compared(driver, lambda c: c.two.wish.haze.turbidity == 4.5)
    depth = own.two.wish.haze.optical_depth_550
    assert driver.compare.fields["haze"].value == pytest.approx(depth, abs=1e-3)


def test_the_curve_is_the_sky_along_the_suns_meridian(driver):
    """At the zenith it is the zenith's luminance; near the sun it is largest where the sun is."""
    first = driver.comparisons[0]
    curves = [curve.getOriginalDataset() for curve in driver.compare.plots.curves]
    for look, meridian, (angle_deg, drawn) in zip(
        first.two.looks, first.meridian_cd_m2, curves, strict=True
    ):
        zenith = luminance_of(look.cube, np.array([0.0, 1.0, 0.0]))
        assert meridian[90] == pytest.approx(zenith)
        assert np.array_equal(angle_deg, ANGLES_DEG)
        assert np.array_equal(drawn, meridian)
        sun_deg = np.degrees(np.arccos(first.two.sun.direction[1]))
        near = np.abs(ANGLES_DEG - sun_deg) < 25.0
        brightest_deg = ANGLES_DEG[near][np.argmax(meridian[near])]
        assert brightest_deg == pytest.approx(sun_deg, abs=2.0)


@pytest.mark.long
def test_a_click_into_the_sky_asks_for_its_spectra(driver, qtbot):
    """Both modules tell the spectrum of what was clicked; of what is pointed at in the picture."""
    disc = driver.compare.discs[0]
    spot = disc.position_of((0.0, 0.5, 0.866)).toPoint()
    qtbot.mouseClick(disc, Qt.MouseButton.LeftButton, pos=spot)
    answer = spectra(driver, lambda s: s.direction[2] > 0.8)
    assert answer.direction == pytest.approx((0.0, 0.5, 0.866), abs=0.02)
    for seen, curve in zip(answer.seen, driver.compare.plots.spectra, strict=True):
        assert seen.direction == answer.direction
        assert max(seen.radiance) > 0.01
        assert tuple(curve.getOriginalDataset()[1]) == seen.radiance
    assert len(driver.comparisons) == 1, "the skies themselves are not made again"
    pointed = []
    driver.window.desk.viewport.sky_pointed.connect(pointed.append)
    qtbot.mouseMove(driver.window.desk.viewport, QPoint(100, 4))
    driver.until(lambda: bool(pointed))
    spectra(driver, lambda s: s.direction == pointed[-1])


def test_at_night_there_is_a_sky_and_the_lack_of_a_spectrum_is_told(driver):
    """Hosek and Wilkie's model ends with the day; what shines at night is told in colours alone."""
    driver.session.send(SetClock(instant=NIGHT))
    night = compared(driver, lambda c: c.two.sun.elevation_rad < 0.0)
    assert (night.meridian_cd_m2 < 1.0).all()
    assert spectra(driver, lambda s: not s.seen[0].radiance).seen[1].radiance
    assert driver.compare.status.text() == "Without a spectrum here: Clear sky (fast)"


@pytest.mark.long
def test_the_fisheye_knows_where_north_is(driver, qtbot):
    """North at the top whatever the scene's axes: a click at the top is true north."""
    driver.session.send(SetPlace(latitude_deg=50.0, longitude_deg=14.0, north_offset_rad=np.pi / 2))
    compared(driver, lambda c: c.two.wish.place.north_offset_rad > 1.0)
    disc = driver.compare.discs[0]
    pointed = []
    disc.pointed.connect(pointed.append)
    qtbot.mouseClick(disc, Qt.MouseButton.LeftButton, pos=QPoint(disc.width() // 2, 20))
    # The scene's -Z points east, so north lies at world -X.
    assert pointed[0][0] < -0.8


@pytest.mark.long
def test_nothing_is_compared_out_of_sight(headless_window):
    """The second kernel, which is asked for the sun's day, makes no sky for a hidden panel."""
    driver, looked_up = headless_window, []
    driver.session.send(SetClock(instant=NIGHT))
    driver.settled()
    driver.session.look_up(lambda second: second.kernel.last(BackgroundChanged), looked_up.append)
    driver.until(lambda: bool(looked_up))
    assert looked_up == [None]


@pytest.mark.long
def test_a_day_that_is_looked_up_leaves_the_comparison_as_it_is(headless_window):
    """Both ask one kernel: after a day of another date, spectra are those of the hour shown."""
    driver = headless_window
    show_comparison(driver)
    before = spectra(driver, lambda s: s.seen[0] is not None)
    driver.session.look_up(lambda second: second.sun_at(NIGHT), lambda sun: None)
    driver.compare.comparison.look_along((0.0, 1.0, 1e-9))
    after = spectra(driver, lambda s: s.direction[2] > 0.0)
    assert after.seen[1].radiance == pytest.approx(before.seen[1].radiance, rel=1e-3)

"""Exposure, read-outs and files, on real pictures."""

import math
from datetime import timedelta

import numpy as np
import OpenEXR
import pytest
from PIL import Image
from PySide6.QtCore import QPoint, Qt
from window_driver import NOON

from vrut_lite.kernel.messages import SetClock, SetClockRate, Tick
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.picture import PictureClicked, SetExposure

pytestmark = pytest.mark.gl


@pytest.fixture
def driver(shared_drawn_window):
    """A window that shows a finished picture in all light between surfaces."""
    driver = shared_drawn_window
    driver.picture = driver.panel("picture")
    driver.until(lambda: driver.session.shown.still and not driver.session.shown.refining)
    return driver


def shown_after(driver, act):
    """The first finished picture that came after an act."""
    seen = []
    driver.session.picture_shown.connect(lambda shown: seen.append(shown))
    act()
    driver.settled()
    seen.clear()
    driver.until(lambda: any(shown.still for shown in seen))
    return next(shown for shown in seen if shown.still).picture


def test_two_stops_of_compensation_make_the_picture_brighter(driver):
    """The exposure falls by just two; the radiance is the same."""
    before = shown_after(driver, lambda: driver.session.send(SetExposure()))
    field = driver.picture.compensation_ev
    after = shown_after(driver, lambda: field.spin.setValue(2.0))
    assert after.ev100 == pytest.approx(before.ev100 - 2.0, abs=1e-3)
    assert after.display.mean() > before.display.mean() + 10
    assert np.median(after.radiance) == pytest.approx(np.median(before.radiance), rel=1e-3)


def test_a_locked_exposure_begins_where_automatic_left_off(driver):
    """Locking changes nothing; then the typed EV100 holds."""
    metered = shown_after(driver, lambda: driver.session.send(SetExposure())).ev100
    driver.heard.clear()
    driver.picture.lock.click()
    wish = driver.until_heard(SetExposure)
    assert (wish.mode, wish.ev100) == ("manual", pytest.approx(metered, abs=0.01))
    driver.until(lambda: driver.picture.ev100.isEnabled())
    picture = shown_after(driver, lambda: driver.picture.ev100.spin.setValue(10.0))
    assert picture.ev100 == 10.0


def test_the_exposure_is_locked_by_an_action_and_the_project_keeps_it(driver):
    """It locks and unlocks; panel, menu and project file agree; a lock leaves nothing to meter."""
    metered = shown_after(driver, lambda: driver.session.send(SetExposure())).ev100
    actions = driver.window.actions_by_name
    assert actions["meter exposure"].isEnabled()
    actions["lock exposure"].trigger()
    driver.until(lambda: driver.picture.lock.isChecked() and actions["lock exposure"].isChecked())
    assert not actions["meter exposure"].isEnabled()
    assert not driver.picture.meter.isEnabled()
    kept = driver.project.exposure
    assert (kept.mode, kept.ev100) == ("manual", pytest.approx(metered, abs=0.01))
    actions["lock exposure"].trigger()
    driver.until(lambda: not driver.picture.lock.isChecked())
    assert not actions["lock exposure"].isChecked()
    assert driver.project.exposure.mode == "auto"


@pytest.mark.long
def test_a_held_exposure_is_metered_by_an_action(driver, qtbot):
    """Playing time holds the exposure, so that the evening darkens; then it is metered."""
    # The camera that the project has just brought adapts the exposure for a while.
    driver.session.send(SetClock(instant=NOON - timedelta(minutes=10)))
    driver.settled()
    qtbot.wait(1600)
    noon = shown_after(driver, lambda: driver.session.send(SetClock(instant=NOON))).ev100
    play = (SetClockRate(rate=3600.0), Tick(elapsed_s=8.0))
    played = shown_after(driver, lambda: driver.session.send(*play))
    assert driver.local().hour == 21
    assert played.ev100 == pytest.approx(noon, abs=0.1)
    assert "held" in driver.picture.metered.text()
    evening = shown_after(driver, driver.window.actions_by_name["meter exposure"].trigger)
    assert evening.ev100 < noon - 2.0
    driver.session.send(SetClock(instant=NOON))


def test_tone_map_white_and_reset_go_out(driver):
    """Each control of the panel sets its field of SetExposure and leaves the others."""
    driver.picture.tone_map.setCurrentIndex(driver.picture.tone_map.findData("none"))
    driver.picture.tone_map.activated.emit(0)
    driver.picture.white_temperature_k.spin.setValue(4000)
    driver.picture.white_duv.spin.setValue(0.01)
    wish = driver.until_heard(SetExposure, lambda m: m.white_duv == 0.01)
    assert (wish.tone_map, wish.white_temperature_k) == ("none", 4000.0)
    driver.picture.reset.click()
    driver.until_heard(SetExposure, lambda m: m == SetExposure())
    driver.until(lambda: driver.picture.white_temperature_k.value == 6504.0)


def test_the_light_under_the_pointer_is_read(driver, qtbot):
    """cd/m2 is the picture's own; lux on the dial's plate are those of the light meter."""
    view = driver.window.desk.viewport
    driver.until(lambda: driver.session.shown.still)
    spot = QPoint(view.width() // 2, view.height() - 20)
    qtbot.mouseMove(view, spot)
    driver.until(lambda: "lx" in view.probe.text)
    shown = driver.session.shown.picture
    height, width = shown.display.shape[:2]
    x, y = spot.x() * width // view.width(), spot.y() * height // view.height()
    written = float(view.probe.text.split(" cd/m²")[0].replace(",", ""))
    assert written == pytest.approx(shown.luminance_cd_m2(x, y), rel=0.02)
    light = driver.asked(lambda stage: stage.light_at_pixel(x, y))
    assert f"{light.lux:,.0f} lx" in view.probe.text
    # A clear midsummer noon in Prague: some 100 klx by sun and sky together.
    assert 5e4 < light.lux < 1.5e5


def test_the_sky_has_luminance_and_no_lux(driver, qtbot):
    """There is no surface to be lit."""
    view = driver.window.desk.viewport
    qtbot.mouseMove(view, QPoint(view.width() // 2, 5))
    driver.until(lambda: "cd/m²" in view.probe.text and "lx" not in view.probe.text)
    driver.settled()
    assert "lx" not in view.probe.text


class Clicked(Module):
    """Demands clicks in the picture, and keeps them."""

    manifest = Manifest(name="clicked", title="Clicked", version="1")

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.clicks = []
        link.demand(PictureClicked)

    @handles(PictureClicked)
    def on_click(self, click):
        self.clicks.append(click)


def test_a_module_hears_clicks_on_surfaces(driver, qtbot):
    """Point, normal, material and the picture's radiance there; not of drags, nor of the sky, nor
    while nobody demands them."""
    view, left = driver.window.desk.viewport, Qt.MouseButton.LeftButton
    driver.until(lambda: driver.session.shown.still)
    spot = QPoint(view.width() // 2, view.height() - 20)
    qtbot.mouseClick(view, left, pos=spot)
    driver.asked(lambda stage: stage.kernel.add_module(Clicked))
    driver.settled()
    qtbot.mouseClick(view, left, pos=QPoint(view.width() // 2, 5))
    qtbot.mousePress(view, left, pos=spot)
    qtbot.mouseMove(view, spot + QPoint(30, 0))
    qtbot.mouseMove(view, spot)
    qtbot.mouseRelease(view, left, pos=spot + QPoint(8, 0))
    driver.settled()
    shown = driver.session.shown
    qtbot.mouseClick(view, left, pos=spot)
    driver.settled()
    (click,) = driver.asked(lambda stage: list(stage.kernel.seats["clicked"].module.clicks))
    height, width = shown.picture.radiance.shape[:2]
    x, y = spot.x() * width // view.width(), spot.y() * height // view.height()
    assert click.radiance_rgb == pytest.approx(shown.picture.radiance[y, x].tolist())
    assert click.normal == pytest.approx((0.0, 1.0, 0.0))
    hit = driver.asked(lambda stage: stage.surface_at_pixel(*spot.toTuple()))
    assert click.position_m == pytest.approx(hit.point_m.tolist(), abs=0.05)
    assert click.material == hit.material != ""


def exported(driver, path):
    """The window's size in pixels when the picture was exported: docks that come late change it.

    The engine hears of a new size a moment later than the window.
    """
    viewport, panel = driver.window.desk.viewport, driver.panel("export")

    def size():
        return driver.asked(lambda stage: stage.state.size_px)

    while True:
        driver.until(lambda: size() == viewport.pixels)
        drawn = viewport.pixels
        panel.export(str(path))
        driver.until(lambda: str(path) in panel.status.text())
        if size() == viewport.pixels == drawn:
            return drawn


@pytest.mark.parametrize("suffix", [".png", ".exr"])
def test_the_picture_is_exported(driver, tmp_path, suffix):
    """PNG as shown, EXR as radiance in W m^-2 sr^-1, in the window's full size."""
    path = tmp_path / f"picture{suffix}"
    width, height = exported(driver, path)
    if suffix == ".png":
        with Image.open(path) as image:
            assert image.size == (width, height)
            assert "Europe" not in image.info["time"]
            assert image.info["time"].startswith("2026-06-21 13:00")
    else:
        pixels = OpenEXR.File(str(path)).channels()["RGB"].pixels
        assert pixels.shape == (height, width, 3)
        assert np.median(pixels) > 1.0


def test_a_picture_of_an_unknown_kind_is_refused_in_one_line(driver, tmp_path):
    """And nothing is written."""
    driver.panel("export").export(str(tmp_path / "picture.bmp"))
    driver.until(lambda: ".bmp" in driver.window.news.text())
    assert list(tmp_path.glob("picture*")) == []


def test_while_moving_pictures_are_smaller_where_they_take_long(driver, qtbot):
    """The size falls with the time a picture takes; at rest the picture is whole."""
    from vrut_lite.app.engine.pacing import QUICK_S, SCALES, Pacing
    from vrut_lite.render.device import Device

    pacing = Pacing()
    assert pacing.quick_scale() == 1.0
    # The first picture of all comes soon, on a processor too.
    pacing.expect(Device("llvmpipe", "4.5", 95.0).choices.expected_s)
    assert pacing.quick_scale() == SCALES[-1]
    pacing.drew(0.25, 1e-4)
    assert pacing.quick_scale() == 1.0
    for seconds in (0.3, 1.0, 30.0):
        for _ in range(20):
            pacing.drew(1.0, seconds)
        scale = pacing.quick_scale()
        assert scale == SCALES[-1] or seconds * scale**2 <= QUICK_S
    assert scale == SCALES[-1]
    # The first picture of another size takes less over: it tells nothing of the next.
    for seconds in (1e-4, 30.0):
        pacing.drew(1.0 if seconds < 1.0 else 0.5, seconds, "taken over")
    assert pacing.quick_scale("taken over") == 1.0
    # Under another light much of the time does not depend on the size: a coarse picture saves none.
    pacing.drew(1.0, 3 * QUICK_S, "taken over, relit")
    assert SCALES[-1] < pacing.quick_scale("taken over, relit") < 1.0
    pacing.drew(1.0, 0.5 * QUICK_S, "taken over, relit")
    assert pacing.quick_scale("taken over, relit") == 1.0
    driver.until(lambda: driver.session.shown.still)
    width, height = driver.window.desk.viewport.pixels
    assert driver.session.shown.picture.display.shape == (height, width, 3)


def test_the_picture_of_the_window_shows_the_frame(driver):
    """The widget paints the drawn pixels unchanged, apart from overlays."""
    driver.until(lambda: driver.session.shown.still)
    view = driver.window.desk.viewport
    image = view.grab().toImage()
    shown = driver.session.shown.picture.display
    height, width = shown.shape[:2]
    for x, y in ((0.3, 0.2), (0.7, 0.6)):
        pixel = image.pixelColor(int(x * view.width()), int(y * view.height()))
        drawn = shown[int(y * height), int(x * width)]
        assert math.dist((pixel.red(), pixel.green(), pixel.blue()), drawn) < 12

"""The window where a graphics card draws, which a trial's stated time says."""

import numpy as np
import pytest
from house_fixtures import CARD_NS
from lost_context import destroy_context
from PySide6.QtCore import Qt
from window_driver import NOON, SMALL, WindowDriver

from vrut_lite.app.engine.stage import GlStage
from vrut_lite.kernel.messages import SetClock
from vrut_lite.messages.view_light import ViewLightChanged
from vrut_lite.pictures.picture import PictureOnCard
from vrut_lite.render.gl_owner import GlOwner

pytestmark = pytest.mark.gl


@pytest.fixture
def driver(qtbot, tmp_path):
    driver = WindowDriver(qtbot, lambda: GlStage(GlOwner(CARD_NS)), tmp_path, SMALL)
    yield driver
    driver.close()


def test_moving_pictures_stay_on_the_card_and_a_finished_one_is_read(driver):
    """The window meters and shows the former without their radiance; cd/m2 under the pointer come
    with the latter. The sky is the card's, and the profiler says so."""
    pictures, probe = [], driver.window.desk.viewport.probe
    driver.session.picture_shown.connect(lambda shown: pictures.append(shown))
    driver.activated()
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_F3)
    driver.session.send(SetClock(instant=NOON.replace(minute=20)))
    driver.until(lambda: any(not shown.still for shown in pictures))
    probe.point_at(0.5, 0.2)
    driver.until(lambda: bool(pictures) and pictures[-1].still)
    moving = [shown.picture for shown in pictures if not shown.still]
    assert all(isinstance(picture, PictureOnCard) for picture in moving)
    assert not any("radiance" in vars(picture) for picture in moving)
    assert moving[-1].display.mean() == pytest.approx(pictures[-1].picture.display.mean(), abs=4)
    driver.until(lambda: "cd/m" in probe.text)
    driver.until(lambda: "sky computed by" in {line.name for line in driver.window.profiler.lines})
    lines = {line.name: line.value for line in driver.window.profiler.lines}
    assert lines["sky computed by"].startswith("card, 1024")
    assert "light computed by" in lines
    assert driver.problems == []


@pytest.mark.long
def test_a_reset_driver_leaves_the_window_its_picture(driver):
    """It is drawn again with the next input, to the byte, with a line and without a problem."""
    pictures, lines = [], []

    def take(shown):
        # The light of a still's points comes when the bake has all rays.
        if any(isinstance(message, ViewLightChanged) for message in driver.heard):
            pictures.append(shown)

    driver.session.picture_shown.connect(take)
    driver.window._warnings.logged.connect(lines.append)
    owner = driver.asked(lambda stage: stage.host.gl)

    def shown_at(minute):
        """The finished picture of that minute."""
        driver.heard.clear()
        pictures.clear()
        driver.session.send(SetClock(instant=NOON.replace(minute=minute)))
        driver.until(lambda: bool(pictures) and pictures[-1].still and not pictures[-1].refining)
        return pictures[-1].picture

    before = shown_at(NOON.minute)
    destroy_context(owner)
    shown_at(40)
    after = shown_at(NOON.minute)
    assert owner.resets == 1
    assert np.array_equal(after.radiance, before.radiance)
    assert [line.split(":")[0] for line in lines] == ["the graphics driver failed"]
    assert driver.problems == []

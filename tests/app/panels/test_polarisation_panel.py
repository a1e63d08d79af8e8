"""The panel of the sky's polarisation, on a window's engine."""

import pytest
from bruneton_sky.panel import PolarisationPanel
from light_stage import box_file
from PySide6.QtWidgets import QApplication
from window_driver import NOON, PATIENCE_MS, HeadlessStage

from vrut_lite.app.engine.session import Session
from vrut_lite.kernel.messages import ChooseSlot, SetClock
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene
from vrut_lite.messages.sky import SkyPolarisationChanged

# The sun 3 degrees above Prague's horizon.
EVENING = NOON.replace(hour=18, minute=45)


@pytest.fixture
def panel(qtbot, tmp_path):
    session = Session(HeadlessStage)
    panel = PolarisationPanel(session)
    qtbot.addWidget(panel)
    session.start()
    session.send(
        ChooseSlot(slot="sky", module="bruneton_sky"),
        SetPlace(latitude_deg=50.0, longitude_deg=14.4),
        SetClock(instant=NOON),
        LoadScene(path=str(box_file(tmp_path))),
    )
    yield panel
    session.close()
    session.join(PATIENCE_MS / 1e3)
    QApplication.processEvents()


def is_wanted(panel, qtbot):
    """Whether the sky has to compute polarisation."""
    answers = []
    panel._session.ask(
        lambda stage: stage.kernel.wanted(SkyPolarisationChanged) is not None, answers.append
    )
    qtbot.waitUntil(lambda: answers != [], timeout=PATIENCE_MS)
    return answers[0]


def test_a_picture_is_made_while_the_panel_is_seen(panel, qtbot):
    """It follows the hour; nothing is computed before it is shown and after it is hidden."""
    assert not is_wanted(panel, qtbot)
    panel.show()
    qtbot.waitUntil(lambda: "Brewster" in panel.facts.text(), timeout=PATIENCE_MS)
    noon = panel.shown
    panel._session.send(SetClock(instant=EVENING))
    qtbot.waitUntil(lambda: "Arago" in panel.facts.text(), timeout=PATIENCE_MS)
    assert panel.shown.zenith > 2.0 * noon.zenith
    assert panel.legend.values[0] == "0 %"
    panel.hide()
    assert not is_wanted(panel, qtbot)


def test_a_sky_without_polarisation_says_so(panel, qtbot):
    """Hosek and Wilkie's sky knows none: a sentence instead of a picture of another sky."""
    panel.show()
    qtbot.waitUntil(lambda: panel.shown is not None, timeout=PATIENCE_MS)
    panel._session.send(ChooseSlot(slot="sky", module="dynamic_skylight"))
    qtbot.waitUntil(lambda: panel.view.isHidden(), timeout=PATIENCE_MS)
    assert "does not know" in panel.facts.text()
    panel._session.send(ChooseSlot(slot="sky", module="bruneton_sky"))
    qtbot.waitUntil(lambda: panel.view.isVisible(), timeout=PATIENCE_MS)

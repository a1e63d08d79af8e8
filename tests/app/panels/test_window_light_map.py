"""The panel of the light map: its figures, and the map in false colours."""

import pytest
from light_stage import box_file
from light_transport.messages import NAME
from light_transport.module import LightTransport
from light_transport.panel import LightMapPanel
from PySide6.QtWidgets import QApplication
from window_driver import NOON, PATIENCE_MS, HeadlessStage

from vrut_lite.app.engine.session import Session
from vrut_lite.kernel.messages import SetClock, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene


class Stage(HeadlessStage):
    """With light transport, installed or not."""

    def __init__(self):
        super().__init__()
        if NAME not in self.kernel.seats:
            self.kernel.add_module(LightTransport)


@pytest.fixture
def panel(qtbot, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    session = Session(Stage)
    panel = LightMapPanel(session)
    qtbot.addWidget(panel)
    session.start()
    panel.show()
    session.send(
        SetSetting(module=NAME, name="on", value=True),
        SetSetting(module=NAME, name="quality", value="draft"),
        SetSetting(module=NAME, name="texel_m", value=1.0),
        SetPlace(latitude_deg=50.0, longitude_deg=14.0),
        SetClock(instant=NOON),
        LoadScene(path=str(box_file(tmp_path))),
    )
    yield panel
    session.close()
    session.join(PATIENCE_MS / 1e3)
    QApplication.processEvents()


def test_the_panel_shows_the_bake_and_the_map(panel, qtbot):
    """Rays, texels, memory and seconds as text; light, texel size and error as pictures."""
    qtbot.waitUntil(lambda: "128 of 128 rays" in panel.facts.text(), timeout=PATIENCE_MS)
    # The light of all rays comes after they are told.
    qtbot.waitUntil(lambda: panel._light.rays == 128, timeout=PATIENCE_MS)
    assert "MB; bake" in panel.facts.text()
    assert panel.progress.value() == panel.progress.maximum() == 128
    qtbot.waitUntil(lambda: panel.shown.picture is not None, timeout=PATIENCE_MS)
    seen = []
    for kind, unit in enumerate((" lx", " m", "%")):
        panel.kind.setCurrentIndex(kind)
        qtbot.waitUntil(
            lambda unit=unit: [v.endswith(unit) for v in panel.legend.values] == [True] * 3,
            timeout=PATIENCE_MS,
        )
        seen.append(panel.shown.picture.pixels.tobytes())
    assert len(set(seen)) == 3
    panel._session.send(SetSetting(module=NAME, name="on", value=False))
    qtbot.waitUntil(lambda: panel.facts.text().startswith("No light map"), timeout=PATIENCE_MS)

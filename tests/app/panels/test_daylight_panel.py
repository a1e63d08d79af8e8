"""The panel of daylight numbers: measured by a click, following the hour."""

from datetime import timedelta

import numpy as np
import pytest
from daylight_numbers.panel import DaylightPanel
from light_stage import box_file
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication
from window_driver import NOON, PATIENCE_MS, HeadlessStage

from vrut_lite.app.engine.session import Session
from vrut_lite.kernel.messages import SetClock
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.messages.sky import SkyRadianceChanged
from vrut_lite.messages.tolerance import SetTolerance


@pytest.fixture
def panel(qtbot, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    session = Session(HeadlessStage)
    panel = DaylightPanel(session)
    qtbot.addWidget(panel)
    panel.resize(320, 600)
    session.start()
    panel.show()
    session.send(
        SetTolerance(tolerance=1.0),
        SetPlace(latitude_deg=50.0, longitude_deg=14.0),
        SetClock(instant=NOON),
        LoadScene(path=str(box_file(tmp_path))),
    )
    for kind in (SkyRadianceChanged, SceneOpened):
        qtbot.waitUntil(lambda k=kind: session.last(k) is not None, timeout=PATIENCE_MS)
    yield panel
    session.close()
    session.join(PATIENCE_MS / 1e3)
    QApplication.processEvents()


@pytest.mark.long
def test_a_click_measures_and_the_hour_is_followed(panel, qtbot, tmp_path):
    """Lux and daylight factor of the hour; an hour later other lux and the same factor; what the
    pointer shows is the sensor's; another scene has nothing measured."""
    qtbot.mouseClick(panel.measure, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: panel.measured is not None, timeout=PATIENCE_MS)
    first = panel.measured
    assert "mean" in panel.facts.text()
    assert all(value.endswith("lx") for value in panel.legend.values)
    sensor = next(
        found
        for y in range(0, panel.view.height(), 8)
        for x in range(0, panel.view.width(), 8)
        if (found := panel.view.sensor_at(x, y)) >= 0
    )
    panel.view.pointed.emit(sensor)
    assert panel.under.text().startswith(f"{first.numbers.light.total[sensor]:,.0f} ")
    panel.kind.setCurrentText("Daylight factor")
    assert all(value.endswith("%") for value in panel.legend.values)
    panel._session.send(SetClock(instant=NOON + timedelta(hours=5)))
    qtbot.waitUntil(
        lambda: panel.measured.instant == NOON + timedelta(hours=5), timeout=PATIENCE_MS
    )
    now = panel.measured.numbers
    assert now.light.total.mean() < 0.8 * first.numbers.light.total.mean()
    assert np.array_equal(now.daylight_factor_percent, first.numbers.daylight_factor_percent)
    panel._session.send(LoadScene(path=str(box_file(tmp_path, "other.obj", boxes=((0.0, 3.0),)))))
    qtbot.waitUntil(lambda: panel.measured is None, timeout=PATIENCE_MS)
    assert panel.legend.values == []


def test_a_second_click_stops_the_measurement(panel, qtbot):
    """Nothing is shown of what was stopped, and another click begins anew; an hour that comes while
    the first measurement goes on is measured after it."""
    qtbot.mouseClick(panel.measure, Qt.MouseButton.LeftButton)
    assert panel.measure.text() == "Stop"
    assert panel.progress.isVisible()
    qtbot.mouseClick(panel.measure, Qt.MouseButton.LeftButton)
    assert panel.measure.text() == "Measure"
    assert "Stopped" in panel.facts.text()
    panel._thread.submit(lambda: None).result()
    QApplication.processEvents()
    assert panel.measured is None
    qtbot.mouseClick(panel.measure, Qt.MouseButton.LeftButton)
    later = NOON + timedelta(hours=3)
    panel._session.send(SetClock(instant=later))
    qtbot.waitUntil(
        lambda: panel.measured is not None and panel.measured.instant == later, timeout=PATIENCE_MS
    )

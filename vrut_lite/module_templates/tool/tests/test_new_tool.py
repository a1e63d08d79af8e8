from datetime import UTC, datetime

import numpy as np
import pytest
from session import JOURNAL, MODULES, at, open_kernel, play
from vrut_lite.kernel.messages import Fault, SetSetting

from new_tool.log import LuxLogged, as_csv


@pytest.fixture
def kernel():
    """The real kernel; every fault fails the test."""
    kernel, faults = open_kernel(), []
    kernel.tap(lambda message, _: faults.append(message) if isinstance(message, Fault) else None)
    yield kernel
    kernel.close()
    assert faults == []


def logged_by(kernel, *hours):
    """Values that are posted while hours pass."""
    values = []
    kernel.tap(lambda message, _: values.append(message) if type(message) is LuxLogged else None)
    for hour in hours:
        play(kernel, at(*hour))
    return values


def test_the_recorded_session_replays(replay_journal):
    """A difference is a changed tool: accept it with --update-journals."""
    assert replay_journal(JOURNAL, MODULES).messages > 10


def test_a_sky_of_known_radiance_has_its_illuminance(kernel):
    """Level ground gets pi times the radiance by the sky, and the sun by its height."""
    value = logged_by(kernel, (6, 0, 20.0), (7, 0, 30.0))[-1]
    assert value.instant == datetime(2026, 6, 21, 7, tzinfo=UTC)
    assert value.sky_lx == pytest.approx(683.0 * np.pi * 0.5, rel=1e-3)
    assert value.total_lx - value.sky_lx == pytest.approx(683.0 * 5.0 * 0.5, rel=1e-3)


def test_values_keep_their_distance_in_time(kernel):
    """Ten minutes by default, forwards and back; the setting changes it."""
    hours = (6, 0, 20.0), (6, 5, 21.0), (6, 20, 24.0), (6, 0, 20.0)
    assert [value.instant.minute for value in logged_by(kernel, *hours)] == [0, 20, 0]
    closer = SetSetting(module="new_tool", name="log_minutes", value=1.0)
    play(kernel, [closer])
    assert len(logged_by(kernel, (6, 2, 20.5), (6, 4, 21.0))) == 2


def test_the_log_is_a_table(kernel):
    values = logged_by(kernel, (6, 0, 20.0), (7, 0, 30.0))
    lines = as_csv(values).splitlines()
    assert lines[0] == "time_utc,total_lx,sky_lx"
    assert len(lines) == len(values) + 1
    assert lines[-1].startswith("2026-06-21T07:00:00+00:00,")


def test_the_panel_lists_and_saves_what_is_posted(tmp_path, monkeypatch):
    """In a window without a screen; skipped where the extra `app` is missing."""
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    widgets = pytest.importorskip("PySide6.QtWidgets", exc_type=ImportError)
    from new_tool.panel import NewToolPanel

    class Listening:
        """The one method of the window's session that the panel uses."""

        def listen(self, kind, listener):
            self.post = listener

    application = widgets.QApplication.instance() or widgets.QApplication([])
    session = Listening()
    panel = NewToolPanel(session)
    for hour in (6, 7):
        instant = datetime(2026, 6, 21, hour, tzinfo=UTC)
        session.post(LuxLogged(instant=instant, total_lx=106_473.2, sky_lx=0.25))
    assert panel.list.topLevelItemCount() == 2
    row = panel.list.topLevelItem(0)
    assert [row.text(column) for column in range(3)] == ["2026-06-21 07:00", "106,473", "0.25"]
    panel.write(tmp_path / "lux.csv")
    assert (tmp_path / "lux.csv").read_text(encoding="utf-8") == as_csv(panel.values)
    panel.forget()
    assert panel.list.topLevelItemCount() == 0
    application.processEvents()

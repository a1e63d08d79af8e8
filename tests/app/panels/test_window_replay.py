"""What is done in the window is in its journal, and a replay without a window does it again."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QFileDialog
from window_driver import NOON, SCENES, choose

from vrut_lite.app.engine.flight_recorder import FlightRecorder
from vrut_lite.commands.headless_scene import modules_for
from vrut_lite.daylight_kernel import daylight_kernel, demand_light
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import ClockMoved, SetClock, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import Replay


def replayed(path):
    journal = Journal(path)
    return Replay(journal, modules_for(journal.setup)).run(to_the_end=True)


def saved_journal(driver, monkeypatch, path):
    """The journal that the inspector's button writes."""
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    driver.window.docks["messages"].show()
    bar = driver.panel("messages").journal
    driver.click(bar.save)
    driver.until(lambda: path.name in bar.recorded.text())
    return path


def drag_time_bar(driver):
    bar = driver.window.time.bar
    left, middle = Qt.MouseButton.LeftButton, bar.height() // 2
    driver.qtbot.mousePress(bar, left, pos=QPoint(bar.width() // 2, middle))
    for share in (0.55, 0.6, 0.7, 0.8):
        driver.qtbot.mouseMove(bar, QPoint(round(share * bar.width()), middle))
        driver.settled()
    driver.qtbot.mouseRelease(bar, left, pos=QPoint(round(0.8 * bar.width()), middle))


def play_a_while(driver):
    button, before = driver.window.time.play, driver.session.last(ClockMoved)
    driver.click(button)
    driver.until(lambda: driver.session.last(ClockMoved) is not before)
    driver.click(button)


def session_by_hand(driver):
    """Something of every panel, by its own widgets, and a mishap."""
    sky = driver.panel("sky")
    yield lambda: driver.type_in(sky.panels["dynamic_skylight"].rows["albedo"].editor.spin, "0.4")
    yield lambda: drag_time_bar(driver)
    yield lambda: driver.type_in(driver.panel("place").search, "Reykjavik")
    yield lambda: driver.panel("module scene").rows["light_shafts"].editor.click()
    yield lambda: driver.type_in(driver.panel("module clouds").rows["coverage"].editor.spin, "0.5")
    yield lambda: driver.panel("picture").lock.click()
    yield lambda: choose(sky.choosers["sky"], "bruneton_sky")
    yield lambda: driver.window.files.open_path(str(SCENES / "nothing.glb"))
    yield lambda: driver.window.files.open_path(str(SCENES / "spheres.glb"))
    yield driver.window.desk.viewport.frame_scene
    yield lambda: driver.panel("modules").set_safe_mode(True)
    yield driver.window.undo
    yield driver.window.undo
    yield driver.window.redo
    yield lambda: play_a_while(driver)


@pytest.mark.long
def test_a_session_by_hand_is_replayed_headless_digest_by_digest(
    headless_window, monkeypatch, tmp_path
):
    """Every panel, play, undo, a broken file, jobs that end when they end: all is said again."""
    for act in session_by_hand(headless_window):
        act()
        headless_window.settled()
    path = saved_journal(headless_window, monkeypatch, tmp_path / "session.mcap")
    outcome = replayed(path)
    assert outcome.difference is None
    assert not outcome.by_value
    assert outcome.inputs > 30
    told = {(entry.type_name, entry.sender) for entry in Journal(path).entries()}
    assert {
        ("BackgroundChanged", "bruneton_sky"), ("BackgroundChanged", "dynamic_skylight"),
        ("SlotChanged", "host"), ("SceneOpened", "scene"), ("Fault", "host"),
        ("CloudsChanged", "clouds"), ("Tick", "host"),
    } <= told  # fmt: skip


@pytest.mark.long
@pytest.mark.gl
def test_a_drawn_session_is_replayed_without_a_gpu(drawn_window, monkeypatch, tmp_path):
    """The sky's cube is made by the GPU: the journal holds its recipe, which is the same."""
    row = drawn_window.panel("sky").panels["dynamic_skylight"].rows["cube_device"]
    choose(row.editor, "gpu")
    drawn_window.settled()
    drag_time_bar(drawn_window)
    drawn_window.settled()
    path = saved_journal(drawn_window, monkeypatch, tmp_path / "drawn.mcap")
    assert any(
        entry.type_name == "BackgroundChanged" and "recipe" in entry.message["cube"]
        for entry in Journal(path).entries()
    )
    outcome = replayed(path)
    assert outcome.difference is None
    assert not outcome.by_value


# --- the recorder, without a window --------------------------------------------------------


@pytest.fixture
def kernel():
    kernel, _ = daylight_kernel()
    demand_light(kernel, "test", 8)
    kernel.pump_until_idle()
    yield kernel
    kernel.close()


def play(kernel, minutes):
    kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.0))
    for minute in minutes:
        kernel.inject(SetClock(instant=NOON.replace(minute=minute)))
        kernel.pump_until_idle()


def test_a_flight_recorder_writes_what_a_recorder_writes(kernel, tmp_path):
    """Both write the same bytes: digests made on another thread are written in the same order."""
    recorder = FlightRecorder(kernel)
    with (tmp_path / "direct.mcap").open("wb") as stream:
        direct = Recorder(kernel, stream)
        play(kernel, range(0, 50, 10))
        direct.close()
    recorder.save(tmp_path / "flight.mcap").result()
    assert (tmp_path / "flight.mcap").read_bytes() == (tmp_path / "direct.mcap").read_bytes()
    play(kernel, [55])
    recorded = recorder.save(tmp_path / "later.mcap").result()
    recorder.close()
    assert recorded.inputs == direct.inputs + 2
    assert len(list(Journal(tmp_path / "later.mcap").entries())) == sum(recorded[:2])


def test_a_journal_remembers_who_wanted_what_before_it_began(kernel, tmp_path):
    """Without the demand for light a replay's modules would say nothing."""
    recorder = FlightRecorder(kernel)
    play(kernel, [0, 20])
    recorder.save(tmp_path / "j.mcap").result()
    recorder.close()
    journal = Journal(tmp_path / "j.mcap")
    assert {demand["message"] for demand in journal.setup.demands} >= {"BackgroundChanged"}
    assert any(entry.type_name == "BackgroundChanged" for entry in journal.entries())
    assert replayed(tmp_path / "j.mcap").difference is None


def test_a_full_recording_ends_with_a_line_and_can_still_be_saved(kernel, tmp_path):
    """The disk is not filled by a window that is left alone for weeks."""
    recorder = FlightRecorder(kernel, most_bytes=1)
    play(kernel, range(60))
    recorder.save(tmp_path / "j.mcap").result()
    for seed in range(2000):
        kernel.inject(SetSetting(module="clouds", name="seed", value=seed))
        kernel.pump()
    recorded = recorder.save(tmp_path / "j.mcap").result()
    recorder.close()
    assert recorded.ended == "recording ended: the journal has 0 MiB"
    assert replayed(tmp_path / "j.mcap").inputs == recorded.inputs


def test_a_journal_that_cannot_be_written_is_told(kernel, tmp_path):
    """A folder that is not there, say."""
    recorder = FlightRecorder(kernel)
    with pytest.raises(UserError, match="nowhere"):
        recorder.save(tmp_path / "nowhere" / "j.mcap").result()
    recorder.close()


def test_what_came_before_the_recording_refuses_it(kernel):
    """A scene that was opened lives on inside a module: no setup can tell it."""
    kernel.inject(LoadScene(path="a.glb"))
    kernel.pump()
    with pytest.raises(UserError, match="LoadScene"):
        FlightRecorder(kernel)

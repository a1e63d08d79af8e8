"""Pictures of a day: made elsewhere, counted, and stopped when asked."""

from concurrent.futures import Future, ThreadPoolExecutor
from datetime import timedelta

import pytest
from processes_here import processes_or_skip

from vrut_lite.app.panels.day_sequence import instants_of
from vrut_lite.commands.pictures import Made
from vrut_lite.daylight.scene import LoadScene
from vrut_lite.kernel.messages import SetSetting


class FakeWorkers(ThreadPoolExecutor):
    """Makes no picture but says so; `held` ones wait until they are let go."""

    def __init__(self, fails=False):
        super().__init__(1)
        self.asked = []
        self.fails = fails
        self.held = []

    def submit(self, work, plan, instant, suffix):
        self.asked.append(instant)
        promise = Future()
        if self.fails:
            promise.set_exception(RuntimeError("the disk is full"))
        else:
            promise.set_result(Made({suffix: b"picture"}, "caption"))
        return promise


@pytest.fixture
def panel(shared_headless_window):
    shared_headless_window.workers = FakeWorkers()
    panel = shared_headless_window.panel("export")
    panel._open_workers = lambda: shared_headless_window.workers
    panel.driver = shared_headless_window
    panel.sequence = None
    panel.status.clear()
    return panel


def test_a_day_is_made_picture_by_picture(panel, tmp_path):
    """Each 2 hours from civil dawn to civil dusk: 9 files in Prague's June, numbered from 1."""
    panel.step_minutes.setValue(120)
    panel.start(str(tmp_path / "day.png"))
    panel.driver.until(lambda: "pictures" in panel.status.text())
    files = sorted(path.name for path in tmp_path.glob("day_*.png"))
    assert files == [f"day_{number:04d}.png" for number in range(1, 10)]
    assert panel.status.text().startswith("9 pictures")
    assert panel.progress.value() == 9
    assert not panel.sequence.running
    steps = {
        b - a
        for a, b in zip(panel.driver.workers.asked, panel.driver.workers.asked[1:], strict=False)
    }
    assert steps == {timedelta(hours=2)}


def test_cancel_stops_and_keeps_what_is_there(panel, tmp_path, qtbot):
    """After the third picture no further one is begun."""
    panel.step_minutes.setValue(30)
    panel.start(str(tmp_path / "day.png"))
    panel.sequence.progressed.connect(lambda done, of: panel.cancel.click() if done == 3 else None)
    panel.driver.until(lambda: "stopped" in panel.status.text())
    assert panel.status.text().startswith("stopped after 3 of")
    assert len(list(tmp_path.glob("day_*.png"))) == 3


def test_a_failure_is_told_and_ends_it(panel, tmp_path):
    """One line, and the button may be pressed again."""
    panel.driver.workers = FakeWorkers(fails=True)
    panel.start(str(tmp_path / "day.png"))
    panel.driver.until(lambda: "the disk is full" in panel.driver.window.news.text())
    assert panel.day.isEnabled()


def test_a_name_that_cannot_be_written_is_refused_first(panel, tmp_path):
    """Before a process is started."""
    for name in ("day.gif", "no/such/folder/day.png"):
        panel.driver.window.news.clear()
        panel.start(str(tmp_path / name))
        assert panel.driver.window.news.text()
        assert panel.sequence is None


def test_the_day_goes_from_first_to_last_light(shared_headless_window):
    """Civil dawn is the first picture, and no step leads beyond civil dusk."""
    day = shared_headless_window.window.desk.scout.day
    instants = instants_of(day, timedelta(minutes=20))
    assert instants[0] == day.marks["civil dawn"]
    assert timedelta(0) <= day.marks["civil dusk"] - instants[-1] < timedelta(minutes=20)


@pytest.mark.gl
def test_a_real_process_makes_real_pictures(headless_window, tmp_path):
    """One picture by a process of its own, of the window's size."""
    processes_or_skip()
    import trimesh
    from PIL import Image

    scene = tmp_path / "box.glb"
    trimesh.creation.box((1, 1, 1)).export(scene)
    # Light transport is on in that process: texels of a metre cost it little.
    headless_window.session.send(
        LoadScene(path=str(scene)),
        SetSetting(module="light_transport", name="texel_m", value=1.0),
    )
    view = headless_window.window.desk.viewport
    headless_window.until(lambda: headless_window.project.size == view.pixels)
    panel = headless_window.panel("export")
    panel.step_minutes.setValue(120)
    # Docks that come later may make the picture in the window smaller.
    size = headless_window.project.size
    panel.start(str(tmp_path / "day.png"))
    headless_window.until(lambda: panel.progress.value() >= 1)
    panel.cancel.click()
    with Image.open(tmp_path / "day_0001.png") as image:
        assert image.size == size

"""Pictures of a day: made elsewhere, counted, and stopped when asked."""

from concurrent.futures import Future, ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from io import BytesIO
from pathlib import Path
from zoneinfo import ZoneInfo

import numpy as np
import pytest
from PIL import Image
from processes_here import processes_or_skip
from PySide6.QtCore import Qt, QTime

from vrut_lite.app.panels.day_sequence import instants_of, timed_paths
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.messages.scene import LoadScene
from vrut_lite.pictures.film import film_of_files, write_film
from vrut_lite.studio.pictures import Made


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
    panel.chosen_size.usual.setCurrentIndex(0)
    panel.light.click()
    panel.status.clear()
    return panel


def test_a_day_is_made_picture_by_picture(panel, tmp_path):
    """Each 2 hours from civil dawn to civil dusk: 9 files in Prague's June, named by their hour."""
    panel.step_minutes.setValue(120)
    panel.start(str(tmp_path / "day.png"))
    panel.driver.until(lambda: "pictures" in panel.status.text())
    files = sorted(path.name for path in tmp_path.glob("day *.png"))
    assert files == [f"day {4 + 2 * number:02d}.07.png" for number in range(9)]
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
    assert len(list(tmp_path.glob("day *.png"))) == 3


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


def test_hours_and_steps_are_chosen(panel, tmp_path, qtbot):
    """Pictures from 8:00 to 9:30 every half hour are written as JPEG in the chosen size; what was
    typed holds for another day too."""
    for field, text in ((panel.first, "8"), (panel.last, "9:30")):
        field.selectAll()
        qtbot.keyClicks(field, text)
        qtbot.keyClick(field, Qt.Key.Key_Return)
    panel.step_minutes.setValue(30)
    scout = panel.driver.window.desk.scout
    scout.day_changed.emit(scout.day)
    assert panel.count.text() == "4 pictures"
    panel.chosen_size.choose(320, 200)
    panel.start(str(tmp_path / "day.jpg"))
    assert panel.sequence._plan.project.size == (320, 200)
    panel.driver.until(lambda: panel.status.text().startswith("4 pictures"))
    files = sorted(path.name for path in tmp_path.iterdir())
    assert files == [f"day {hour}.jpg" for hour in ("08.00", "08.30", "09.00", "09.30")]
    panel.light.click()
    assert panel.first.time == QTime(4, 7)


def test_an_hour_that_clocks_have_twice_gives_two_files():
    """25 October 2026 in Prague: 02:30 in summer time, and again."""
    zone = ZoneInfo("Europe/Prague")
    start = datetime(2026, 10, 25, 0, 30, tzinfo=UTC)
    paths = timed_paths(Path("day.png"), [start, start + timedelta(hours=1)], zone)
    assert [path.name for path in paths] == ["day 02.30.png", "day 02.30 CET.png"]


def test_a_film_is_made_of_a_days_pictures(panel, tmp_path):
    """Pictures that the worker made, in a film of as many; nothing else is left."""
    panel.driver.workers = FilmWorkers()
    panel.first.show_time(QTime(8, 0))
    panel.last.show_time(QTime(9, 0))
    panel.step_minutes.setValue(30)
    panel.start(str(tmp_path / "day.webp"))
    panel.driver.until(lambda: "day.webp: 3 pictures" in panel.status.text())
    assert [path.name for path in tmp_path.iterdir()] == ["day.webp"]
    with Image.open(tmp_path / "day.webp") as film:
        assert (film.size, film.n_frames) == ((32, 16), 3)
    assert not panel.sequence._frames.exists()


class FilmWorkers(ThreadPoolExecutor):
    """Pictures of one colour each, and the film as a process would make it."""

    def __init__(self):
        super().__init__(1)
        self._count = 0

    def submit(self, work, *arguments):
        if work is film_of_files:
            return super().submit(work, *arguments)
        self._count += 1
        stream = BytesIO()
        Image.new("RGB", (32, 16), (80 * self._count, 0, 0)).save(stream, format="PNG")
        promise = Future()
        promise.set_result(Made({arguments[2]: stream.getvalue()}, "caption"))
        return promise


def test_a_film_in_mp4_has_its_pictures_and_their_colours(tmp_path):
    """H.264 of an odd size, which loses a row; colours within what it compresses."""
    av = pytest.importorskip("av", reason="the package av is not installed")
    pictures = [np.full((33, 48, 3), level, np.uint8) for level in (40, 120, 200)]
    write_film(tmp_path / "day.mp4", pictures, 12)
    with av.open(str(tmp_path / "day.mp4")) as film:
        frames = [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]
    assert [frame.shape for frame in frames] == [(32, 48, 3)] * 3
    for frame, picture in zip(frames, pictures, strict=True):
        assert abs(float(frame.mean()) - float(picture.mean())) < 4.0


def test_a_film_that_cannot_be_written_leaves_no_file(tmp_path):
    """A film without pictures, or with another suffix, is refused in one sentence."""
    for name in ("day.webp", "day.gif"):
        with pytest.raises(UserError):
            write_film(tmp_path / name, [], 12)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.gl
@pytest.mark.long
def test_a_real_process_makes_real_pictures(headless_window, tmp_path):
    """One picture by a process of its own, of the window's size."""
    processes_or_skip()
    import trimesh

    scene = tmp_path / "box.glb"
    trimesh.creation.box((1, 1, 1)).export(scene)
    # It would be on in that process, whatever it is here.
    headless_window.session.send(
        LoadScene(path=str(scene)),
        SetSetting(module="light_transport", name="on", value=False),
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
    with Image.open(tmp_path / "day 04.07.png") as image:
        assert image.size == size

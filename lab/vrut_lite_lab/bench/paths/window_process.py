"""Measures the desktop application's window and prints seconds by path name as JSON.

    python -m vrut_lite_lab.bench.paths.window_process GROUP

Latency: medians of some moves of the turbidity's slider. Gaps: a timer of 0 ms beats in the event
loop, and the longest time between two beats is the gap; outside drawing is the part of it in which
the engine drew no frame on any thread; own work is the window's CPU time in it. Pace: six
seconds in which a hand turns the camera, or time plays ten minutes a second from 7 in the morning.
"""

import gc
import json
import sys
import time
from collections.abc import Callable
from datetime import UTC, datetime
from itertools import count
from typing import Any, NamedTuple

import numpy as np
from PySide6.QtCore import QEvent, QEventLoop, QObject, QTimer
from PySide6.QtWidgets import QApplication

from vrut_lite.app.engine.cpu_sky import CpuSkyStage
from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import GlStage, Stage
from vrut_lite.app.theme import apply_theme
from vrut_lite.app.window.main_window import MainWindow
from vrut_lite.kernel.messages import ChooseSlot, ClockMoved, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.kernel.trace import TraceEntry
from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.project import Project, load_project
from vrut_lite_lab.bench.paths.frame import SCENES
from vrut_lite_lab.bench.paths.window import (
    ACTS,
    GAPS,
    PACE_PARTS,
    PACE_SCENES,
    PACES,
    PARTS,
    SKIES,
)

SIZE = (1600, 1000)
PACE_SIZE, _PACE_S, _SETTLING = (1280, 800), 6.0, 12
# A hand's moves: how often, how far in shares of the picture's height, and how many to and fro:
# 2.4 degrees each way, as in a street the eye would meet a wall.
_HAND_MS, _TURN, _SWING = 16, 0.001, 13
_AT, _MORNING = "2026-06-21T11:00", datetime(2026, 6, 21, 7, tzinfo=UTC)
_LIMIT_S, _REST_S, _MOVES = 300.0, 10.0, 5
# Shorter gaps are not kept: to keep all of them would itself make longer ones.
_SHORT_S = 1e-3


class Sleeper(Module):
    """Holds the kernel up for 0.4 s at every move of the clock."""

    manifest = Manifest(name="sleeper", title="Sleeper", version="1")

    @handles(ClockMoved)
    def on_clock(self, message: ClockMoved) -> None:
        """Sleep."""
        time.sleep(0.4)


class Span(NamedTuple):
    """From when to when, on the clock."""

    start_s: float
    end_s: float

    def shared_s(self, other: "Span") -> float:
        """How long both were."""
        return max(0.0, min(self.end_s, other.end_s) - max(self.start_s, other.start_s))


class WatchedWindow:
    """The application's window with a scene open, its event loop watched."""

    def __init__(
        self,
        open_stage: Callable[[], Stage],
        scene: str = "street.toml",
        size: tuple[int, int] = SIZE,
    ) -> None:
        known = QApplication.instance()
        self.app = known if isinstance(known, QApplication) else QApplication([])
        apply_theme(self.app)
        self._draws: list[Span] = []
        self._gaps: list[tuple[Span, float]] = []
        self._last_s = (time.perf_counter(), time.thread_time())
        self.stills = self._stills_before = 0
        self._sky = ""
        self.flags = QEventLoop.ProcessEventsFlag.AllEvents
        self.session = Session(lambda: self._timed(open_stage()))
        self.window = MainWindow(self.session)
        self.window.resize(*size)
        self.window.show()
        self.session.start()
        is_project = scene.endswith(".toml")
        path = SCENES / scene
        project = load_project(path) if is_project else Project(scene=str(path), at=_AT)
        self.window.files.open_project(project)
        self.session.picture_shown.connect(self._count)
        self.session.listen(BackgroundChanged, self._sky_heard)
        self._beat = QTimer()
        self._beat.timeout.connect(self._note)
        self._beat.start(0)
        self.still()

    def _timed(self, stage: Stage) -> Stage:
        """Note when it draws."""
        draw = stage.draw

        def timed(*args: Any) -> Any:
            start_s = time.perf_counter()
            try:
                return draw(*args)
            finally:
                self._draws.append(Span(start_s, time.perf_counter()))

        stage.draw = timed  # type: ignore[assignment, method-assign]
        return stage

    def _count(self, shown: Shown) -> None:
        self.stills += shown.still

    def _sky_heard(self, background: BackgroundChanged) -> None:
        if background.source != self._sky:
            self._sky, self._stills_before = background.source, self.stills

    def _note(self) -> None:
        now_s = (time.perf_counter(), time.thread_time())
        if now_s[0] - self._last_s[0] > _SHORT_S:
            self._gaps.append((Span(self._last_s[0], now_s[0]), now_s[1] - self._last_s[1]))
        self._last_s = now_s

    def until(self, condition: Callable[[], bool]) -> None:
        """Run the event loop until something holds."""
        end_s = time.perf_counter() + _LIMIT_S
        while not condition():
            self.app.processEvents(self.flags)
            if time.perf_counter() > end_s:
                raise TimeoutError("the window did not come to it")

    def watch_no_gaps(self) -> None:
        """Wait for events from now on, and leave both cores to the pictures."""
        self._beat.stop()
        self.flags = QEventLoop.ProcessEventsFlag.WaitForMoreEvents

    def still(self) -> None:
        """Wait for the next finished picture."""
        before = self.stills
        self.until(lambda: self.stills > before)

    def choose(self, sky: str) -> None:
        """Wait for a finished picture of another sky."""
        if self._sky != sky:
            self.session.send(ChooseSlot(slot="sky", module=sky))
            self.until(lambda: self._sky == sky and self.stills > self._stills_before)

    def gaps_s(self, act: Callable[[], None]) -> tuple[float, float, float]:
        """The longest gap while an act happens, outside drawing, and the most own CPU time."""
        self._gaps.clear()
        self._draws.clear()
        self._last_s = (time.perf_counter(), time.thread_time())
        act()
        gaps = [(span.end_s - span.start_s, span, own) for span, own in self._gaps]
        return (
            max((gap for gap, _, _ in gaps), default=_SHORT_S),
            max((gap - self._drawing_s(span) for gap, span, _ in gaps), default=_SHORT_S),
            max((own for _, _, own in gaps), default=_SHORT_S),
        )

    def _drawing_s(self, span: Span) -> float:
        return sum(span.shared_s(draw) for draw in self._draws)

    def close(self) -> None:
        """End it all."""
        self.window.close()
        self.session.join()


class Stopwatch(QObject):
    """Times the parts of the way from a slider to the paint event that shows its picture."""

    def __init__(self, bench: WatchedWindow):
        super().__init__()
        self._bench = bench
        self._shown: Shown | None = None
        self._painted_s = self._paint_s = 0.0
        self._has_sky = self._is_finished = False
        self._view = bench.window.desk.viewport
        self._view.installEventFilter(self)
        bench.session.picture_shown.connect(self._picture_shown)
        bench.session.listen(BackgroundChanged, self._sky_heard)

    def parts_s(self, slider: Any, notch: int) -> tuple[float, ...]:
        """Seconds of `PARTS`, of one move of the slider; ends with its finished picture."""
        self._shown, self._painted_s, self._has_sky, self._is_finished = None, 0.0, False, False
        start_ns = time.perf_counter_ns()
        slider.setValue(notch)
        self._bench.until(lambda: self._painted_s > 0.0)
        assert self._shown is not None
        whole_s = self._painted_s - 1e-9 * start_ns
        parts_s = self._handler_s(start_ns), self._shown.seconds, self._paint_s, whole_s
        # It may have come before the handlers' answer, and would not come again.
        self._bench.until(lambda: self._is_finished)
        return parts_s

    def _handler_s(self, since_ns: int) -> float:
        """Time of all handlers since then, from the kernel's trace."""
        answers: list[list[TraceEntry]] = []
        self._bench.session.ask(lambda stage: stage.kernel.trace.entries(), answers.append)
        self._bench.until(lambda: bool(answers))
        late = (entry for entry in answers[0] if entry.start_ns >= since_ns and entry.receiver)
        return sum(1e-9 * (entry.end_ns - entry.start_ns) for entry in late)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """The first paint event after the new picture was shown ends the way."""
        if event.type() != QEvent.Type.Paint or self._shown is None or self._painted_s:
            return False
        # The filter is called before the event is handled: painted here, it is handled.
        start_s = time.perf_counter()
        self._view.paintEvent(event)  # type: ignore[arg-type]
        self._painted_s = time.perf_counter()
        self._paint_s = self._painted_s - start_s
        return True

    def _sky_heard(self, background: BackgroundChanged) -> None:
        self._has_sky = True

    def _picture_shown(self, shown: Shown) -> None:
        if self._has_sky:
            self._shown = self._shown or shown
            self._is_finished |= shown.still


def latency(bench: WatchedWindow, sky: str) -> list[float]:
    """Seconds of `PARTS`: medians of some moves of a sky's turbidity."""
    bench.choose(sky)
    row = bench.window.panels["sky"].panels[sky].rows["turbidity"]  # type: ignore[attr-defined]
    row.name.setChecked(True)
    watch, slider = Stopwatch(bench), row.editor.slider
    # The first move is from the sky's own turbidity, and to it: not counted.
    moves = [watch.parts_s(slider, 200 + 40 * number) for number in range(-1, _MOVES)][1:]
    return [float(seconds) for seconds in np.median(np.array(moves), axis=0)]


def acts(bench: WatchedWindow) -> dict[str, Callable[[], None]]:
    """Acts during which the event loop is watched."""
    send = bench.session.send

    def rest() -> None:
        end_s = time.perf_counter() + _REST_S
        bench.until(lambda: time.perf_counter() > end_s)

    def solve() -> None:
        send(SetSetting(module="bruneton_sky", name="turbidity", value=4.0))
        bench.still()

    def load() -> None:
        def loaded() -> bool:
            scene = bench.session.last(SceneOpened)
            return scene is not None and scene.path.endswith("pavilion.gltf")

        send(LoadScene(path=str(SCENES / "pavilion.gltf")))
        bench.until(loaded)
        bench.still()

    def clouds() -> None:
        send(SetSetting(module="clouds", name="coverage", value=0.4))
        bench.until(lambda: bench.session.last(CloudsChanged) is not None)

    def sleep() -> None:
        bench.session.ask(lambda stage: stage.kernel.add_module(Sleeper))
        day = bench.window.desk.scout.day
        assert day is not None
        for share in (0.5, 0.6, 0.7):
            bench.window.time.go_to(day.instant_at(share))
        bench.still()

    return dict(zip(ACTS, (rest, solve, load, clouds, sleep), strict=True))


def pace(bench: WatchedWindow, playing: bool) -> tuple[float, float, float, float]:
    """Seconds of `PACE_PARTS` and the share of the width, while time plays or the camera turns."""
    # Width in pixels and seconds: pictures that were kept would take fresh memory, and time.
    drawn: list[tuple[int, float]] = []
    bench.session.picture_shown.connect(
        lambda shown: drawn.append((shown.picture.display.shape[1], shown.seconds))
    )
    player, view = bench.window.time.player, bench.window.desk.viewport
    turning, moves = QTimer(), count()

    def turn() -> None:
        back = (next(moves) + _SWING) // (2 * _SWING) % 2
        view.rig.orbit(-_TURN if back else _TURN, 0.0)
        view.send_camera()

    turning.timeout.connect(turn)
    if playing:
        bench.window.time.go_to(_MORNING)
        bench.still()
        player.play()
    else:
        turning.start(_HAND_MS)
    # The first ones compile shaders, and find their size.
    bench.until(lambda: len(drawn) >= _SETTLING)
    drawn.clear()
    start_s, before = time.perf_counter(), time.process_time()
    bench.until(lambda: time.perf_counter() > start_s + _PACE_S)
    spent_s, cpu_s = time.perf_counter() - start_s, time.process_time() - before
    player.pause()
    turning.stop()
    shown, pictures = list(drawn), max(len(drawn), 1)
    bench.still()
    widths_px, seconds = np.mean(shown, axis=0).tolist()
    return spent_s / pictures, cpu_s / pictures, seconds, widths_px / view.pixels[0]


def latencies() -> dict[str, float]:
    """Of `window-latency`."""
    found: dict[str, float] = {}
    stages: dict[str, Callable[[], Stage]] = {
        "OpenGL": GlStage,
        "CPU": lambda: CpuSkyStage("measured"),
    }
    for renderer, stage in stages.items():
        bench = WatchedWindow(stage)
        bench.watch_no_gaps()
        for sky in SKIES:
            for part, seconds in zip(PARTS, latency(bench, sky), strict=True):
                found[f"{renderer}, {sky}: {part}"] = seconds
        bench.close()
    return found


def gaps() -> dict[str, float]:
    """Of `window-gaps`."""
    found: dict[str, float] = {}
    bench = WatchedWindow(GlStage)
    # As the application does.
    gc.freeze()
    bench.choose("bruneton_sky")
    for name, act in acts(bench).items():
        for gap, seconds in zip(GAPS, bench.gaps_s(act), strict=True):
            found[f"{name}: {gap}"] = seconds
    bench.close()
    return found


def paces() -> dict[str, float]:
    """Of `window-pace`, and the share of the width."""
    found: dict[str, float] = {}
    for scene in PACE_SCENES:
        bench = WatchedWindow(GlStage, scene, PACE_SIZE)
        gc.freeze()
        bench.watch_no_gaps()
        for name in PACES:
            figures = pace(bench, playing=name == PACES[1])
            for part, figure in zip((*PACE_PARTS, "width"), figures, strict=True):
                found[f"{scene.partition('.')[0]}, {name}: {part}"] = figure
        bench.close()
    return found


_GROUPS = {"window-latency": latencies, "window-gaps": gaps, "window-pace": paces}

if __name__ == "__main__":
    print(json.dumps(_GROUPS[sys.argv[1]]()))

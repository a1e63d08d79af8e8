"""How long the desktop application's event loop is held up by what else goes on.

    QT_QPA_PLATFORM=offscreen python -m vrut_lite_bench.window

A timer of 0 ms beats in the event loop; the longest time between two beats is the gap. What it is
while nothing happens says how busy the machine is with other things. Outside drawing: of the time
between two beats that counts in which the engine drew no frame, on whichever thread.
"""

import gc
import os
import time
from collections.abc import Callable
from typing import Any, NamedTuple

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
# As the command line has it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication

from vrut_lite.app.cpu_sky import best_stage
from vrut_lite.app.engine import Shown
from vrut_lite.app.main_window import MainWindow
from vrut_lite.app.session import Session
from vrut_lite.app.stage import Stage
from vrut_lite.app.theme import apply_theme
from vrut_lite.daylight.clouds import CloudsChanged
from vrut_lite.daylight.scene import LoadScene, SceneOpened
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.kernel.messages import ChooseSlot, ClockMoved, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.project import load_project

SIZE = (1600, 1000)
_LIMIT_S, _REST_S = 300.0, 10.0
# Nobody asks what shorter gaps were; to note all of them would itself make longer ones.
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


class Gaps(NamedTuple):
    """Milliseconds: the longest between two beats, the longest outside drawing, and the most of
    the window's own CPU time in one."""

    longest: float
    outside_drawing: float
    own: float


def _now_s() -> tuple[float, float]:
    """On the clock, and of this thread's CPU time: other programs lengthen gaps by the first."""
    return time.perf_counter(), time.thread_time()


class Bench:
    """A window, and the gaps of its event loop."""

    def __init__(self, open_stage: Callable[[], Stage] = best_stage) -> None:
        # One process may open several, one after another; there is one application.
        known = QApplication.instance()
        self.app = known if isinstance(known, QApplication) else QApplication([])
        apply_theme(self.app)
        self._draws: list[Span] = []
        self.session = Session(lambda: self._timed(open_stage()))
        self.window = MainWindow(self.session)
        self.window.resize(*SIZE)
        self.window.show()
        self.session.start()
        self.window.open_project(load_project("scenes/street.toml"))
        self.stills = 0
        self.session.picture_shown.connect(self._count)
        self._gaps: list[tuple[Span, float]] = []
        self._last_s = _now_s()
        self._beat = QTimer()
        self._beat.timeout.connect(self._note)
        self._beat.start(0)

    @property
    def source(self) -> str:
        """Whose background is shown."""
        background = self.session.last(BackgroundChanged)
        return "" if background is None else background.source

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

    def _note(self) -> None:
        now_s = _now_s()
        if now_s[0] - self._last_s[0] > _SHORT_S:
            self._gaps.append((Span(self._last_s[0], now_s[0]), now_s[1] - self._last_s[1]))
        self._last_s = now_s

    def until(self, condition: Callable[[], bool]) -> None:
        """Run the event loop until something holds."""
        end_s = time.perf_counter() + _LIMIT_S
        while not condition():
            self.app.processEvents()
            if time.perf_counter() > end_s:
                raise TimeoutError("the window did not come to it")

    def still(self) -> None:
        """Wait for the next finished picture."""
        before = self.stills
        self.until(lambda: self.stills > before)

    def gaps_ms(self, act: Callable[[], None]) -> Gaps:
        """The longest while an act and what follows it happen."""
        self._gaps.clear()
        self._draws.clear()
        self._last_s = _now_s()
        act()
        longest = max((span.end_s - span.start_s for span, _ in self._gaps), default=_SHORT_S)
        outside = max((self._outside_s(span) for span, _ in self._gaps), default=_SHORT_S)
        own = max((own for _, own in self._gaps), default=_SHORT_S)
        return Gaps(1e3 * longest, 1e3 * outside, 1e3 * own)

    def _outside_s(self, span: Span) -> float:
        """How long no frame was drawn."""
        drawing_s = sum(span.shared_s(draw) for draw in self._draws)
        return span.end_s - span.start_s - drawing_s

    def close(self) -> None:
        """End it all."""
        self.window.close()
        self.session.join()


def main() -> None:
    """Print the table."""
    bench = Bench()
    send = bench.session.send
    bench.still()
    # As the application does.
    gc.freeze()
    send(ChooseSlot(slot="sky", module="bruneton_sky"))
    bench.until(lambda: bench.source == "bruneton_sky")
    bench.still()

    def rest() -> None:
        end_s = time.perf_counter() + _REST_S
        bench.until(lambda: time.perf_counter() > end_s)

    def solve() -> None:
        send(SetSetting(module="bruneton_sky", name="turbidity", value=4.0))
        bench.still()

    def load() -> None:
        send(LoadScene(path="scenes/pavilion.gltf"))
        bench.until(lambda: loaded(bench).endswith("pavilion.gltf"))
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

    acts = {
        "nothing": rest,
        "atmosphere solved anew": solve,
        "scene loaded": load,
        "clouds made": clouds,
        "module that sleeps 0.4 s": sleep,
    }
    for name, act in acts.items():
        gaps = bench.gaps_ms(act)
        print(
            f"{name:28s} longest gap {gaps.longest:6.1f} ms, outside drawing "
            f"{gaps.outside_drawing:6.1f} ms, of its own work {gaps.own:5.1f} ms",
            flush=True,
        )
    bench.close()


def loaded(bench: Bench) -> str:
    """Which scene is open."""
    scene = bench.session.last(SceneOpened)
    return "" if scene is None else scene.path


if __name__ == "__main__":
    main()

"""How long the desktop application's event loop is held up, and how soon a picture follows a hand.

    QT_QPA_PLATFORM=offscreen python -m vrut_lite_bench.window

A timer of 0 ms beats in the event loop; the longest time between two beats is the gap. Latency is
from sending a setting to the first picture that has it, by its parts.
"""

import os
import time
from collections.abc import Callable

import numpy as np

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication

from vrut_lite.app.engine import Shown
from vrut_lite.app.main_window import MainWindow
from vrut_lite.app.session import Session
from vrut_lite.app.theme import apply_theme
from vrut_lite.kernel.messages import (
    BackgroundChanged,
    ChooseSlot,
    ClockMoved,
    LoadScene,
    SceneLoaded,
    SetSetting,
)
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.project import load_project

SIZE = (1600, 1000)
_LIMIT_S = 120.0


class Sleeper(Module):
    """Holds the kernel up for 0.4 s at every move of the clock."""

    manifest = Manifest(name="sleeper", title="Sleeper", version="1")

    @handles(ClockMoved)
    def on_clock(self, message: ClockMoved) -> None:
        """Sleep."""
        time.sleep(0.4)


class Bench:
    """A window, and the gaps of its event loop."""

    def __init__(self) -> None:
        self.app = QApplication([])
        apply_theme(self.app)
        self.session = Session()
        self.window = MainWindow(self.session)
        self.window.resize(*SIZE)
        self.window.show()
        self.session.start()
        self.window.open_project(load_project("scenes/street.toml"))
        self.stills = 0
        self.session.picture_shown.connect(self._count)
        self._gaps: list[float] = []
        self._last_s = time.perf_counter()
        self._beat = QTimer()
        self._beat.timeout.connect(self._note)
        self._beat.start(0)

    def _count(self, shown: Shown) -> None:
        self.stills += shown.still

    def _note(self) -> None:
        now_s = time.perf_counter()
        self._gaps.append(now_s - self._last_s)
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

    def gap_ms(self, act: Callable[[], None]) -> tuple[float, float]:
        """The longest gap and the 99th percentile while an act and what follows it happen."""
        self._gaps.clear()
        self._last_s = time.perf_counter()
        act()
        self.still()
        return 1e3 * max(self._gaps), 1e3 * float(np.percentile(self._gaps, 99))

    def close(self) -> None:
        """End it all."""
        self.window.close()
        self.session.join()


def main() -> None:
    """Print the table."""
    bench = Bench()
    send = bench.session.send
    bench.still()
    send(ChooseSlot(slot="sky", module="bruneton_sky"))
    bench.until(lambda: source(bench) == "bruneton_sky")
    bench.still()

    def solve() -> None:
        send(SetSetting(module="bruneton_sky", name="turbidity", value=4.0))

    def load() -> None:
        send(LoadScene(path="scenes/pavilion.gltf"))
        bench.until(lambda: loaded(bench).endswith("pavilion.gltf"))

    def sleep() -> None:
        bench.session.ask(lambda stage: stage.kernel.add_module(Sleeper))
        day = bench.window.desk.scout.day
        assert day is not None
        for share in (0.5, 0.6, 0.7):
            bench.window.time.go_to(day.instant_at(share))

    for name, act in (("atmosphere solved anew", solve), ("scene loaded", load),
                      ("module that sleeps 0.4 s", sleep)):  # fmt: skip
        longest_ms, usual_ms = bench.gap_ms(act)
        print(f"{name:28s} longest gap {longest_ms:6.1f} ms, 99 % below {usual_ms:5.1f} ms")
    bench.close()


def source(bench: Bench) -> str:
    """Whose background is shown."""
    background = bench.session.last(BackgroundChanged)
    return "" if background is None else background.source


def loaded(bench: Bench) -> str:
    """Which scene is open."""
    scene = bench.session.last(SceneLoaded)
    return "" if scene is None else scene.path


if __name__ == "__main__":
    main()

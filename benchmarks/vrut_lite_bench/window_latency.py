"""How soon a picture follows a hand on a slider, by parts, with the sky computed on the CPU.

    QT_QPA_PLATFORM=offscreen python -m vrut_lite_bench.window_latency

From the signal of the turbidity's slider to the end of the paint event that shows the new sky.
"""

import time
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QEvent, QObject

from vrut_lite.app.engine.cpu_sky import CpuSkyStage
from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.stage import GlStage
from vrut_lite.app.panels.number_field import NumberField
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.kernel.messages import ChooseSlot
from vrut_lite.kernel.trace import Entry
from vrut_lite_bench.window import Bench

_MOVES = 8


class Parts(NamedTuple):
    """Milliseconds of the parts of one way, and of all of it; what is left is waiting.

    `kernel`: all handlers, in which the sky, its light and its air are made. `draw`: the frame.
    `paint`: the viewport's paint event.
    """

    kernel: float
    draw: float
    paint: float
    whole: float


class Stopwatch(QObject):
    """Notes when each part of the way is done."""

    def __init__(self, bench: Bench):
        super().__init__()
        self._bench = bench
        self._told: Shown | None = None
        self._painted_s = 0.0
        self._paint_s = 0.0
        self._awaited = False
        self._view = bench.window.desk.viewport
        self._view.installEventFilter(self)
        bench.session.picture_shown.connect(self._picture_told)
        bench.session.listen(BackgroundChanged, self._sky_heard)

    def measure(self, field: NumberField, notch: int) -> Parts:
        """Move a slider, and wait for the paint event that shows it."""
        self._told, self._painted_s, self._awaited = None, 0.0, False
        start_ns = time.perf_counter_ns()
        field.slider.setValue(notch)
        self._bench.until(lambda: self._painted_s > 0.0)
        assert self._told is not None
        whole_s = self._painted_s - 1e-9 * start_ns
        seconds = (self._handler_s(start_ns), self._told.seconds, self._paint_s, whole_s)
        return Parts(*(1e3 * part for part in seconds))

    def _handler_s(self, since_ns: int) -> float:
        """Time of all handlers since then, from the kernel's trace."""
        answers: list[list[Entry]] = []
        self._bench.session.ask(lambda stage: stage.kernel.trace.entries(), answers.append)
        self._bench.until(lambda: bool(answers))
        late = (entry for entry in answers[0] if entry.start_ns >= since_ns and entry.receiver)
        return sum(1e-9 * (entry.end_ns - entry.start_ns) for entry in late)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """The first paint event after the new picture was told ends the way."""
        if event.type() != QEvent.Type.Paint or self._told is None or self._painted_s:
            return False
        # The filter is asked before the event is handled: painted here, it is handled.
        start_s = time.perf_counter()
        self._view.paintEvent(event)  # type: ignore[arg-type]
        self._painted_s = time.perf_counter()
        self._paint_s = self._painted_s - start_s
        return True

    def _sky_heard(self, background: BackgroundChanged) -> None:
        self._awaited = True

    def _picture_told(self, shown: Shown) -> None:
        if self._awaited and self._told is None:
            self._told = shown


def main() -> None:
    """Print the table, in milliseconds: medians of some moves."""
    print(f"{'picture by':10} {'sky':18} " + " ".join(f"{name:>7}" for name in Parts._fields))
    for renderer, stage in (("OpenGL", GlStage), ("CPU", lambda: CpuSkyStage("measured"))):
        bench = Bench(stage)
        bench.still()
        for module in ("dynamic_skylight", "bruneton_sky"):
            print(f"{renderer:10} {module:18} " + row(bench, module))
        bench.close()


def row(bench: Bench, module: str) -> str:
    """One sky's parts."""
    if bench.source != module:
        bench.session.send(ChooseSlot(slot="sky", module=module))
        bench.until(lambda: bench.source == module)
        bench.still()
    row = bench.window.panels["sky"].panels[module].rows["turbidity"]  # type: ignore[attr-defined]
    if module == "bruneton_sky":
        row.name.setChecked(True)
        bench.still()
    watch = Stopwatch(bench)
    parts = []
    for i in range(_MOVES):
        parts.append(watch.measure(row.editor, 200 + 40 * i))
        bench.still()
    return " ".join(f"{ms:7.1f}" for ms in np.median(np.array(parts), axis=0))


if __name__ == "__main__":
    main()

"""The profiler, drawn over the picture."""

from collections.abc import Iterable
from time import perf_counter
from typing import NamedTuple

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QHideEvent, QPainter, QPaintEvent, QShowEvent
from PySide6.QtWidgets import QWidget

from vrut_lite.app import theme
from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.profile import Profile, Profiler
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.widgets import make_timer
from vrut_lite.quantities import with_unit

_LOOK_MS, _BEAT_MS = 500, 10
_WIDTH_PX, _LINE_PX, _EDGE_PX = 330, 16, 10
_MOST_LINES = 9
# The time of a bar of full length.
_FULL_MS = 100.0


class Line(NamedTuple):
    """A heading, or a name with its value; a bar is drawn if `ms` is known."""

    name: str
    value: str = ""
    ms: float | None = None
    heading: bool = False


class ProfilerOverlay(QWidget):
    """Lies in a corner of the viewport; while it is hidden nothing is measured."""

    def __init__(self, session: Session, viewport: QWidget):
        super().__init__(viewport)
        self._session = session
        self._profiler: Profiler | None = None
        self._latest: Profile | None = None
        self._asking = False
        self._last_beat_s = self._gap_s = 0.0
        self._last_picture_s = self._frame_gap_s = 0.0
        self.lines: list[Line] = []
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAccessibleName("profiler")
        self.move(_EDGE_PX, _EDGE_PX)
        self._looking = make_timer(self, _LOOK_MS, self._look)
        self._beating = make_timer(self, _BEAT_MS, self._beat)
        session.picture_shown.connect(self._note_picture)
        session.ended.connect(self._looking.stop)
        self.hide()

    def showEvent(self, event: QShowEvent) -> None:
        """Measure."""
        self._profiler = self._latest = None
        self._last_beat_s = perf_counter()
        self._gap_s = 0.0
        self._looking.start()
        self._beating.start()
        self._show_lines([Line("Profiler", "\N{HORIZONTAL ELLIPSIS}", heading=True)])

    def hideEvent(self, event: QHideEvent) -> None:
        """Measure no more."""
        self._looking.stop()
        self._beating.stop()

    # --- measuring ---------------------------------------------------------------------------

    def _beat(self) -> None:
        """Measure the longest gap between beats of the event loop."""
        now_s = perf_counter()
        self._gap_s = max(self._gap_s, now_s - self._last_beat_s)
        self._last_beat_s = now_s

    def _note_picture(self, shown: Shown) -> None:
        now_s = perf_counter()
        self._frame_gap_s, self._last_picture_s = now_s - self._last_picture_s, now_s

    def _look(self) -> None:
        if not self._asking:
            self._asking = True
            self._session.ask(self._profile, self._take)

    def _profile(self, stage: Stage) -> Profile:
        """On the engine's thread."""
        if self._profiler is None:
            self._profiler = Profiler(stage)
        return self._profiler.take()

    def _take(self, profile: Profile) -> None:
        self._asking = False
        # Without work the last profile with work stays.
        if profile.modules or self._latest is None:
            self._latest = profile
        shown = self._session.shown
        frame_ms = 0.0 if shown is None else 1e3 * shown.seconds
        gaps = (1e3 * self._gap_s, 1e3 * self._frame_gap_s)
        self._gap_s = 0.0
        latest = self._latest._replace(passes=profile.passes)
        whole_in_s = (0.0, 0.0) if shown is None else shown.whole_in_s
        self._show_lines(lines_of(latest, frame_ms, *gaps, whole_in_s))

    # --- painting ----------------------------------------------------------------------------

    def _show_lines(self, lines: list[Line]) -> None:
        self.lines = lines
        self.resize(_WIDTH_PX, len(lines) * _LINE_PX + 2 * _EDGE_PX)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Names to the left, bars in the middle, numbers to the right."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(16, 16, 18, 205))
        painter.drawRoundedRect(self.rect(), 5, 5)
        for place, line in enumerate(self.lines):
            top = _EDGE_PX + place * _LINE_PX
            self._paint_line(
                painter, QRectF(_EDGE_PX, top, _WIDTH_PX - 2 * _EDGE_PX, _LINE_PX), line
            )

    def _paint_line(self, painter: QPainter, place: QRectF, line: Line) -> None:
        if line.ms is not None:
            share = min(line.ms / _FULL_MS, 1.0)
            bar = QRectF(place.right() - 110, place.top() + 5, 50 * share, _LINE_PX - 10)
            painter.fillRect(bar, QColor(theme.ACCENT))
        painter.setPen(QColor(theme.TEXT if line.heading else "#b4b4b6"))
        name = painter.fontMetrics().elidedText(
            line.name, Qt.TextElideMode.ElideRight, round(place.width()) - 120
        )
        middle = Qt.AlignmentFlag.AlignVCenter
        painter.drawText(place, Qt.AlignmentFlag.AlignLeft | middle, name)
        painter.drawText(place, Qt.AlignmentFlag.AlignRight | middle, line.value)


def lines_of(
    profile: Profile,
    frame_ms: float,
    gap_ms: float,
    frame_gap_ms: float,
    whole_in_s: tuple[float, float] = (0.0, 0.0),
) -> list[Line]:
    """A profile as lines: passes, modules and jobs in milliseconds, then skipped work."""
    usual_ms, slow_ms = (round(1e3 * seconds) for seconds in whole_in_s)
    lines = [
        Line("Frame", f"{frame_ms:,.0f} ms", heading=True),
        Line("since the picture before", f"{frame_gap_ms:,.0f} ms"),
        Line("longest wait of the window", f"{gap_ms:,.0f} ms"),
        Line("gesture to whole state, 95 %", f"{usual_ms:,}, {slow_ms:,} ms"),
        *_measured(profile.passes.items()),
        Line(f"Modules, in {profile.span_s:.1f} s", "ms", heading=True),
        *_measured(profile.modules.items()),
    ]
    if profile.jobs:
        lines += [Line("Jobs that ended", "ms", heading=True), *_measured(profile.jobs.items())]
    if profile.device is not None:
        choices, trial_ns = profile.device.choices, profile.device.trial_ns
        taken = "one sample, taken over" if choices.takes_over else "finished samples"
        lines += [
            Line("Drawn by", choices.name, heading=True),
            Line("trial, a pixel", with_unit(trial_ns, "ns")),
            Line("while something moves", taken),
        ]
    for name, chosen in (profile.devices or {}).items():
        edge = f", {chosen.edge}\N{SUPERSCRIPT TWO}" if chosen.edge else ""
        lines += [Line(f"{name} computed by", chosen.device + edge), Line("because", chosen.why)]
    skipped = sorted(profile.skipped.items(), key=lambda item: -item[1])[:_MOST_LINES]
    lines.append(Line("Work left out", "times" if skipped else "none", heading=True))
    lines += [Line(f"{owner}: {work}", f"{count:,}") for (owner, work), count in skipped]
    return lines


def _measured(times: Iterable[tuple[str, float]]) -> list[Line]:
    """The longest first; those that would show 0.0 are left out."""
    longest = sorted(times, key=lambda item: -item[1])[:_MOST_LINES]
    return [Line(name, f"{ms:,.1f}", ms) for name, ms in longest if ms >= 0.05]

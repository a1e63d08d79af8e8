"""The time bar with play, speed, now, date, clock and time zone."""

from datetime import UTC, datetime, timedelta
from time import perf_counter

from PySide6.QtCore import QDate, QObject, Qt, QTime, Signal
from PySide6.QtWidgets import (
    QDateEdit,
    QHBoxLayout,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from vrut_lite.app.engine.day import Day
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.sun_day_finder import SunDayFinder, place_of
from vrut_lite.app.icons import put_sign
from vrut_lite.app.panels.clock_field import ClockField
from vrut_lite.app.panels.day_bar import DayBar
from vrut_lite.app.panels.year_strip import YearStrip
from vrut_lite.app.widgets import Chooser, ShortenedLabel, make_timer
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import ClockMoved, SetClock, SetClockRate, Tick
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.weather import SetWeather
from vrut_lite.place_time import FIRST_YEAR, LAST_YEAR, Place, parse_instant, time_zone_at
from vrut_lite.quantities import COMPUTING, degrees_text

_PERIOD_MS = 33
SPEEDS = {
    "1 s = 1 s": 1.0,
    "1 s = 1 min": 60.0,
    "1 s = 10 min": 600.0,
    "1 s = 1 h": 3600.0,
    "1 s = 1 day": 86400.0,
    "1 s = \N{MINUS SIGN}10 min": -600.0,
}
_FIRST_SPEED = "1 s = 10 min"


class Player(QObject):
    """Sends a tick once the last one moved the clock: a slow kernel gets longer ticks, no queue."""

    playing_changed = Signal(bool)

    def __init__(self, session: Session, parent: QObject | None = None):
        super().__init__(parent)
        self._session = session
        self._rate = 600.0
        self._last_s = 0.0
        self._waiting = False
        self._timer = make_timer(self, _PERIOD_MS, self._tick)
        session.listen(ClockMoved, self._moved)

    @property
    def playing(self) -> bool:
        """Whether time is playing."""
        return self._timer.isActive()

    def play(self) -> None:
        """Start playing."""
        self._last_s = perf_counter()
        self._waiting = False
        self._session.send(SetClockRate(rate=self._rate))
        self._timer.start()
        self.playing_changed.emit(True)

    def pause(self) -> None:
        """Stop playing."""
        if self.playing:
            self._timer.stop()
            self._session.send(SetClockRate(rate=0.0))
            self.playing_changed.emit(False)

    def set_rate(self, rate: float) -> None:
        """Set the clock's seconds per second of real time; negative runs backwards."""
        self._rate = rate
        if self.playing:
            self._session.send(SetClockRate(rate=rate))

    def _tick(self) -> None:
        if self._waiting:
            return
        now_s = perf_counter()
        self._waiting = True
        self._session.send(Tick(elapsed_s=now_s - self._last_s))
        self._last_s = now_s

    def _moved(self, _: ClockMoved) -> None:
        self._waiting = False


class TimePanel(QWidget):
    """Edits the clock: sends SetClock, SetClockRate and Tick."""

    def __init__(self, session: Session, scout: SunDayFinder):
        super().__init__()
        self._session = session
        self._place = Place(0.0, 0.0)
        self._instant: datetime | None = None
        self.player = Player(session, self)
        self.bar = DayBar()
        self.year = YearStrip()
        self._make_controls()
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 6, 8, 4)
        column.setSpacing(2)
        column.addLayout(self._controls_row())
        column.addWidget(self.bar)
        column.addWidget(self.year)
        self.bar.instant_chosen.connect(self.go_to)
        self.year.instant_chosen.connect(self.go_to)
        self.player.playing_changed.connect(self._playing_changed)
        scout.day_changed.connect(self._show_day)
        scout.moon_changed.connect(self.bar.show_moon)
        session.listen(SetPlace, self._show_place)
        session.listen(ClockMoved, self._show_clock)
        session.listen(SetWeather, self.year.show_weather)

    def go_to(self, instant: datetime) -> None:
        """Set the clock."""
        self._session.send(SetClock(instant=instant))

    def step_days(self, days: int) -> None:
        """Go to the same local time, days later."""
        self._go_to_local(self.date.date().addDays(days), self.clock.time)

    def go_to_now(self) -> None:
        """Go to the present moment."""
        self.go_to(datetime.now(UTC))

    def toggle_play(self) -> None:
        """Play or pause."""
        if self.player.playing:
            self.player.pause()
        else:
            self.player.play()

    # --- widgets -----------------------------------------------------------------------------

    def _make_controls(self) -> None:
        self.play = _sign_button("play", "Play or pause (Space)")
        self.play.setCheckable(True)
        self.play.clicked.connect(self.toggle_play)
        self.speed = Chooser()
        self.speed.setToolTip("Speed of playing time")
        for title, rate in SPEEDS.items():
            self.speed.addItem(title, rate)
        self.speed.activated.connect(lambda _: self.player.set_rate(self.speed.currentData()))
        self.speed.setCurrentText(_FIRST_SPEED)
        self.now = QToolButton()
        self.now.setText("Now")
        self.now.setToolTip("Go to the present moment")
        self.now.clicked.connect(self.go_to_now)
        self.before = _sign_button("before", "A day earlier")
        self.after = _sign_button("after", "A day later")
        self.before.clicked.connect(lambda: self.step_days(-1))
        self.after.clicked.connect(lambda: self.step_days(1))
        self.date, self.clock = QDateEdit(), ClockField()
        self.date.setCalendarPopup(True)
        self.date.setDisplayFormat("d MMM yyyy")
        self.date.setDateRange(QDate(FIRST_YEAR, 1, 1), QDate(LAST_YEAR, 12, 31))
        self.date.setKeyboardTracking(False)
        self.date.dateChanged.connect(lambda date: self._go_to_local(date, self.clock.time))
        self.clock.time_typed.connect(lambda time: self._go_to_local(self.date.date(), time))
        self.clock.refused.connect(self._session.problem)
        for part, name in ((self.date, "date"), (self.clock, "time of day"), (self.speed, "speed")):
            part.setAccessibleName(name)
        self.zone, self.sun = ShortenedLabel(), ShortenedLabel()
        self.sun.setText(f"day: {COMPUTING}")

    def _controls_row(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setSpacing(6)
        first: tuple[QWidget, ...] = (self.play, self.speed, self.now)
        second: tuple[QWidget, ...] = (self.before, self.date, self.after, self.clock)
        for part in first:
            row.addWidget(part)
        row.addSpacing(12)
        for part in second:
            row.addWidget(part)
        row.addWidget(self.zone, 1)
        row.addWidget(self.sun)
        return row

    # --- messages ----------------------------------------------------------------------------

    def _show_place(self, message: SetPlace) -> None:
        self._place = place_of(message)
        self._show_local()

    def _show_clock(self, message: ClockMoved) -> None:
        self._instant = message.instant
        if not self.bar.is_dragging:
            self.bar.show_instant(message.instant)
        self.year.show_instant(message.instant)
        self._show_local()

    def _show_day(self, day: Day) -> None:
        self.bar.show_day(day)
        length = _length_of_light(day)
        self.sun.setText(length)

    def _show_local(self) -> None:
        if self._instant is None:
            return
        local = self._instant.astimezone(time_zone_at(self._place))
        self.date.blockSignals(True)
        self.date.setDate(QDate(local.year, local.month, local.day))
        self.date.blockSignals(False)
        self.clock.show_time(QTime(local.hour, local.minute, local.second))
        self.zone.setText(zone_text(local))

    def _go_to_local(self, date: QDate, time: QTime) -> None:
        text = f"{date.toString(Qt.DateFormat.ISODate)}T{time.toString('HH:mm:ss')}"
        try:
            self.go_to(parse_instant(text, self._place))
        except UserError as error:
            self._session.problem.emit(str(error))
            self._show_local()

    def _playing_changed(self, playing: bool) -> None:
        self.play.setChecked(playing)
        put_sign(self.play, "pause" if playing else "play")


def zone_text(local: datetime) -> str:
    """The zone's name, offset, and whether daylight saving holds."""
    offset = local.utcoffset() or timedelta()
    minutes = int(offset.total_seconds()) // 60
    sign = "\N{MINUS SIGN}" if minutes < 0 else "+"
    hours, rest = divmod(abs(minutes), 60)
    shift = f"UTC{sign}{hours}" + (f":{rest:02d}" if rest else "")
    summer = ", daylight saving" if local.dst() else ""
    return f"{getattr(local.tzinfo, 'key', '')} ({shift}{summer})"


def _length_of_light(day: Day) -> str:
    rise, fall = day.marks.get("sunrise"), day.marks.get("sunset")
    if rise is None or fall is None or fall < rise:
        return (
            ""
            if rise or fall
            else ("midnight sun" if day.elevation_deg.max() > 0 else "polar night")
        )
    minutes = round((fall - rise).total_seconds() / 60)
    highest = float(day.elevation_deg.max())
    return f"day of {minutes // 60} h {minutes % 60:02d} min, noon sun {degrees_text(highest)}"


def _sign_button(name: str, tip: str) -> QToolButton:
    button = QToolButton()
    put_sign(button, name)
    button.setToolTip(tip)
    button.setAccessibleName(tip.partition(" (")[0])
    return button

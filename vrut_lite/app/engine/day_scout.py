"""Days looked up in the background, the latest wish first."""

from concurrent.futures import ThreadPoolExecutor
from datetime import date, datetime
from typing import NamedTuple

from PySide6.QtCore import QObject, Qt, Signal

from vrut_lite.app.engine.day import Day, SunScout
from vrut_lite.app.engine.hand_over import HandOver
from vrut_lite.app.engine.roster import Roster
from vrut_lite.app.engine.session import Session
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.place_time import Place, time_zone_at
from vrut_lite.kernel.messages import ClockMoved, SettingChanged, SlotChanged

_SUN = "sun"


class _Wish(NamedTuple):
    place: SetPlace
    day: date
    holder: str
    settings: tuple[tuple[str, object], ...]


class DayScout(QObject):
    """Tells `day_changed` (a `Day`) whenever place, date or the sun's module make another one."""

    day_changed = Signal(object)
    _found = Signal(object, object)

    def __init__(self, session: Session, parent: QObject | None = None):
        super().__init__(parent)
        self.day: Day | None = None
        self._holder = ""
        self._settings: dict[str, dict[str, object]] = {}
        self._wish: _Wish | None = None
        self._scout: SunScout | None = None
        self._closed = False
        self._tell = HandOver(self._found.emit)
        self._thread = ThreadPoolExecutor(1, "vrut-lite day")
        self._session = session
        self._found.connect(self._take, Qt.ConnectionType.QueuedConnection)
        session.closing.connect(self.close)
        session.ready.connect(self._know)
        session.listen(SetPlace, lambda _: self._look())
        session.listen(ClockMoved, lambda _: self._look())
        session.listen(SlotChanged, self._slot_changed)
        session.listen(SettingChanged, self._setting_changed)

    def close(self) -> None:
        """Look no more."""
        self._closed = True
        self._tell.close()
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _know(self, roster: Roster) -> None:
        self._settings = {name: dict(info.values) for name, info in roster.modules.items()}
        self._holder = roster.holders.get(_SUN, "")
        self._look()

    def _slot_changed(self, message: SlotChanged) -> None:
        if message.name == _SUN:
            self._holder = message.holder
            self._look()

    def _setting_changed(self, message: SettingChanged) -> None:
        self._settings.setdefault(message.module, {})[message.name] = message.value
        if message.module == self._holder:
            self._look()

    def _look(self) -> None:
        place, clock = self._session.last(SetPlace), self._session.last(ClockMoved)
        if place is None or clock is None or not self._holder or self._closed:
            return
        day = local_date(clock.instant, place)
        settings = tuple(self._settings.get(self._holder, {}).items())
        wish = _Wish(place, day, self._holder, settings)
        if wish != self._wish:
            self._wish = wish
            self._thread.submit(self._search, wish)

    def _search(self, wish: _Wish) -> None:
        if wish is not self._wish:
            return
        if self._scout is None:
            self._scout = SunScout()
        self._scout.set_up(wish.place, wish.holder, dict(wish.settings))
        day = self._scout.day(wish.day, time_zone_at(place_of(wish.place)))
        self._tell(wish, day)

    def _take(self, wish: _Wish, day: Day | None) -> None:
        if wish is self._wish and day is not None:
            self.day = day
            self.day_changed.emit(day)


def place_of(message: SetPlace) -> Place:
    """The place of a message."""
    return Place(message.latitude_deg, message.longitude_deg, message.altitude_m)


def local_date(instant: datetime, place: SetPlace) -> date:
    """The date on a calendar at the place."""
    return instant.astimezone(time_zone_at(place_of(place))).date()

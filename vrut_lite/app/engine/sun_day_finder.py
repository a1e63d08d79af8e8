"""Keeps the sun's and the moon's day of the window's place and date."""

from datetime import date, datetime
from typing import NamedTuple

from PySide6.QtCore import QObject, Signal

from vrut_lite.app.engine.day import Day, day_of
from vrut_lite.app.engine.moon_day import MoonDay, moon_of
from vrut_lite.app.engine.preview_kernel import PreviewKernel
from vrut_lite.app.engine.session import Session
from vrut_lite.app.widgets import make_timer
from vrut_lite.kernel.messages import ClockMoved, Demand, SettingChanged, SlotChanged
from vrut_lite.messages.moon_path import MoonPathChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.place_time import Place, time_zone_at

_CONSUMER = "the window's day"
# Delay of a new search after a change of the sun's settings: few of them move the sun, and the
# search would delay the pictures of a dragged slider.
_RESTS_MS = 1000
# The first day is searched when the first picture is seen, and no later than this.
_FIRST_MS = 3000


class _Wanted(NamedTuple):
    place: SetPlace
    day: date
    sun_holder: str
    settings: dict[tuple[str, str], object]


class SunDayFinder(QObject):
    """Emits `day_changed` (a `Day`) whenever place, date or the sun's module change it.

    The day is computed in the background. `moon_changed` (a `MoonDay`, or None) follows, if a
    module posts the moon's path.
    """

    day_changed = Signal(object)
    moon_changed = Signal(object)

    def __init__(self, session: Session, parent: QObject | None = None):
        super().__init__(parent)
        self.day: Day | None = None
        self.moon: MoonDay | None = None
        self._wanted: _Wanted | None = None
        # With other settings alone: it rests.
        self._awaited: _Wanted | None = None
        self._rest = make_timer(self, _RESTS_MS, self._search_anew, once=True)
        self._session = session
        session.ready.connect(lambda _: self._begin())
        session.picture_shown.connect(self._note_picture)
        session.listen(MoonPathChanged, lambda _: self._look_for_moon())
        for kind in (SetPlace, ClockMoved, SlotChanged, SettingChanged):
            session.listen(kind, lambda _: self._look())

    def _begin(self) -> None:
        self._session.send(Demand(consumer=_CONSUMER, message=MoonPathChanged.__name__))
        self._look()

    def _look(self) -> None:
        wanted = self._present()
        if wanted is None or wanted == self._wanted:
            return
        known = self._wanted
        if known is None and self._session.shown is None:
            if not self._rest.isActive():
                self._rest.start(_FIRST_MS)
        elif known is None or wanted._replace(settings=known.settings) != known:
            self._search_anew()
        elif wanted != self._awaited:
            self._awaited = wanted
            self._rest.start(_RESTS_MS)

    def _note_picture(self) -> None:
        if self._wanted is None:
            self._search_anew()

    def _present(self) -> _Wanted | None:
        place, clock = self._session.last(SetPlace), self._session.last(ClockMoved)
        holder = self._session.catalogue.holders.get("sun", "")
        if place is None or clock is None or not holder:
            return None
        settings = self._session.catalogue.settings_of(holder)
        return _Wanted(place, local_date(clock.instant, place), holder, settings)

    def _search_anew(self) -> None:
        wanted = self._awaited = self._present()
        if wanted is None or wanted == self._wanted:
            return
        self._wanted = wanted
        self._session.look_up(
            lambda second: self._search(second, wanted), lambda day: self._take(wanted, day)
        )

    def _search(self, second: PreviewKernel, wanted: _Wanted) -> Day | None:
        """Compute the day, on the second kernel's thread; None if another day was requested
        since."""
        if wanted is not self._wanted:
            return None
        second.set_up(wanted.place, wanted.sun_holder, wanted.settings)
        return day_of(second, wanted.day, time_zone_at(place_of(wanted.place)))

    def _take(self, wanted: _Wanted, day: Day | None) -> None:
        if wanted is self._wanted and day is not None:
            self.day = day
            self.day_changed.emit(day)
            self._look_for_moon()

    def _look_for_moon(self) -> None:
        path = self._session.last(MoonPathChanged)
        self.moon = None if path is None or self.day is None else moon_of(self.day, path)
        self.moon_changed.emit(self.moon)


def place_of(message: SetPlace) -> Place:
    """The place of a message."""
    return Place(message.latitude_deg, message.longitude_deg, message.altitude_m)


def local_date(instant: datetime, place: SetPlace) -> date:
    """The local date at the place."""
    return instant.astimezone(time_zone_at(place_of(place))).date()

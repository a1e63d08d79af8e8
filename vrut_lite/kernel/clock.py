"""The host's clock: set, played at a speed, and moved by ticks alone."""

from datetime import UTC, datetime, timedelta
from fractions import Fraction

from vrut_lite.kernel.messages import ClockMoved, SetClock, SetClockRate, Tick

_MICROSECOND = timedelta(microseconds=1)
_FIRST = datetime.min.replace(tzinfo=UTC)
_LAST = datetime.max.replace(tzinfo=UTC)


class Clock:
    """An instant in whole microseconds and the exact remainder of earlier ticks.

    Ticks and rates are floats, but their products are added up as fractions: an hour in
    sixtieths of a second is an hour, however it was cut. At the first and last instant that
    a date can name the clock stands still.
    """

    def __init__(self) -> None:
        self._instant: datetime | None = None
        self._rate = Fraction(0)
        self._rest_us = Fraction(0)

    def set(self, message: SetClock) -> ClockMoved:
        """Stand at an instant."""
        self._instant = message.instant.astimezone(UTC)
        self._rest_us = Fraction(0)
        return ClockMoved(instant=self._instant)

    def set_rate(self, message: SetClockRate) -> None:
        """Play at a speed, backwards if negative."""
        self._rate = Fraction(float(message.rate))

    def tick(self, message: Tick) -> ClockMoved | None:
        """Let time pass; None if the clock did not move."""
        if self._instant is None:
            return None
        passed_us = self._rest_us + Fraction(float(message.elapsed_s)) * self._rate * 1_000_000
        step_us = round(passed_us)
        before = self._instant
        room_us = (_FIRST - before) // _MICROSECOND, (_LAST - before) // _MICROSECOND
        if room_us[0] <= step_us <= room_us[1]:
            self._rest_us = passed_us - step_us
            self._instant = before + step_us * _MICROSECOND
        else:
            self._rest_us = Fraction(0)
            self._instant = _FIRST if step_us < 0 else _LAST
        return None if self._instant == before else ClockMoved(instant=self._instant)

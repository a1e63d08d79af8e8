"""The host's clock: exact, bounded, and moved by messages alone."""

from datetime import UTC, datetime, timedelta, timezone

import pytest
from hypothesis import given
from hypothesis import strategies as st
from long_parameters import mostly_long

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ClockMoved, Fault, SetClock, SetClockRate, Tick

NOON = datetime(2026, 6, 21, 12, tzinfo=UTC)


def clock_after(*inputs, at=NOON):
    """Where the clock stands after each input has had its own transaction."""
    kernel = Kernel()
    for message in (SetClock(instant=at), *inputs):
        kernel.inject(message)
        kernel.pump()
    return kernel.last(ClockMoved).instant


def test_setting_the_clock_tells_the_instant_in_utc():
    """Modules get UTC for every offset that a user writes."""
    prague = NOON.astimezone(timezone(timedelta(hours=2)))
    assert clock_after(at=prague) == NOON
    assert clock_after(at=prague).tzinfo is UTC


def test_a_clock_that_does_not_play_stands():
    """Ticks go on while the clock is paused; no module is to work for them."""
    told = []
    kernel = Kernel()
    kernel.tap(lambda message, sender: told.append(type(message)))
    for message in (Tick(elapsed_s=1.0), SetClock(instant=NOON), Tick(elapsed_s=1.0)):
        kernel.inject(message)
        kernel.pump()
    assert told.count(ClockMoved) == 1
    assert kernel.last(ClockMoved).instant == NOON


@pytest.mark.parametrize("rate", mostly_long([1.0, 60.0, -1.0, 0.1], (-1.0).__eq__))
def test_six_minutes_in_sixtieths_of_a_second_are_six_minutes(rate):
    """21,600 ticks of 1/60 s: rounding each to whole microseconds would gain 7.2 ms."""
    kernel = Kernel()
    kernel.inject(SetClock(instant=NOON))
    kernel.inject(SetClockRate(rate=rate))
    for _ in range(21_600):
        kernel.inject(Tick(elapsed_s=1 / 60))
        kernel.pump()
    assert kernel.last(ClockMoved).instant == NOON + timedelta(seconds=360 * rate)


@given(st.lists(st.floats(0, 100), min_size=1, max_size=20), st.integers(1, 20))
def test_ticks_that_wait_together_let_as_much_time_pass(elapsed, batch):
    """A slow kernel merges waiting ticks: fewer frames, the same time to float rounding."""
    kernel = Kernel()
    kernel.inject(SetClock(instant=NOON))
    kernel.inject(SetClockRate(rate=1.0))
    kernel.pump()
    transactions = 0
    for begin in range(0, len(elapsed), batch):
        for elapsed_s in elapsed[begin : begin + batch]:
            kernel.inject(Tick(elapsed_s=elapsed_s))
        transactions += kernel.pump()
    assert transactions == -(-len(elapsed) // batch)
    moved = kernel.last(ClockMoved).instant - NOON
    assert abs(moved - timedelta(seconds=sum(elapsed))) <= timedelta(microseconds=2)


@pytest.mark.parametrize(("rate", "end"), [(1e15, datetime.max), (-1e15, datetime.min)])
def test_the_clock_stands_still_at_the_end_of_dates(rate, end):
    """A played clock may run out of dates, which is no module's fault and no error."""
    moved = clock_after(SetClockRate(rate=rate), Tick(elapsed_s=1e6), Tick(elapsed_s=1e6))
    assert moved == end.replace(tzinfo=UTC)
    back = clock_after(
        SetClockRate(rate=rate),
        Tick(elapsed_s=1e6),
        SetClockRate(rate=-1.0 if rate > 0 else 1.0),
        Tick(elapsed_s=1.0),
    )
    assert abs(back - end.replace(tzinfo=UTC)) == timedelta(seconds=1)


@pytest.mark.parametrize(
    ("refused", "reason"),
    [
        (SetClock(instant=datetime(2026, 6, 21)), "needs a time zone"),
        (SetClock(instant=datetime.min.replace(tzinfo=timezone(timedelta(hours=1)))), "years"),
        (SetClockRate(rate=float("nan")), "finite"),
        (Tick(elapsed_s=-1.0), "0 s or more"),
        (Tick(elapsed_s=float("inf")), "0 s or more"),
    ],
)
def test_a_time_that_makes_no_sense_is_refused_in_one_sentence(refused, reason):
    """Bad input gives one Fault, and the clock keeps its time."""
    kernel = Kernel()
    faults = []
    kernel.tap(lambda message, _: faults.append(message) if isinstance(message, Fault) else None)
    kernel.inject(SetClock(instant=NOON))
    kernel.pump()
    kernel.inject(refused)
    kernel.pump()
    assert [(fault.where, fault.for_user) for fault in faults] == [("clock", True)]
    assert reason in faults[0].error
    assert kernel.last(ClockMoved).instant == NOON


@given(
    st.lists(
        st.one_of(
            st.floats(0, 100).map(lambda s: Tick(elapsed_s=s)),
            st.sampled_from([0.0, 1.0, 1000.0]).map(lambda r: SetClockRate(rate=r)),
            st.integers(0, 3).map(lambda h: SetClock(instant=NOON + timedelta(hours=h))),
        ),
        max_size=12,
    )
)
def test_inputs_that_wait_move_the_clock_as_they_would_one_by_one(inputs):
    """A kernel that is behind must not count time at a speed that was set after it went by."""
    kernel = Kernel()
    for message in (SetClock(instant=NOON), SetClockRate(rate=1.0), *inputs):
        kernel.inject(message)
    kernel.pump()
    apart = kernel.last(ClockMoved).instant - clock_after(SetClockRate(rate=1.0), *inputs)
    # Merged ticks round once where single ones round each to the microsecond.
    assert abs(apart) < timedelta(milliseconds=1)

"""Isolation: whatever a module raises, wherever, is its own Fault, and everything else goes on."""

import asyncio
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st
from probe_messages import Heard, Poke, act, collect, faults_of

from vrut_lite.daylight.sun import SunMoved
from vrut_lite.errors import UserError
from vrut_lite.interrupts import Terminated, interrupted_during
from vrut_lite.kernel import seat
from vrut_lite.kernel.bus import POSTS_PER_TRANSACTION, Kernel
from vrut_lite.kernel.messages import (
    EnableModule,
    Fault,
    Input,
    JobResult,
    ReloadModule,
    RestartModule,
    SetSetting,
    Tick,
)
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.recording.held_runner import HeldRunner


class Panic(BaseException):
    """As the exceptions of libraries that are written in Rust: no Exception."""


class Mute(Exception):
    """Cannot say what it is."""

    def __str__(self):
        raise Panic("no words")

    __repr__ = __str__


class NoText(Exception):
    def __str__(self):
        return 5  # type: ignore[return-value]


class Surrogate(str):
    """A text that is none when it is looked at."""

    def __format__(self, spec):
        raise Panic(spec)

    def __len__(self):
        raise Panic("len")


class OddText(Exception):
    def __str__(self):
        return Surrogate("lone \ud800 and \x00 and \x1b[2J")


class OddName(type):
    @property
    def __name__(cls):
        raise Panic("no name")


Nameless = OddName("Nameless", (Exception,), {})


class OddNotes(Exception):
    __notes__ = 7


def cyclic():
    first, second = ValueError("first"), ValueError("second")
    first.__cause__, second.__cause__ = second, first
    return first


def chained():
    error = ValueError("the last")
    for number in range(3000):
        outer = ValueError(number)
        outer.__cause__, error = error, outer
    return error


RAISED = {
    "exception": lambda: ValueError("plain"),
    "panic": lambda: Panic("a library panicked"),
    "cancelled": lambda: asyncio.CancelledError(),
    "generator exit": lambda: GeneratorExit(),
    "exit": lambda: SystemExit(3),
    "group": lambda: BaseExceptionGroup("all", [Panic("one"), KeyboardInterrupt()]),
    "mute": Mute,
    "no text": NoText,
    "odd text": OddText,
    "odd name": Nameless,
    "odd notes": OddNotes,
    "huge": lambda: ValueError("x" * 10**6),
    "huge number": lambda: ValueError(10**6000),
    "cycle": cyclic,
    "chain": chained,
    "stop": lambda: StopIteration(1),
    "recursion": lambda: RecursionError("deep"),
    "memory": lambda: MemoryError(),
}
WHERE = ["on_poke", "job", "start", "settings_changed", "snapshot", "restore"]


def bad_module(where, make):
    """A module that raises what `make` makes at that place, once it is told to."""

    class Bad(Module):
        manifest = Manifest(name="bad", title="Bad", version="1")
        armed = where == "start"

        def __init__(self, link, settings):
            super().__init__(link, settings)
            self._raise("start")

        def _raise(self, here):
            if where == here and type(self).armed:
                raise make()

        @handles(Poke)
        def on_poke(self, message):
            self._raise("on_poke")
            if where == "job":
                self.link.start_job("work", self._raise, "job")

        def settings_changed(self, name):
            self._raise("settings_changed")

        def snapshot(self):
            self._raise("snapshot")
            return {"kept": 1}

        def restore(self, state):
            self._raise("restore")

    return Bad


class Good(Module):
    """Hears after the bad one, and says so."""

    manifest = Manifest(name="good", title="Good", version="1")

    @handles(Poke)
    def on_poke(self, message):
        self.link.post(Heard(module="good", value=message.value))


@pytest.mark.parametrize("kind", RAISED)
@pytest.mark.parametrize("where", ["on_poke", "job", "start"])
def test_whatever_a_module_raises_is_its_fault(where, kind):
    """Handler, job or constructor: one readable Fault of bounded size; the others hear on."""
    bad = bad_module(where, RAISED[kind])
    bad.armed = True
    kernel = Kernel()
    faults, heard = faults_of(kernel), collect(kernel, Heard)
    kernel.add_module(bad)
    kernel.add_module(Good)
    kernel.inject(Poke(value=7))
    ended = threading.Thread(target=kernel.pump_until_idle, daemon=True)
    ended.start()
    ended.join(20.0)
    assert not ended.is_alive(), "nobody may wait for ever"
    assert [fault.module for fault in faults] == ["bad"]
    assert faults[0].where == ("job work" if where == "job" else where)
    assert len(faults[0].error) < 2500
    assert len(faults[0].trace) < 21_000
    said = faults[0].error + faults[0].trace
    assert said.encode()
    assert said.replace("\n", "").replace("\t", "").isprintable(), "nothing steers a terminal"
    assert [message.value for message in heard] == [7]
    assert kernel.seats["bad"].running == (where != "start")
    kernel.close()


@pytest.mark.parametrize("kind", ["panic", "mute", "cancelled", "odd name"])
def test_a_job_that_raised_can_be_started_again(kind):
    """Its key is free at once: the next job of that name runs."""
    bad = bad_module("job", RAISED[kind])
    kernel = Kernel()
    kernel.add_module(bad)
    results = collect(kernel, JobResult)
    for armed in (True, False):
        bad.armed = armed
        kernel.inject(Poke())
        kernel.pump_until_idle()
    assert [bool(result.error) for result in results] == [True, False]
    kernel.close()


def test_three_panics_suspend_as_three_errors_do():
    """What is no Exception counts like one."""
    bad = bad_module("on_poke", RAISED["panic"])
    bad.armed = True
    kernel = Kernel()
    kernel.add_module(bad)
    act(kernel, Poke(), Poke(), Poke())
    assert kernel.seats["bad"].state == "suspended"


@pytest.mark.parametrize("asked", [KeyboardInterrupt, Terminated])
@pytest.mark.parametrize("where", ["on_poke", "start"])
def test_a_request_to_end_ends(asked, where):
    """Ctrl-C and SIGTERM arrive wherever the main thread is: no module may swallow them."""
    bad = bad_module(where, asked)
    bad.armed = True
    kernel = Kernel()

    def ask():
        kernel.add_module(bad)
        act(kernel, Poke())

    with pytest.raises(asked) as ended:
        ask()
    what = "at the start of" if where == "start" else f"in {where} of"
    assert interrupted_during(ended.value) == f"{what} the module bad"


def test_on_other_threads_nobody_asks_to_end():
    """Python raises Ctrl-C in the main thread alone: elsewhere it is the module's own raise."""
    bad = bad_module("job", KeyboardInterrupt)
    bad.armed = True
    kernel = Kernel()
    kernel.add_module(bad)
    faults = faults_of(kernel)
    kernel.inject(Poke())
    kernel.pump_until_idle()
    assert [fault.where for fault in faults] == ["job work"]
    kernel.close()


# --- what is no exception, but as bad -----------------------------------------------------


class Odd:
    """An object that raises at every question."""

    def __getattribute__(self, name):
        raise Panic(name)


class Hostile(Module):
    """Does one of many things at a poke."""

    manifest = Manifest(name="hostile", title="Hostile", version="1")
    deed = staticmethod(lambda module: None)

    @handles(Poke)
    def on_poke(self, message):
        return type(self).deed(self)


async def later():
    """Never run."""


DEEDS = {
    "no job": lambda m: m.link.start_job("j", None),
    "a job that is odd": lambda m: m.link.start_job("j", Odd()),
    "a job without a name": lambda m: m.link.start_job(["j"], abs, 1),
    "an async job": lambda m: m.link.start_job("j", later),
    "a job that is a generator": lambda m: m.link.start_job("j", lambda: (x for x in ())),
    "a job with other arguments": lambda m: m.link.start_job("j", abs, 1, 2, 3),
    "a demand by text": lambda m: m.link.demand("SunMoved"),
    "a demand of text size": lambda m: m.link.demand(SunMoved, size="x"),
    "a demand of half a size": lambda m: m.link.demand(SunMoved, size=0.5),
    "a demand of truth": lambda m: m.link.demand(SunMoved, size=True),
    "a demand too large": lambda m: m.link.demand(SunMoved, size=10**400),
    "a demand below 0": lambda m: m.link.demand(SunMoved, size=-1),
    "a demand in no encoding": lambda m: m.link.demand(SunMoved, encoding=3),
    "a post of nothing": lambda m: m.link.post(None),
    "a post of an input": lambda m: m.link.post(Tick(elapsed_s=1.0)),
    "a post of something odd": lambda m: m.link.post(Odd()),
    "a coroutine": lambda m: later(),
    "a generator": lambda m: (x for x in ()),
    "a question by list": lambda m: m.link.last([]),
    "a wish by number": lambda m: m.link.wanted(3),
}


@pytest.mark.parametrize("deed", DEEDS)
def test_odd_calls_are_faults_of_who_calls(deed):
    """A module that misuses its link harms itself alone, and is told by name."""

    class Bad(Hostile):
        pass

    Bad.deed = staticmethod(DEEDS[deed])
    kernel = Kernel()
    kernel.add_module(Bad)
    kernel.add_module(Good)
    faults, heard = faults_of(kernel), collect(kernel, Heard)
    kernel.inject(Poke(value=1))
    kernel.pump_until_idle()
    assert [fault.module for fault in faults] == ["hostile"]
    assert not faults[0].for_user, "nobody but its maker can mend it: it counts"
    assert len(heard) == 1
    assert kernel.lifecycle.demands.every() == []
    kernel.close()


def cycle():
    made = []
    made.append(made)
    return made


@pytest.mark.parametrize("value", [Odd, cycle, lambda: [later], Mute, lambda: 10**6000])
def test_a_job_s_result_may_be_anything(value):
    """What it is matters to the module that asked alone."""

    class Asker(Hostile):
        deed = staticmethod(lambda module: module.link.start_job("j", value))

        @handles(JobResult)
        def on_result(self, message):
            self.link.post(Heard(module="asker", value=1))

    kernel = Kernel()
    kernel.add_module(Asker)
    heard = collect(kernel, Heard)
    kernel.inject(Poke())
    kernel.pump_until_idle()
    assert len(heard) == 1
    kernel.close()


def test_the_progress_of_a_job_is_told_in_a_line_of_bounded_length():
    """The trace keeps a thousand remarks: none may fill the memory."""

    def work(control):
        control.progress(0.5, "x" * 10**6)

    class Asker(Hostile):
        deed = staticmethod(lambda module: module.link.start_job("j", work))

    kernel = Kernel(runner=HeldRunner())
    kernel.add_module(Asker)
    act(kernel, Poke())
    kernel.pump_until_idle()
    told = [remark.text for remark in kernel.trace.remarks() if remark.kind == "progress"]
    assert len(told) == 1
    assert len(told[0]) < 300


# --- storms -------------------------------------------------------------------------------


@pytest.mark.parametrize("speech", ["post", "demand"])
@pytest.mark.parametrize("way", ["add", "restart", "enable"])
def test_a_storm_in_a_constructor_ends_suspended_and_stays_so(speech, way):
    """An instance that was cut for what it said while it was made must never run."""

    class Stormy(Module):
        manifest = Manifest(name="stormy", title="Stormy", version="1")
        calm = way != "add"

        def __init__(self, link, settings):
            super().__init__(link, settings)
            for number in range(0 if type(self).calm else POSTS_PER_TRANSACTION + 5):
                if speech == "post":
                    link.post(Heard(module="stormy", value=number))
                else:
                    link.demand(Heard, size=number % 7)

        @handles(Poke)
        def on_poke(self, message):
            self.link.post(Heard(module="stormy", value=-1))

    kernel = Kernel()
    faults, heard = faults_of(kernel), collect(kernel, Heard)
    kernel.add_module(Stormy)
    Stormy.calm = False
    if way == "enable":
        act(kernel, EnableModule(module="stormy", enabled=False), EnableModule(module="stormy"))
    elif way == "restart":
        act(kernel, RestartModule(module="stormy"))
    act(kernel, Poke())
    assert [fault.suspended for fault in faults] == [True]
    assert f"over {POSTS_PER_TRANSACTION} messages" in faults[0].error
    assert kernel.seats["stormy"].state == "suspended"
    assert -1 not in [message.value for message in heard]
    assert kernel.wanted(Heard) is None
    Stormy.calm = True
    act(kernel, RestartModule(module="stormy"), Poke())
    assert heard[-1].value == -1


def test_a_job_that_starts_the_next_for_ever_is_cut_by_count(monkeypatch):
    """A command waits for jobs: a chain of them must end. Each other input begins anew."""
    assert seat.JOBS_IN_A_CHAIN >= 4096, "a picture that grows has so many passes"
    monkeypatch.setattr(seat, "JOBS_IN_A_CHAIN", 50)

    class Chained(Module):
        manifest = Manifest(name="chained", title="Chained", version="1")

        @handles(Poke)
        @handles(JobResult)
        def on_any(self, message):
            if not (isinstance(message, JobResult) and message.value <= 1):
                left = message.value if isinstance(message, Poke) else message.value - 1
                self.link.start_job("next", abs, left)

    kernel = Kernel(runner=HeldRunner())
    kernel.add_module(Chained)
    faults = faults_of(kernel)
    for _ in range(2):
        kernel.inject(Poke(value=50))
        kernel.pump_until_idle()
    assert not faults
    kernel.inject(Poke(value=500))
    kernel.pump_until_idle()
    assert [fault.suspended for fault in faults] == [True]
    assert "started over 50 jobs after one input" in faults[0].error
    assert kernel.seats["chained"].state == "suspended"


# --- inputs that are not as they should be ------------------------------------------------


class OddInput(Input, frozen=True, kw_only=True):
    """A module's own input, which fails wherever it is asked."""

    what: str

    def key(self):
        if self.what == "key":
            raise Panic("no key")
        return [] if self.what == "unhashable key" else "one"

    def check(self):
        if self.what == "check":
            raise Panic("no check")
        if self.what == "user":
            raise UserError("mend it")


@given(st.lists(st.sampled_from(["key", "unhashable key", "check", "user", "good"]), max_size=6))
def test_an_input_that_fails_itself_costs_itself_alone(whats):
    """What has no key or cannot be checked is refused in a sentence, and merges with nothing."""
    kernel = Kernel()
    kernel.add_module(Good)
    faults, heard = faults_of(kernel), collect(kernel, Heard)
    for what in whats:
        kernel.inject(OddInput(what=what))
    kernel.inject(Poke(value=3))
    kernel.pump()
    assert len(faults) == sum(what != "good" for what in whats)
    assert all(fault.for_user for fault in faults)
    assert [message.value for message in heard] == [3]


def test_time_that_is_none_spoils_no_time_that_waits():
    """Ticks that wait are added up: one that is refused must not take others with it."""
    kernel = Kernel()
    ticks, faults = collect(kernel, Tick), faults_of(kernel)
    for elapsed in (1.0, float("nan"), 2.0, "x", None, 4.0, -1.0, 8.0):
        kernel.inject(Tick(elapsed_s=elapsed))
    kernel.pump()
    assert len(faults) == 4
    assert kernel.last(Tick) is not None
    sound = [tick.elapsed_s for tick in ticks if isinstance(tick.elapsed_s, float)]
    assert sum(elapsed for elapsed in sound if elapsed > 0) == 15.0


def test_a_module_s_settings_may_refuse_each_other():
    """A rule over several settings, which raises, is a refusal in a sentence."""
    import msgspec

    class Pair(msgspec.Struct, frozen=True):
        low: float = 0.0
        high: float = 1.0

        def __post_init__(self):
            if self.low > self.high:
                raise Panic("low lies above high")

    class Paired(Module):
        manifest = Manifest(name="paired", title="Paired", version="1")
        settings_type = Pair

    kernel = Kernel()
    kernel.add_module(Paired)
    faults = faults_of(kernel)
    act(kernel, SetSetting(module="paired", name="low", value=2.0))
    assert faults[0].for_user
    assert "low of paired cannot be 2.0: Panic: low lies above high" in faults[0].error
    assert kernel.seats["paired"].settings == Pair()
    act(kernel, SetSetting(module="paired", name="high", value=3.0))
    act(kernel, SetSetting(module="paired", name="low", value=2.0))
    assert kernel.seats["paired"].settings == Pair(2.0, 3.0)


def test_a_module_that_takes_no_settings_is_told():
    """Setting an attribute runs the module's code too."""
    import msgspec

    class One(msgspec.Struct, frozen=True):
        one: float = 0.0

    class Closed(Module):
        manifest = Manifest(name="closed", title="Closed", version="1")
        settings_type = One

        def __setattr__(self, name, value):
            if name == "settings" and hasattr(self, "settings"):
                raise Panic("closed")
            super().__setattr__(name, value)

    kernel = Kernel()
    kernel.add_module(Closed)
    faults = faults_of(kernel)
    act(kernel, SetSetting(module="closed", name="one", value=1.0))
    assert [fault.module for fault in faults] == ["closed"]


@pytest.mark.parametrize("handler", ["gone", "none", "raises"])
def test_a_handler_that_is_gone_is_a_fault(handler):
    """Methods are looked up on the instance, which may have changed them."""

    class Shifty(Module):
        manifest = Manifest(name="shifty", title="Shifty", version="1")

        def __init__(self, link, settings):
            super().__init__(link, settings)
            if handler == "none":
                self.on_poke = None

        @handles(Poke)
        def on_poke(self, message):
            """Never reached."""

        def __getattribute__(self, name):
            if name == "on_poke" and handler != "none":
                raise AttributeError(name) if handler == "gone" else Panic(name)
            return super().__getattribute__(name)

    kernel = Kernel()
    faults, heard = faults_of(kernel), collect(kernel, Heard)
    kernel.add_module(Shifty)
    kernel.add_module(Good)
    act(kernel, Poke(value=1))
    assert {fault.module for fault in faults} <= {"shifty"}
    assert len(heard) == 1
    assert all(isinstance(fault, Fault) for fault in faults)


def test_a_constructor_that_forgets_its_base_is_told():
    """Its ledger is asked for by commands and panels long after."""

    class Forgetful(Module):
        manifest = Manifest(name="forgetful", title="Forgetful", version="1")

        def __init__(self, link, settings):
            pass

    kernel = Kernel()
    faults = faults_of(kernel)
    kernel.add_module(Forgetful)
    kernel.pump()
    assert "super().__init__(link, settings)" in faults[0].error
    assert kernel.seats["forgetful"].ledger.done == {}
    act(kernel, ReloadModule(module="forgetful"))

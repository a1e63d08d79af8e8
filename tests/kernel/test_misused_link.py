"""A module that misuses its link, or hands odd objects to it, harms itself alone."""

import pytest
from hostile_modules import Good, Hostile, Mute, Odd
from probe_messages import Heard, Poke, act, collect, faults_of

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import JobResult, Tick
from vrut_lite.kernel.module import handles
from vrut_lite.messages.sun import SunMoved
from vrut_lite.recording.replay_runner import ReplayRunner


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
def test_invalid_calls_are_faults_of_the_caller(deed):
    """A module that misuses its link gets a Fault by name; others are unaffected."""

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
    """Only the asking module reads it."""

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


def test_progress_remarks_have_bounded_length():
    """The trace keeps a thousand remarks: none may fill the memory."""

    def work(control):
        control.progress(0.5, "x" * 10**6)

    class Asker(Hostile):
        deed = staticmethod(lambda module: module.link.start_job("j", work))

    kernel = Kernel(runner=ReplayRunner())
    kernel.add_module(Asker)
    act(kernel, Poke())
    kernel.pump_until_idle()
    told = [remark.text for remark in kernel.trace.remarks() if remark.kind == "progress"]
    assert len(told) == 1
    assert len(told[0]) < 300

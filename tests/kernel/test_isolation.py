"""Isolation: every exception of a module is its own Fault, and everything else goes on."""

import threading

import pytest
from hostile_modules import RAISED, Good, bad_module
from probe_messages import Heard, Poke, act, collect, faults_of

from vrut_lite.interrupts import Terminated, interrupted_during
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import JobResult


@pytest.mark.parametrize("kind", RAISED)
@pytest.mark.parametrize("where", ["on_poke", "job", "start"])
def test_every_exception_of_a_module_is_its_fault(where, kind):
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
    """A BaseException counts like an Exception."""
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


def test_interrupts_on_other_threads_are_faults():
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

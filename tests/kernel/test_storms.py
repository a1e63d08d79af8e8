"""Storms: a module that posts or starts jobs without end is suspended."""

import pytest
from probe_messages import Heard, Poke, act, collect, faults_of

from vrut_lite.kernel import loaded_module
from vrut_lite.kernel.bus import POSTS_PER_TRANSACTION, Kernel
from vrut_lite.kernel.messages import EnableModule, JobResult, RestartModule
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.recording.replay_runner import ReplayRunner


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
    assert loaded_module.JOBS_IN_A_CHAIN >= 4096, "a picture that grows has so many passes"
    monkeypatch.setattr(loaded_module, "JOBS_IN_A_CHAIN", 50)

    class Chained(Module):
        manifest = Manifest(name="chained", title="Chained", version="1")

        @handles(Poke)
        @handles(JobResult)
        def on_any(self, message):
            if not (isinstance(message, JobResult) and message.value <= 1):
                left = message.value if isinstance(message, Poke) else message.value - 1
                self.link.start_job("next", abs, left)

    kernel = Kernel(runner=ReplayRunner())
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

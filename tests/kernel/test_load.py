"""Load: floods of inputs, storms of posts, and the memory that they leave."""

import sys
import threading

import pytest
from kernel_thread import KernelThread
from probe_messages import Heard, Poke, Slide, act, collect, faults_of

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import POSTS_PER_TRANSACTION, Kernel
from vrut_lite.kernel.messages import Demand, Fault, JobResult
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.recording.replay_runner import ReplayRunner

SLIDES = 100_000


class SlowSky(Module):
    """Works out a sky in the background for each value of a slider."""

    manifest = Manifest(name="sky", title="Sky", version="1")

    @handles(Slide)
    def on_slide(self, message: Slide) -> None:
        self.link.start_job("sky", abs, message.value)

    @handles(JobResult)
    def on_result(self, message: JobResult) -> None:
        self.link.post(Heard(module="sky", value=message.value))


def test_a_flood_of_slider_inputs_ends_with_the_last_value_and_few_skies():
    """100,000 values: the last arrives, no more skies than were finished, memory stays flat."""
    runner = ReplayRunner()
    kernel = Kernel(runner=runner)
    kernel.add_module(SlowSky)
    kernel.pump()
    skies = collect(kernel, Heard)

    def drag(begin, end, finished_each):
        for value in range(begin, end):
            kernel.inject(Slide(value=value))
            if value % 4 == 0:
                kernel.pump()
            if value % finished_each == 0:
                runner.wait()

    # Until the trace's ring is full, memory grows by design.
    drag(0, SLIDES, 10_000)
    blocks = sys.getallocatedblocks()
    drag(SLIDES, 2 * SLIDES, 10_000)
    kernel.pump_until_idle()
    assert skies[-1].value == 2 * SLIDES - 1
    assert len(skies) <= 2 * SLIDES / 10_000 + 2
    assert sys.getallocatedblocks() - blocks < 500


def test_while_a_handler_is_slow_only_the_latest_input_waits():
    """The window's thread may inject as fast as it likes: no backlog forms behind a sky."""
    entered, go_on, values = threading.Event(), threading.Event(), []

    class Sleeper(Module):
        manifest = Manifest(name="sleeper", title="Sleeper", version="1")

        @handles(Slide)
        def on_slide(self, message: Slide) -> None:
            values.append(message.value)
            entered.set()
            go_on.wait(10)

    kernel = Kernel()
    kernel.add_module(Sleeper)
    errors = []
    thread = KernelThread(kernel, on_error=errors.append)
    thread.start()
    kernel.inject(Slide(value=0))
    assert entered.wait(10)
    for value in range(1, 10_000):
        kernel.inject(Slide(value=value))
    go_on.set()
    thread.stop()
    assert values == [0, 9_999]
    assert errors == []


def test_a_storm_of_two_that_answer_each_other_is_cut_by_count():
    """Each is harmless alone; together they never end, and double at each turn."""

    def answerer(own, other):
        class Answerer(Module):
            manifest = Manifest(name=own, title=own, version="1")

            @handles(Poke)
            @handles(Heard)
            def on_any(self, message: Poke | Heard) -> None:
                if isinstance(message, Poke) or message.module == other:
                    self.link.post(Heard(module=own, value=0))
                    self.link.post(Heard(module=own, value=1))

        return Answerer

    kernel = Kernel()
    kernel.add_module(answerer("left", "right"))
    kernel.add_module(answerer("right", "left"))
    kernel.pump()
    heard, faults = collect(kernel, Heard), faults_of(kernel)
    act(kernel, Poke())
    assert len(heard) <= 2 * POSTS_PER_TRANSACTION
    assert faults[0].suspended
    assert f"over {POSTS_PER_TRANSACTION} messages" in faults[0].error
    # One alone finds nobody to quarrel with, and works on.
    left = [name for name in ("left", "right") if kernel.seats[name].running]
    assert len(left) == 2 - len(faults)
    act(kernel, Poke())
    assert len(faults) == 2 - len(left)


def test_posts_are_counted_anew_in_each_transaction():
    """A module that is busy all day is no storm."""

    class Busy(Module):
        manifest = Manifest(name="busy", title="Busy", version="1")

        @handles(Poke)
        def on_poke(self, message: Poke) -> None:
            for _ in range(POSTS_PER_TRANSACTION):
                self.link.post(Heard(module="busy", value=0))

    kernel = Kernel()
    kernel.add_module(Busy)
    heard = collect(kernel, Heard)
    act(kernel, Poke(), Poke())
    assert len(heard) == 2 * POSTS_PER_TRANSACTION
    assert kernel.seats["busy"].running


@pytest.mark.parametrize("answer", ["demand", "user_error"])
def test_a_storm_of_demands_or_of_refusals_is_cut_too(answer):
    """Whatever a handler answers with, it ends by count: wishes, and sentences for the user."""

    class Stormy(Module):
        manifest = Manifest(name="stormy", title="Stormy", version="1")

        @handles(Poke)
        @handles(Demand)
        @handles(Fault)
        def on_any(self, message: Poke | Demand | Fault) -> None:
            if answer == "demand":
                self.link.demand(Heard)
            else:
                raise UserError("mend this")

    kernel = Kernel()
    kernel.add_module(Stormy)
    kernel.pump()
    faults = faults_of(kernel)
    act(kernel, Poke())
    assert kernel.seats["stormy"].state == "suspended"
    assert f"over {POSTS_PER_TRANSACTION} messages" in faults[-1].error


def test_an_exit_of_a_module_is_a_fault():
    """sys.exit in a handler or in a job must not end the host, nor leave it waiting."""

    class Quitter(Module):
        manifest = Manifest(name="quitter", title="Quitter", version="1")

        @handles(Poke)
        def on_poke(self, message: Poke) -> None:
            self.link.start_job("quit", sys.exit, 3)
            sys.exit(4)

    kernel = Kernel()
    kernel.add_module(Quitter)
    kernel.pump()
    faults = faults_of(kernel)
    kernel.inject(Poke())
    kernel.pump_until_idle()
    assert [fault.error for fault in faults] == ["SystemExit: 4", "SystemExit: 3"]

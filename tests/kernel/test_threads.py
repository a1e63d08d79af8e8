"""Threads: injection from any, the kernel on its own, values handed to another."""

import sys
import threading

import pytest
from kernel_thread import KernelThread
from probe_messages import Heard, Poke, Slide, collect

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.mailbox import Mailbox

INJECTORS, POKES = 3, 1000


class Answerer(Module):
    manifest = Manifest(name="answerer", title="Answerer", version="1")

    @handles(Poke)
    def on_poke(self, message: Poke) -> None:
        self.link.post(Heard(module="answerer", value=message.value))

    @handles(Slide)
    def on_slide(self, message: Slide) -> None:
        self.link.post(Heard(module="slide", value=message.value))


def kernel_with_answerer():
    kernel = Kernel()
    kernel.add_module(Answerer)
    kernel.pump()
    return kernel


@pytest.fixture
def hasty_threads():
    """Threads that take turns very often, so that races show."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    yield
    sys.setswitchinterval(interval)


@pytest.mark.usefixtures("hasty_threads")
def test_no_input_of_any_thread_is_lost_doubled_or_reordered():
    """Three threads inject while the kernel pumps: each one's inputs come once, in its order."""
    kernel = kernel_with_answerer()
    heard, admitted = collect(kernel, Heard), []
    kernel.watch_admission(admitted.append)
    thread = KernelThread(kernel, on_error=pytest.fail)

    def inject(number):
        for count in range(POKES):
            kernel.inject(Poke(value=number * POKES + count))

    thread.start()
    injectors = [threading.Thread(target=inject, args=(number,)) for number in range(INJECTORS)]
    for injector in injectors:
        injector.start()
    for injector in injectors:
        injector.join()
    thread.stop()
    values = [message.value for message in heard]
    assert [message.value for message in admitted] == values
    for number in range(INJECTORS):
        assert [v for v in values if v // POKES == number] == [
            number * POKES + count for count in range(POKES)
        ]
    assert len(values) == INJECTORS * POKES


def test_the_thread_sleeps_until_an_input_wakes_it():
    """An idle kernel costs nothing, and the next input is acted on without a poll."""
    kernel = kernel_with_answerer()
    answered, pumps, pump = threading.Event(), [], kernel.pump
    kernel.pump = lambda: pumps.append(1) or pump()
    kernel.tap(lambda message, _: answered.set() if isinstance(message, Heard) else None)
    thread = KernelThread(kernel, on_error=pytest.fail)
    thread.start()
    for _ in range(20):
        kernel.inject(Poke())
        assert answered.wait(10)
        answered.clear()
    thread.stop()
    # Once for each input, at the start, at the end, and when woken to end.
    assert len(pumps) <= 20 + 3


def test_an_error_of_the_host_is_reported_and_the_thread_goes_on():
    """A tap is the host's own code: its error is no module's Fault, and must not end the kernel."""
    kernel = kernel_with_answerer()
    errors, heard = [], collect(kernel, Heard)

    def refuse_odd(message, sender):
        if isinstance(message, Poke) and message.value % 2:
            raise OSError("disk full")

    kernel.tap(refuse_odd)
    thread = KernelThread(kernel, on_error=errors.append)
    for value in range(6):
        kernel.inject(Poke(value=value))
    thread.start()
    thread.stop()
    assert [str(error) for error in errors] == ["disk full"] * 3
    assert [message.value for message in heard] == [0, 2, 4]


def test_a_mailbox_wakes_once_and_holds_the_latest():
    """200,000 values must not become 200,000 events: one wake-up, one value of each key."""
    wakes = []
    mailbox = Mailbox(lambda: wakes.append(1))
    for value in range(10_000):
        mailbox.put("sun", value)
        mailbox.put("sky", -value)
    assert (len(wakes), mailbox.take_all()) == (1, {"sun": 9999, "sky": -9999})
    assert mailbox.take_all() == {}
    mailbox.put("sun", 1)
    assert (len(wakes), mailbox.take_all()) == (2, {"sun": 1})


@pytest.mark.usefixtures("hasty_threads")
def test_a_mailbox_read_at_each_wake_up_misses_no_last_value():
    """The reader that comes whenever it is woken always ends with the last value."""
    woken, seen = threading.Semaphore(0), []
    mailbox = Mailbox(woken.release)

    def read():
        while not seen or seen[-1] != POKES:
            assert woken.acquire(timeout=10)
            seen.extend(mailbox.take_all().values())

    reader = threading.Thread(target=read)
    reader.start()
    for value in range(POKES + 1):
        mailbox.put("sun", value)
    reader.join(timeout=10)
    assert not reader.is_alive()
    assert seen == sorted(set(seen))

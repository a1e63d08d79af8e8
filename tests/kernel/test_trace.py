"""The trace: causes, durations, and slow handlers."""

import json

import pytest
from probe_messages import Heard, Poke, act

from vrut_lite.kernel import dispatch
from vrut_lite.kernel.bus import HOST, Kernel
from vrut_lite.kernel.messages import Fault, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.kernel.trace import SLOW_NS
from vrut_lite.recording.chrome_trace import export_chrome


class FakeTime:
    """Time that passes by a nanosecond a look, and as far as a test says."""

    def __init__(self):
        self.now_ns = 0

    def __call__(self):
        self.now_ns += 1
        return self.now_ns


@pytest.fixture(autouse=True)
def fake_time(monkeypatch):
    monkeypatch.setattr(dispatch, "perf_counter_ns", FakeTime())


class Answerer(Module):
    manifest = Manifest(name="answerer", title="Answerer", version="1")

    @handles(Poke)
    def on_poke(self, message: Poke) -> None:
        if message.value < 0:
            dispatch.perf_counter_ns.now_ns += SLOW_NS
        self.link.post(Heard(module="answerer", value=message.value))


class Listener(Module):
    manifest = Manifest(name="listener", title="Listener", version="1")

    @handles(Heard)
    @handles(Poke)
    def on_any(self, message: Heard | Poke) -> None:
        """Nothing."""


def kernel_with_both():
    kernel = Kernel()
    kernel.add_module(Answerer)
    kernel.add_module(Listener)
    kernel.pump()
    return kernel


def test_every_delivery_names_its_cause():
    """The causes of a new sky lead back to an input."""
    kernel = kernel_with_both()
    act(kernel, Poke(), Poke(value=1))
    told = [entry[:5] for entry in kernel.trace.entries()]
    assert told == [
        (1, 0, HOST, "Poke", "answerer"),
        (1, 0, HOST, "Poke", "listener"),
        (2, 1, "answerer", "Heard", "listener"),
        (3, 0, HOST, "Poke", "answerer"),
        (3, 0, HOST, "Poke", "listener"),
        (4, 3, "answerer", "Heard", "listener"),
    ]
    times = [time_ns for entry in kernel.trace.entries() for time_ns in entry[5:]]
    assert times == sorted(times)


def test_kernel_actions_and_unheard_messages_are_traced():
    """A setting that only the kernel acts on, and its unheard consequence, are not invisible."""
    kernel = kernel_with_both()
    act(kernel, SetSetting(module="nobody", name="x", value=1))
    told = [entry[:5] for entry in kernel.trace.entries()]
    assert told == [(1, 0, HOST, "SetSetting", HOST), (2, 1, HOST, "Fault", "")]


def test_a_slow_handler_is_named_once_and_in_no_message():
    """Wall time must not reach a message: a replay on a faster machine would differ."""
    kernel = kernel_with_both()
    heard = []
    kernel.tap(lambda message, _: heard.append(type(message)))
    act(kernel, Poke(value=-1), Poke(value=1))
    slow = [remark for remark in kernel.trace.remarks() if remark.kind == "slow handler"]
    assert [(remark.module, remark.text) for remark in slow] == [
        ("answerer", "on_poke took 16.0 ms")
    ]
    assert Fault not in heard


def test_the_ring_keeps_the_latest_entries():
    """A kernel that runs for days keeps a bounded memory of what it did."""
    kernel = kernel_with_both()
    room = kernel.trace.deliveries.maxlen
    for _ in range(room // 3 + 10):
        kernel.inject(Poke())
    kernel.pump()
    entries = kernel.trace.entries()
    assert len(entries) == room
    assert entries[-1].sequence - entries[0].sequence < room


def test_the_export_is_json_with_spans_rows_and_arrows():
    """Chrome and Perfetto want ph, ts, dur in microseconds and integer pid and tid."""
    kernel = kernel_with_both()
    act(kernel, Poke(value=-1))
    chrome = json.loads(json.dumps(export_chrome(kernel.trace.entries(), kernel.trace.remarks())))
    events = chrome["traceEvents"]
    rows = {event["args"]["name"]: event["tid"] for event in events if event["ph"] == "M"}
    spans = [event for event in events if event["ph"] == "X"]
    assert set(rows) == {"answerer", "listener", "answerer: slow handler"}
    assert [span["name"] for span in spans[:3]] == ["Poke", "Poke", "Heard"]
    assert spans[0]["dur"] == (SLOW_NS + 1) / 1e3
    (leave,) = (event for event in events if event["ph"] == "s")
    (arrive,) = (event for event in events if event["ph"] == "f")
    assert (leave["tid"], arrive["tid"]) == (rows["answerer"], rows["listener"])
    assert leave["id"] == arrive["id"]
    assert all(isinstance(event["tid"], int) for event in events)

"""The bridge module in a kernel: off by default, slots, late joiners, replay."""

import gc
import sys
import weakref

import pytest
from bridge_ends import until
from bridge_samples import AMBIENT, BACKGROUND, SAMPLES, SUN, known_array
from bridged_sky import enabling
from zenoh_bridge.connection import Connection
from zenoh_bridge.frames import encode_frame, read_frame, remote_message
from zenoh_bridge.inputs import BridgeState, BridgeTrouble, RemoteMessage
from zenoh_bridge.module import ALONE, NAME, OFF, ZenohBridge
from zenoh_bridge.paced import Paced

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Demand, Fault, RestartModule, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import SunMoved
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import Replay


class Sun(Module):
    """Another module that can hold both slots, and holds them first."""

    manifest = Manifest(name="sun", title="Sun", version="1", provides=("sun", "sky"))


class Viewer(Module):
    """Records the suns that it receives."""

    manifest = Manifest(name="viewer", title="Viewer", version="1")

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.suns = []

    @handles(SunMoved)
    def on_sun(self, message):
        self.suns.append(message)


@pytest.fixture
def kernel():
    """A kernel with a bridge that is enabled but not connected, as in a replay."""
    kernel = Kernel()
    for module in (Sun, Viewer, ZenohBridge):
        kernel.add_module(module)
    kernel.faults = []
    kernel.tap(lambda m, _: kernel.faults.append(m) if isinstance(m, Fault) else None)
    tell(kernel, SetSetting(module=NAME, name="enabled", value=True))
    yield kernel
    kernel.close()


def tell(kernel, *messages):
    for message in messages:
        kernel.inject(message)
        kernel.pump()


def from_afar(message):
    """The input for a message of another process."""
    name = type(message).__name__
    return remote_message(read_frame(encode_frame(message, 2**16), name, 2**16, 2**20), known_array)


def test_a_bridge_that_is_off_does_nothing():
    """There is no session by default, no thread and no fault."""
    kernel = Kernel()
    kernel.add_module(ZenohBridge, inject=kernel.inject)
    tell(kernel, SetSetting(module=NAME, name="share", value="SunMoved"))
    bridge = kernel.seats[NAME].module
    assert bridge.state == OFF
    assert bridge._connection is None
    assert kernel.last(Fault) is None
    assert kernel.last_fault(NAME) is None


def test_a_missing_library_is_reported_but_no_failure(monkeypatch):
    """One sentence says how to install the extra, and the module keeps running."""
    monkeypatch.setitem(sys.modules, "zenoh", None)
    kernel = Kernel()
    kernel.add_module(ZenohBridge, inject=kernel.inject)
    for message in enabling("listen", 7447):
        kernel.inject(message)
    until(lambda: kernel.pump() and kernel.last_fault(NAME), "the sentence")
    fault = kernel.last_fault(NAME)
    assert fault.for_user
    assert "pip install 'vrut-lite[bridge]'" in fault.error
    assert kernel.seats[NAME].running
    assert kernel.seats[NAME].module.state == fault.error


def test_invalid_settings_are_reported(monkeypatch):
    """A remote host is refused before a session is opened."""
    monkeypatch.setattr(Connection, "start", lambda *_: pytest.fail("a session was made"))
    kernel = Kernel()
    kernel.add_module(ZenohBridge, inject=kernel.inject)
    tell(
        kernel,
        SetSetting(module=NAME, name="endpoint", value="tcp/0.0.0.0:7447"),
        SetSetting(module=NAME, name="enabled", value=True),
    )
    assert "set allow_remote to true" in kernel.last_fault(NAME).error
    assert kernel.seats[NAME].running


def test_messages_wait_until_the_bridge_holds_the_slot(kernel):
    """Only a slot's holder posts its messages; after a switch the latest is posted at once."""
    tell(kernel, from_afar(SUN), from_afar(BACKGROUND))
    assert kernel.seats["viewer"].module.suns == []
    assert kernel.seats[NAME].counters.skipped["SunMoved without slot"] == 1
    tell(kernel, ChooseSlot(slot="sun", module=NAME))
    assert kernel.seats["viewer"].module.suns == [SUN]
    assert kernel.last(BackgroundChanged) is None
    tell(kernel, ChooseSlot(slot="sky", module=NAME))
    assert kernel.last(BackgroundChanged) == BACKGROUND
    assert not kernel.faults


def test_messages_without_slot_are_posted_at_once(kernel):
    """Accepted `SceneNeeds` of another process control the sky computed here."""
    needs = SAMPLES[4]
    tell(kernel, from_afar(needs))
    assert kernel.seats[NAME].counters.skipped["SceneNeeds not accepted"] == 1
    tell(kernel, SetSetting(module=NAME, name="accept", value="SceneNeeds"), from_afar(needs))
    assert kernel.last(type(needs)) == needs


def test_a_restart_loses_nothing(kernel):
    """A new instance gets the latest inputs from the kernel."""
    tell(kernel, ChooseSlot(slot="sun", module=NAME), from_afar(SUN), RestartModule(module=NAME))
    tell(kernel, ChooseSlot(slot="sun", module=NAME))
    assert kernel.last(SunMoved) == SUN
    assert not kernel.faults


def test_refusals_are_counted_and_published(kernel):
    """One readable fault, which never suspends the module."""
    for _ in range(5):
        tell(kernel, BridgeTrouble(sentence="a frame was refused", count=3))
    assert kernel.seats[NAME].counters.skipped["bridge trouble"] == 15
    assert kernel.faults[-1].error == "a frame was refused (and 2 more)"
    assert kernel.seats[NAME].running


def test_a_flood_waits_for_its_listener():
    """However many refusals there are, one input waits in the kernel, and no count is lost."""
    told = []
    paced = Paced(told.append)
    for number in range(1000):
        paced.put(BridgeTrouble(sentence=f"trouble {number}"))
    assert len(told) == 1
    paced.heard()
    paced.heard()
    assert [(m.sentence, m.count) for m in told] == [("trouble 0", 1), ("trouble 999", 999)]
    paced.put(BridgeTrouble(sentence="once more"))
    assert told[-1].count == 1


def test_a_disabled_bridge_ignores_inputs(kernel):
    """Inputs that arrive after the bridge was switched off change nothing."""
    tell(kernel, ChooseSlot(slot="sun", module=NAME))
    tell(kernel, SetSetting(module=NAME, name="enabled", value=False))
    tell(kernel, from_afar(SUN), BridgeState(sentence="late", failed=True))
    assert kernel.last(SunMoved) is None
    assert kernel.seats[NAME].module.state == OFF
    assert not kernel.faults


def test_a_journal_with_remote_messages_replays(tmp_path):
    """Received messages are in the journal: the replay posts the same without a connection."""
    kernel = Kernel()
    for module in (Sun, Viewer, ZenohBridge):
        kernel.add_module(module)
    path = tmp_path / "session.mcap"
    with path.open("wb") as stream:
        recorder = Recorder(kernel, stream, full=True)
        tell(kernel, SetSetting(module=NAME, name="enabled", value=True))
        tell(kernel, BridgeState(sentence="listening", peers=1))
        tell(kernel, Demand(consumer=NAME, message="SunMoved", size=4))
        tell(kernel, ChooseSlot(slot="sky", module=NAME))
        tell(kernel, *map(from_afar, (SUN, BACKGROUND, AMBIENT)))
        tell(kernel, BridgeTrouble(sentence="a frame was refused", count=2))
        tell(kernel, ChooseSlot(slot="sun", module=NAME))
        recorder.close()
    replay = Replay(Journal(path), [Sun, Viewer, ZenohBridge])
    outcome = replay.run()
    assert outcome.difference is None
    assert not outcome.by_value
    assert replay.kernel.last(BackgroundChanged) == BACKGROUND
    assert replay.kernel.seats[NAME].module.state == "listening"
    assert replay.kernel.seats[NAME].module._connection is None


def test_a_forged_journal_is_one_clear_line(kernel):
    """A forged RemoteMessage in a journal is refused by the same checks as a frame."""
    tell(kernel, ChooseSlot(slot="sky", module=NAME))
    tell(kernel, RemoteMessage(type_name="BackgroundChanged", fields={"cube": "parrot"}))
    tell(kernel, RemoteMessage(type_name="SetSetting", fields={}))
    assert [fault.for_user for fault in kernel.faults] == [True]
    assert "BackgroundChanged" in kernel.faults[0].error


def test_a_bridge_that_cannot_inject_says_so(kernel):
    """A bridge that is enabled without `inject` reports this in one sentence."""
    assert kernel.seats[NAME].module.state == ALONE


def test_a_dropped_instance_closes_its_session(kernel):
    """After a reload the old instance no longer receives messages."""
    old = weakref.ref(kernel.seats[NAME].module)
    tell(kernel, RestartModule(module=NAME))
    gc.collect()
    assert old() is None

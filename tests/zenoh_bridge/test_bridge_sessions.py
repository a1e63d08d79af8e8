"""Bridges over real sessions on loopback: late joiners, strangers, closing, TLS."""

import random
import shutil
import subprocess

import pytest
from bridge_ends import BridgedKernel, demands, free_port, until
from bridge_samples import ARRAYS, BACKGROUND, CUBE, SAMPLES, SUN, SUN_LIGHT, mangled
from bridged_sky import PRAGUE, clock, enabling
from dynamic_skylight.module import DynamicSkyLight
from test_bridge_frames import refusal
from zenoh_bridge.frames import encode_frame
from zenoh_bridge.module import NAME, OFF, ZenohBridge
from zenoh_bridge.plan import plan_of
from zenoh_bridge.session import BridgeSession
from zenoh_bridge.settings import ZenohBridgeSettings

from vrut_lite.array import Array
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    ChooseSlot,
    ClockMoved,
    Demand,
    EnableModule,
    RestartModule,
    SetSetting,
)
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.sky import BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import Replay

pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed (the extra 'bridge')")


class SampleSky(Module):
    """Posts the samples at each move of the clock, with or without demand."""

    manifest = Manifest(name="sample_sky", title="Sky", version="1", provides=("sun", "sky"))

    @handles(ClockMoved)
    def on_clock(self, message):
        for sample in SAMPLES[:4]:
            self.link.post(sample)


def setting(name, value):
    return SetSetting(module=NAME, name=name, value=value)


def noon():
    return clock(12)


@pytest.fixture
def ends():
    """A function that makes kernels with bridges, which are closed afterwards."""
    made = []

    def make(*modules):
        made.append(BridgedKernel(modules))
        return made[-1]

    yield make
    for end in made:
        end.close()


@pytest.fixture
def stranger():
    """A function that opens a plain Zenoh session at a port."""
    made = []

    def make(port):
        settings = ZenohBridgeSettings(mode="connect", endpoint=f"tcp/127.0.0.1:{port}")
        made.append(BridgeSession(plan_of(settings).config))
        return made[-1]

    yield make
    for session in made:
        session.close()


def refused(end):
    return end.bridge.counters.skipped["bridge trouble"]


def test_a_late_joiner_gets_the_last_values(ends):
    """A late joiner gets the latest messages at once; messages without demand are not sent."""
    port = free_port()
    maker, late = ends(SampleSky), ends()
    maker.open("listen", port)
    maker.inject(noon())
    until(lambda: maker.kernel.last(SunMoved), "the sun")
    late.hold_slots()
    late.demand(8, kinds=[BackgroundChanged, SunMoved])
    late.open("connect", port)
    until(lambda: late.kernel.last(BackgroundChanged) == BACKGROUND, "the background")
    until(lambda: late.kernel.last(SunMoved) == SUN, "the sun")
    maker.inject(noon())
    until(lambda: maker.bridge.counters.done["BackgroundChanged sent"] == 1, "the second noon")
    assert maker.bridge.counters.skipped["KeyLightChanged unwanted there"] == 2
    assert late.kernel.last(KeyLightChanged) is None
    late.demand(8)
    until(lambda: late.kernel.last(KeyLightChanged) == SUN_LIGHT, "the light, wanted now")
    assert maker.bridge.state.endswith("1 process has joined")
    assert not maker.faults + late.faults


def test_a_sky_on_a_card_crosses_as_numbers(ends):
    """A texture cannot leave its GPU: with "auto" on a card, the other process's demand has the
    processor compute the sky."""
    port = free_port()
    maker, viewer = ends(DynamicSkyLight), ends()
    maker.inject(
        RendererTried(renderer="a card", trial_ns=0.1),
        Demand(consumer="gpu", message="GpuJob"),
        PRAGUE,
    )
    maker.open("listen", port)
    maker.inject(noon())
    viewer.hold_slots()
    viewer.demand(8, kinds=[BackgroundChanged])
    viewer.open("connect", port)
    found = until(lambda: viewer.kernel.last(BackgroundChanged), "the background")
    assert isinstance(found.cube, Array)
    assert not maker.faults + viewer.faults


def test_demand_follows_the_slot_and_the_consumers(ends):
    """A process computes for another only what that one's bridge needs for its slots."""
    port = free_port()
    maker, viewer = ends(SampleSky), ends(SampleSky)
    maker.open("listen", port)
    viewer.open("connect", port)
    viewer.demand(64, kinds=[BackgroundChanged])
    until(lambda: "1 process" in viewer.bridge.state, "the other end")
    viewer.hold_slots()
    until(lambda: maker.kernel.wanted(BackgroundChanged), "the demand there")
    viewer.demand(16, consumer="preview", kinds=[BackgroundChanged])
    viewer.demand(0, kinds=[BackgroundChanged])
    until(lambda: maker.kernel.wanted(BackgroundChanged).size == 16, "the smaller demand")
    assert maker.kernel.wanted(BackgroundChanged).consumer == NAME
    viewer.inject(ChooseSlot(slot="sky", module="sample_sky"))
    until(lambda: not maker.kernel.wanted(BackgroundChanged), "the demand taken back")


def attacked(ends, stranger):
    """A listening end that holds the slots, and a stranger connected to it."""
    port = free_port()
    here = ends()
    here.open("listen", port)
    here.hold_slots()
    until(lambda: "listening" in here.bridge.state, "the session")
    return here, stranger(port)


def test_strangers_frames_are_counted_and_harm_nothing(ends, stranger):
    """Each damaged frame is counted and reported; valid ones are posted as before."""
    here, rude = attacked(ends, stranger)
    dice, expected = random.Random(7), 0
    for _ in range(200):
        frame = mangled(encode_frame(SUN, 2**16), dice)
        expected += refusal(frame, "SunMoved") is not None
        rude.put("vrut_lite/say/SunMoved", frame)
    until(lambda: refused(here) == expected, f"{expected} refusals")
    assert all(fault.for_user and "\n" not in fault.error for fault in here.faults)
    assert here.kernel.seats[NAME].running
    rude.put("vrut_lite/say/SunMoved", encode_frame(SUN, 2**16))
    until(lambda: here.kernel.last(SunMoved) == SUN, "the sun")
    rude.put("vrut_lite/say/SetSetting", b"{}")
    rude.put("vrut_lite/say/Fault", b"{}")
    tokens = [rude.show(f"vrut_lite/want/x/{key}") for key in ("a/b", "SunMoved/0/any", "y")]
    until(lambda: refused(here) == expected + len(tokens), "the mangled demands")


def test_demands_of_lost_processes_are_withdrawn(ends, stranger):
    """Also after a crash, and if this end was closed in between."""
    port = free_port()
    here = ends()
    here.open("listen", port)
    until(lambda: "listening" in here.bridge.state, "the session")
    rude = stranger(port)
    token = rude.show("vrut_lite/want/x/SunMoved/7/any")
    until(lambda: here.kernel.wanted(SunMoved), "the demand")
    here.inject(setting("enabled", False))
    until(lambda: not here.kernel.wanted(SunMoved), "nothing wanted while off")
    here.inject(setting("enabled", True))
    until(lambda: here.kernel.wanted(SunMoved), "the demand again")
    here.inject(EnableModule(module=NAME, enabled=False))
    until(lambda: not here.kernel.wanted(SunMoved), "nothing wanted while disabled")
    rude.close()
    here.inject(EnableModule(module=NAME))
    until(lambda: here.bridge and "listening" in here.bridge.state, "the session")
    until(lambda: not here.kernel.wanted(SunMoved), "nothing wanted by nobody")
    assert token is not None
    assert not here.faults


def test_a_recorded_session_replays(ends, tmp_path):
    """The journal of a bridged process replays without the other end."""
    port = free_port()
    maker = ends(SampleSky)
    maker.open("listen", port)
    maker.inject(noon())
    kernel = Kernel()
    kernel.add_module(ZenohBridge, inject=kernel.inject)
    path = tmp_path / "bridged.mcap"
    with path.open("wb") as stream:
        recorder = Recorder(kernel, stream, full=True)
        chosen = [ChooseSlot(slot=slot, module=NAME) for slot in ("sun", "sky")]
        for message in (*chosen, *enabling("connect", port), *demands(8)):
            kernel.inject(message)

        def shown():
            kernel.pump()
            return kernel.last(BackgroundChanged) and kernel.last(SunMoved)

        until(shown, "the background and the sun")
        kernel.inject(setting("enabled", False))
        kernel.pump()
        recorder.close()
    kernel.close()
    replay = Replay(Journal(path), [ZenohBridge])
    outcome = replay.run()
    assert outcome.difference is None
    assert outcome.messages >= 6
    assert replay.kernel.last(BackgroundChanged) == BACKGROUND


@pytest.mark.parametrize(
    ("served", "says"),
    [(None, "nobody had the array"), (b"", "came with 0 bytes"), (b"\0" * 2304, "another content")],
)
def test_missing_arrays_are_reported(ends, stranger, served, says):
    """A background whose array is missing is not posted; a later one may be."""
    here, rude = attacked(ends, stranger)
    answers = {"now": served}
    if served is not None:
        rude.serve("vrut_lite/array/*", lambda query: rude.answer(query, answers["now"]))
    frame = encode_frame(BACKGROUND, 2**16)
    rude.put("vrut_lite/say/BackgroundChanged", frame)
    # The refusal is counted before the fault is published.
    until(lambda: refused(here) == 1 and here.faults, "the trouble")
    assert says in here.faults[0].error
    assert here.kernel.last(BackgroundChanged) is None
    if served is not None:
        answers["now"] = ARRAYS[CUBE.digest].values.tobytes()
        rude.put("vrut_lite/say/BackgroundChanged", frame)
        until(lambda: here.kernel.last(BackgroundChanged) == BACKGROUND, "the background")


def test_a_bridge_releases_its_endpoint(ends):
    """After changed settings, a restart, and switching off the port is free."""
    port = free_port()
    here = ends()
    here.open("listen", port)
    changes = [
        (setting("max_array_mib", 8),),
        (RestartModule(module=NAME),),
        (EnableModule(module=NAME, enabled=False), EnableModule(module=NAME)),
        (setting("enabled", False), setting("enabled", True)),
    ]
    for change in ((), *changes):
        here.inject(*change)
        until(lambda: "listening" in here.bridge.state, f"the session after {change}")
    here.inject(setting("enabled", False))
    until(lambda: here.bridge.state == OFF, "the end")
    assert not here.faults


def test_a_port_in_use_is_reported(ends):
    """One sentence, and the module keeps running."""
    port = free_port()
    first, second = ends(), ends()
    first.open("listen", port)
    until(lambda: "listening" in first.bridge.state, "the first")
    second.open("listen", port)
    until(lambda: second.faults, "the fault")
    assert second.faults[0].for_user
    assert "the bridge could not be opened" in second.faults[0].error
    assert second.kernel.seats[NAME].running


@pytest.fixture(scope="module")
def certificates(tmp_path_factory):
    """Two authorities and a certificate for localhost from each: {authority: settings}."""
    if shutil.which("openssl") is None:
        pytest.skip("openssl is not installed: no certificates to try TLS with")
    folder = tmp_path_factory.mktemp("certificates")
    return {name: _certified(folder, name) for name in ("ours", "theirs")}


def _certified(folder, name):
    ca, ca_key = folder / f"{name}_ca.pem", folder / f"{name}_ca.key"
    own, own_key = folder / f"{name}.pem", folder / f"{name}.key"
    new = ["req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes"]
    _openssl(*new, "-keyout", ca_key, "-out", ca, "-subj", f"/CN={name}", "-days", "30")
    _openssl(
        *new, "-keyout", own_key, "-out", own, "-subj", "/CN=localhost", "-days", "30",
        "-CA", ca, "-CAkey", ca_key, "-addext", "subjectAltName=DNS:localhost",
        "-addext", "basicConstraints=critical,CA:FALSE",
    )  # fmt: skip
    return {"tls_ca": str(ca), "tls_certificate": str(own), "tls_key": str(own_key)}


def _openssl(*arguments):
    subprocess.run(["openssl", *arguments], check=True, capture_output=True)


def test_mutual_tls_accepts_certified_peers_only(ends, certificates):
    """Only peers with a certificate of the same authority are accepted."""
    port = free_port()
    maker, friend, other = ends(SampleSky), ends(), ends()
    for end, name, mode in ((maker, "ours", "listen"), (other, "theirs", "connect"),
                            (friend, "ours", "connect")):  # fmt: skip
        values = {"mode": mode, "endpoint": f"tls/localhost:{port}", **certificates[name]}
        end.hold_slots() if end is not maker else end.inject(noon())
        end.inject(
            *demands(8), *(setting(k, v) for k, v in values.items()), setting("enabled", True)
        )
        until(lambda end=end: " on tls/" in end.bridge.state or " to tls/" in end.bridge.state,
              "a session")  # fmt: skip
    until(lambda: friend.kernel.last(BackgroundChanged) == BACKGROUND, "the friend's background")
    assert maker.bridge.state.endswith("1 process has joined")
    assert other.bridge.state.endswith("no processes have joined")
    assert other.kernel.last(BackgroundChanged) is None

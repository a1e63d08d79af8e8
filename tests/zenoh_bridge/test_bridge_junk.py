"""Junk over the bridge causes a Fault of the bridge, and the host goes on drawing."""

from datetime import UTC, datetime
from pathlib import Path

import msgspec
import numpy as np
import pytest
from bridge_ends import free_port, until
from bridge_samples import AMBIENT, BACKGROUND, NEEDS, SUN, SUN_LIGHT
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_bridge_air import AIR
from zenoh_bridge.connection import Connection
from zenoh_bridge.frames import encode_frame
from zenoh_bridge.module import NAME
from zenoh_bridge.plan import plan_of
from zenoh_bridge.settings import ZenohBridgeSettings
from zenoh_bridge.shareable import SHAREABLE
from zenoh_bridge.worker import Worker

from vrut_lite.array import Array
from vrut_lite.daylight_kernel import FaultCollector
from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    ChooseSlot,
    ClockMoved,
    Demand,
    Fault,
    SetClock,
    SetSetting,
    Tick,
)
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.message_codec import arrays_of, to_plain
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import SpectrumSeen
from vrut_lite.messages.sun import SunMoved

SCENES = Path(__file__).parents[2] / "scenes"
NOON = datetime(2026, 6, 21, 12, tzinfo=UTC)
SPECTRUM = SpectrumSeen(
    direction=(0.0, 1.0, 0.0), wavelength_nm=(500.0, 600.0), radiance=(0.1, 0.2), source="sample"
)
GOOD = (SUN, SUN_LIGHT, BACKGROUND, AMBIENT, AIR, SPECTRUM, NEEDS, ClockMoved(instant=NOON))
PLAN = plan_of(
    ZenohBridgeSettings(accept=",".join(kind.__name__ for kind in SHAREABLE), max_array_mib=1)
)


class Stranger:
    """Delivers frames through the bridge's own receiving code, without a connection."""

    def __init__(self, inject):
        self._connection = Connection(PLAN, inject)

    def say(self, type_name, data, arrays=()):
        connection = self._connection
        connection.troubles.heard()
        for array in arrays:
            connection._arrays.keep(array)
        connection._guarded(connection._heard)(f"vrut_lite/say/{type_name}", data)
        for name, frame in connection._reader._mailbox.take_all().items():
            connection._complete(name, frame)

    def say_all(self, *messages):
        for message in messages:
            frame = encode_frame(message, 2**20)
            self.say(type(message).__name__, frame, arrays_of(message))


@pytest.fixture(scope="module")
def host():
    """A host whose bridge holds sun and sky, without a peer."""
    pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed (the extra 'bridge')")
    from vrut_lite.host import Host

    host = Host(cube_size=16)
    values = {
        "endpoint": f"tcp/127.0.0.1:{free_port()}",
        "accept": ",".join(kind.__name__ for kind in SHAREABLE),
        "enabled": True,
    }
    host.inject(
        Resize(width_px=32, height_px=18),
        SetPlace(latitude_deg=50.0, longitude_deg=14.0),
        SetClock(instant=NOON),
        *(SetSetting(module=NAME, name=name, value=value) for name, value in values.items()),
        ChooseSlot(slot="sun", module=NAME),
        ChooseSlot(slot="sky", module=NAME),
    )
    host.load(str(SCENES / "sundial.glb"))
    host.told = []
    host.kernel.tap(lambda m, _: host.told.append(m) if isinstance(m, Fault) else None)
    host.stranger = Stranger(host.kernel.inject)
    until(lambda: "listening" in settled_state(host), "the session")
    yield host
    host.close()


def settled_state(host):
    host.settle()
    return host.kernel.seats[NAME].module.state


def draws_on(host):
    """Draws a picture; it is finite, and the bridge is still running."""
    picture = host.draw()
    assert np.isfinite(picture.radiance).all()
    assert host.kernel.seats[NAME].running
    assert all(fault.module == NAME and fault.for_user for fault in host.told)
    return picture


ODD_NUMBERS = [
    0.0, -1.0, 1e-300, 1e9, 1e30, -1e30, 1e308, 1e400, -0.5, 5e-324, 2**53, -(2**62), 10**30, 1e-7,
]  # fmt: skip
LEAVES = st.one_of(
    st.sampled_from(ODD_NUMBERS),
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from([None, True, "", "x", "linear-srgb", [], {}, [[]], {"$float": "nan"}]),
    st.sampled_from([{"$array": "0" * 32, "dtype": "<f2", "shape": [6, 4, 4, 3]}, {"$opaque": 1}]),
)
JUNK = st.one_of(
    LEAVES,
    st.lists(LEAVES, max_size=4),
    st.lists(st.floats(-1.5, 1.5), min_size=3, max_size=3),
    st.lists(st.sampled_from(ODD_NUMBERS), min_size=3, max_size=3),
    st.integers(1, 500).map(lambda n: [[1.0] * n] * 3),
    st.integers(1, 7).map(lambda n: [[1e6] * n] * 3),
)


@st.composite
def arrays(draw, like):
    """An array with odd numbers, of the right shape and type or not."""
    shape, kind = like.shape, like.dtype.str
    if draw(st.integers(0, 3)) == 0:
        shape = tuple(draw(st.lists(st.integers(0, 9), max_size=5)))
        kind = draw(st.sampled_from(["<f2", "<f4", "<f8", "|u1", ">f2", "<i8"]))
    values = np.resize(like.values.astype(np.float64).ravel() if like.values.size else 1.0, shape)
    odd = draw(st.sampled_from([np.nan, np.inf, -np.inf, 1e30, -1e30, 6e4, -6e4, 0.0, 1e-8, 1.0]))
    if draw(st.booleans()):
        values = np.full(shape, odd)
    elif values.size:
        values.ravel()[draw(st.integers(0, values.size - 1))] = odd
    with np.errstate(all="ignore"):
        return Array(values.astype(kind))


@st.composite
def frames(draw):
    """A sample's frame with one field changed, and the arrays that can be fetched."""
    message = draw(st.sampled_from(GOOD))
    content = msgspec.json.decode(encode_frame(message, 2**20))
    held, carrier, plain = arrays_of(message), message, content["message"]
    if isinstance(plain.get("volume"), dict) and draw(st.integers(0, 4)):
        carrier, plain = carrier.volume, plain["volume"]
    name = draw(st.sampled_from(sorted(plain)))
    old = getattr(carrier, name, None)
    if isinstance(old, Array) and draw(st.integers(0, 4)):
        held.append(draw(arrays(old)))
        plain[name] = to_plain(held[-1])
    elif isinstance(carrier, AirVolume) and isinstance(old, int) and draw(st.booleans()):
        plain[name] = draw(st.integers(0, 9))
    else:
        plain[name] = draw(JUNK)
    return type(message).__name__, msgspec.json.encode(content), held


@pytest.mark.long
@pytest.mark.gl
@given(st.lists(frames(), min_size=1, max_size=6))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_the_host_draws_after_any_remote_message(host, spoilt):
    """Every type, every field: settle and draw never raise, and what is drawn is finite."""
    host.told.clear()
    host.stranger.say_all(*GOOD)
    for type_name, data, held in spoilt:
        host.stranger.say(type_name, data, held)
        host.settle()
    draws_on(host)


NOT_FRAMES = [
    b"", b"\xff", b"junk", b"null", b"[]", b"{}", b"[" * 5000, b'{"version":1}',
    b'{"version":2,"type_name":"SunMoved","message":{}}',
    b'{"version":1,"type_name":"SunMoved","message":"junk"}',
    b'{"version":1,"type_name":"SunMoved","message":{}}',
    b'{"version":1,"type_name":"Fault","message":{}}',
    b'{"version":1,"type_name":"SunMoved","message":{"direction":' + b"9" * 5000 + b"}}",
]  # fmt: skip


@pytest.mark.gl
def test_junk_is_reported_and_fails_no_command(host):
    """Far more than three faults by junk do not suspend the bridge."""
    host.told.clear()
    host.stranger.say_all(*GOOD)
    before = draws_on(host)
    for data in NOT_FRAMES:
        host.stranger.say("SunMoved", data)
        host.settle()
    assert len(host.told) == len(NOT_FRAMES)
    after = draws_on(host)
    assert np.array_equal(before.display, after.display)


@pytest.mark.gl
@pytest.mark.parametrize(
    ("changed", "says"),
    [
        (msgspec.structs.replace(SUN_LIGHT, limb_darkening_rgb=((1.0,) * 500,) * 3), "1 to 6"),
        (msgspec.structs.replace(SUN_LIGHT, angular_radius_rad=0.0), "angular_radius_rad"),
        (msgspec.structs.replace(SUN_LIGHT, irradiance_rgb=(-1.0, 1.0, 1.0)), "irradiance_rgb"),
        (msgspec.structs.replace(SUN_LIGHT, direction=(0.0, 0.0, 0.0)), "unit vector"),
        (
            msgspec.structs.replace(BACKGROUND, cube=Array(np.full((6, 4, 4, 3), np.nan, "<f2"))),
            "cube of BackgroundChanged must hold numbers",
        ),
        (
            msgspec.structs.replace(AMBIENT, irradiance_sh_rgb=Array(np.full((25, 3), 1e30))),
            "irradiance_sh_rgb of AmbientChanged must hold numbers",
        ),
    ],
)
def test_invalid_fields_are_reported_by_name(host, changed, says):
    """The previous light stays, and the sentence names the invalid field."""
    host.told.clear()
    host.stranger.say_all(*GOOD)
    before = draws_on(host)
    host.stranger.say_all(changed)
    after = draws_on(host)
    assert np.array_equal(before.display, after.display)
    assert len(host.told) == 1
    assert says in host.told[0].error


def test_the_users_own_errors_still_fail_commands():
    """Only faults by received messages are exempt."""

    class Failing(Module):
        manifest = Manifest(name="failing", title="Failing", version="1")

        @handles(Tick)
        @handles(SunMoved)
        def on_any(self, message):
            raise ValueError("own")

    from zenoh_bridge.module import ZenohBridge

    kernel = Kernel()
    faults = FaultCollector(kernel)
    for module in (ZenohBridge, Failing):
        kernel.add_module(module)
    kernel.inject(SetSetting(module=NAME, name="enabled", value=True))
    kernel.inject(ChooseSlot(slot="sun", module=NAME))
    kernel.pump()
    Stranger(kernel.inject).say_all(SUN)
    kernel.pump()
    assert kernel.last(SunMoved) == SUN
    assert kernel.last_fault("failing") is not None
    faults.raise_first()
    kernel.inject(SetPlace(latitude_deg=91.0, longitude_deg=0.0))
    kernel.pump()
    with pytest.raises(UserError, match="latitude_deg"):
        faults.raise_first()
    kernel.inject(Tick(elapsed_s=1.0))
    kernel.pump()
    with pytest.raises(ModuleFailed, match="own"):
        faults.raise_first()


def test_a_worker_survives_a_panic():
    """A library's panic drops only the item that caused it, in every part of the bridge."""

    class Panic(BaseException):
        """Like the panic of a library written in Rust."""

    told, injected = [], []
    connection = Connection(PLAN, injected.append)

    def panic(*_):
        raise Panic("a library panicked")

    connection._guarded(panic)("key", b"")
    assert "Panic: a library panicked" in injected[-1].sentence
    connection.troubles.heard()
    connection._fetch = panic
    connection._complete("BackgroundChanged", None)
    assert "AttributeError" in injected[-1].sentence
    worker = Worker("test", lambda key, item: told.append(item))
    worker.start()
    worker.put("a", 1)
    until(lambda: told, "the item")
    worker.close()
    worker.join(5.0)


def test_remote_demands_are_limited_to_what_can_cross(host):
    """No token makes this process compute a sky that is too large to send."""
    connection = Stranger(host.kernel.inject)._connection
    note = connection._guarded(connection._token)
    for key in ("BackgroundChanged/4096/float32", "BackgroundChanged/9999/any", "Fault/1/any"):
        connection.troubles.heard()
        note(f"vrut_lite/want/x/{key}", True)
        host.settle()
        assert connection._wants.wanted("BackgroundChanged") is None
    note("vrut_lite/want/x/BackgroundChanged/64/float16", True)
    assert isinstance(connection._wants.wanted("BackgroundChanged"), Demand)

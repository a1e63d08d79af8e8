"""The kernel's promises: order, one transaction per input, isolation, slots."""

from typing import Annotated

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from probe_messages import faults_of, sun_at

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import FAULTS_UNTIL_SUSPENSION, POSTS_PER_TRANSACTION, Kernel
from vrut_lite.kernel.messages import (
    ChooseSlot,
    Demand,
    Derived,
    EnableModule,
    Input,
    Message,
    RestartModule,
    SetSetting,
    SlotChanged,
)
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import SunMoved


class Poke(Input, frozen=True, kw_only=True):
    value: int

    def key(self) -> None:
        return None


class Echo(Derived, frozen=True, kw_only=True):
    value: int
    depth: int = 0

    def key(self) -> None:
        return None


class LoudSettings(msgspec.Struct, frozen=True):
    volume: Annotated[float, msgspec.Meta(ge=0, le=11, description="How loud")] = 3.0


class Parrot(Module):
    manifest = Manifest(name="parrot", title="Parrot", version="1", provides=("sun",))
    settings_type = LoudSettings

    @handles(Poke)
    def on_poke(self, message: Poke) -> None:
        if message.value < 0:
            raise ValueError(f"cannot say {message.value}")
        self.link.post(Echo(value=message.value))

    @handles(Echo)
    def on_echo(self, message: Echo) -> None:
        if message.depth < 2:
            self.link.post(Echo(value=message.value, depth=message.depth + 1))


class Listener(Module):
    manifest = Manifest(name="listener", title="Listener", version="1")

    def __init__(self, link, settings, heard):
        super().__init__(link, settings)
        self.heard = heard

    @handles(Poke)
    @handles(Echo)
    def on_any(self, message: Message) -> None:
        self.heard.append(message)


class OtherSun(Module):
    manifest = Manifest(name="other_sun", title="Other sun", version="1", provides=("sun",))

    @handles(SlotChanged)
    def on_slot(self, message: SlotChanged) -> None:
        self.link.post(sun_at(1.0))


def kernel_with(*modules, heard=None):
    kernel = Kernel()
    for module in modules:
        kernel.add_module(module, **({"heard": heard} if module is Listener else {}))
    kernel.pump()
    return kernel


def test_consequences_are_delivered_before_the_next_input():
    """One input is one transaction: all echoes of the first poke come before the second poke."""
    heard = []
    kernel = kernel_with(Parrot, Listener, heard=heard)
    kernel.inject(Poke(value=1))
    kernel.inject(Poke(value=2))
    assert kernel.pump() == 2
    values = [message.value for message in heard]
    assert values == [1] * 4 + [2] * 4


def test_a_pump_of_so_many_leaves_the_others_waiting():
    """Endless inputs do not keep a host from drawing between them."""
    kernel = kernel_with()
    for value in range(3):
        kernel.inject(Poke(value=value))
    assert (kernel.pump(most=2), kernel.waiting) == (2, 1)
    assert (kernel.pump(most=5), kernel.waiting) == (1, 0)


def test_pumping_inside_a_handler_is_refused():
    """A nested transaction would deliver a consequence before its cause is done."""

    class Nester(Module):
        manifest = Manifest(name="nester", title="Nester", version="1")

        @handles(Poke)
        def on_poke(self, message: Poke) -> None:
            kernel.pump()

    kernel = kernel_with(Nester)
    faults = faults_of(kernel)
    kernel.inject(Poke(value=1))
    kernel.pump()
    assert "inside a handler" in faults[0].error


@given(st.lists(st.tuples(st.sampled_from(["volume"]), st.floats(0, 11)), min_size=1, max_size=30))
def test_of_equal_inputs_the_latest_wins(changes):
    """A dragged slider leaves one input waiting, the last: no backlog, no stale value."""
    kernel = kernel_with(Parrot)
    for name, value in changes:
        kernel.inject(SetSetting(module="parrot", name=name, value=value))
    assert kernel.pump() == 1
    assert kernel.seats["parrot"].settings.volume == changes[-1][1]


def test_a_fault_stays_with_its_module():
    """One handler's error neither ends the transaction nor stops later subscribers."""
    heard = []
    kernel = kernel_with(Parrot, Listener, heard=heard)
    faults = faults_of(kernel)
    kernel.inject(Poke(value=-1))
    kernel.pump()
    assert [message.value for message in heard] == [-1]
    assert (faults[0].module, faults[0].where) == ("parrot", "on_poke")
    assert "cannot say -1" in faults[0].trace


def test_the_third_fault_suspends_and_restart_brings_back():
    """A module that keeps failing is silenced after three faults, until someone restarts it."""
    kernel = kernel_with(Parrot)
    faults = faults_of(kernel)
    for _ in range(FAULTS_UNTIL_SUSPENSION + 2):
        kernel.inject(Poke(value=-1))
    kernel.pump()
    assert [fault.suspended for fault in faults] == [False, False, True]
    kernel.inject(RestartModule(module="parrot"))
    kernel.pump()
    assert kernel.seats["parrot"].state == "running"


def test_a_storm_is_cut_by_count_and_named():
    """A module that posts without end is stopped by a count, never by a clock."""

    class Storm(Module):
        manifest = Manifest(name="storm", title="Storm", version="1")

        @handles(Poke)
        @handles(Echo)
        def on_any(self, message: Message) -> None:
            self.link.post(Echo(value=0))

    heard = []
    kernel = kernel_with(Storm, Listener, heard=heard)
    faults = faults_of(kernel)
    kernel.inject(Poke(value=1))
    kernel.pump()
    assert faults[0].module == "storm"
    assert str(POSTS_PER_TRANSACTION) in faults[0].error
    assert len(heard) == POSTS_PER_TRANSACTION + 1


def test_a_failing_holder_gives_its_slot_to_another():
    """The sun must not go out because one module fails: another provider takes the slot."""
    kernel = kernel_with(Parrot, OtherSun)
    assert kernel.slots.holder("sun") == "parrot"
    for _ in range(FAULTS_UNTIL_SUSPENSION):
        kernel.inject(Poke(value=-1))
    kernel.pump()
    assert kernel.slots.holder("sun") == "other_sun"
    assert kernel.last(SunMoved) == sun_at(1.0)


def test_only_the_holder_may_speak_for_a_slot():
    """Two modules that both posted a sun would make the light flicker between them."""

    class Impostor(Parrot):
        manifest = Manifest(name="impostor", title="Impostor", version="1", provides=("sun",))

        @handles(Poke)
        def on_poke(self, message: Poke) -> None:
            self.link.post(sun_at(-1.0))

    kernel = kernel_with(Parrot, Impostor)
    kernel.inject(Poke(value=1))
    kernel.pump()
    assert kernel.last(SunMoved) is None
    assert kernel.seats["impostor"].counters.skipped["post SunMoved without slot"] == 1
    kernel.inject(ChooseSlot(slot="sun", module="impostor"))
    kernel.inject(Poke(value=1))
    kernel.pump()
    assert kernel.last(SunMoved) == sun_at(-1.0)


def test_a_restart_keeps_settings_and_leaves_no_old_instance():
    """Restart means a fresh instance with the same settings; the old one hears nothing more."""
    kernel = kernel_with(Parrot)
    kernel.inject(SetSetting(module="parrot", name="volume", value=7))
    kernel.pump()
    old = kernel.seats["parrot"].module
    kernel.inject(RestartModule(module="parrot"))
    kernel.pump()
    new = kernel.seats["parrot"].module
    assert new is not old
    assert new.settings.volume == 7


def test_a_late_joiner_hears_the_last_value():
    """A module enabled late must know the sun that was told before it came."""

    class SunWatcher(Module):
        manifest = Manifest(name="watcher", title="Watcher", version="1")
        seen = None

        @handles(SunMoved)
        def on_sun(self, message: SunMoved) -> None:
            self.seen = message

    kernel = kernel_with(OtherSun, SunWatcher)
    kernel.inject(EnableModule(module="watcher", enabled=False))
    kernel.pump()
    kernel.inject(EnableModule(module="watcher"))
    kernel.pump()
    assert kernel.seats["watcher"].module.seen == sun_at(1.0)


def test_a_late_joiner_hears_in_the_order_of_delivery():
    """A late joiner must not hear an older fact after its consequence."""
    heard = []

    class Late(Module):
        manifest = Manifest(name="late", title="Late", version="1")

        @handles(SunMoved)
        @handles(SlotChanged)
        @handles(Demand)
        def on_any(self, message: Message) -> None:
            heard.append(type(message))

    kernel = kernel_with(OtherSun, Late)
    kernel.inject(Demand(consumer="a", message="SunMoved"))
    kernel.pump()
    before = list(heard)
    assert before == [SlotChanged, SunMoved, Demand]
    kernel.inject(Demand(consumer="b", message="SunMoved"))
    kernel.inject(RestartModule(module="late"))
    kernel.pump()
    assert heard[4:] == [SlotChanged, SunMoved, Demand, Demand]


def test_a_module_that_is_suspended_hears_nothing_more_of_the_same_message():
    """Suspension holds from the fault on, not from the next message on."""
    calls = []

    class TwoHandlers(Module):
        manifest = Manifest(name="two", title="Two", version="1")

        @handles(Poke)
        def first(self, message: Poke) -> None:
            calls.append("first")
            raise ValueError("as told")

        @handles(Poke)
        def second(self, message: Poke) -> None:
            calls.append("second")

    kernel = kernel_with(TwoHandlers)
    for _ in range(FAULTS_UNTIL_SUSPENSION):
        kernel.inject(Poke(value=1))
    kernel.pump()
    assert calls == ["first", "second"] * (FAULTS_UNTIL_SUSPENSION - 1) + ["first"]


def test_demand_is_the_largest_asked_for():
    """A thumbnail does not need size 1024, and a consumer of 1024 needs more than a thumbnail."""
    kernel = kernel_with(Parrot)
    kernel.inject(Demand(consumer="a", message="SunMoved", size=64))
    kernel.inject(Demand(consumer="b", message="SunMoved", size=256))
    kernel.pump()
    assert kernel.wanted(SunMoved).size == 256
    kernel.inject(Demand(consumer="b", message="SunMoved", size=0))
    kernel.pump()
    assert kernel.wanted(SunMoved).size == 64
    kernel.inject(Demand(consumer="a", message="SunMoved", size=0))
    kernel.pump()
    assert kernel.wanted(SunMoved) is None


@pytest.mark.parametrize("value", [float("nan"), 12, -1, "loud", float("inf"), None, [3]])
def test_a_setting_outside_its_bounds_is_refused_in_one_sentence(value):
    """Bad values never reach a module, and the message says what would be accepted."""
    kernel = kernel_with(Parrot)
    with pytest.raises(UserError, match="volume of parrot must be between 0 and 11") as refusal:
        kernel.check_setting("parrot", "volume", value)
    assert "\n" not in str(refusal.value)


def test_unknown_names_are_told_with_the_known_ones():
    """A misspelt module or setting is mended fastest when the right names are shown."""
    kernel = kernel_with(Parrot)
    with pytest.raises(UserError, match="no module 'parot': installed are parrot"):
        kernel.check_module("parot")
    with pytest.raises(UserError, match="no setting 'volum': it has volume"):
        kernel.check_setting("parrot", "volum", 3)
    with pytest.raises(UserError, match="cannot hold the slot 'sky'"):
        kernel.check_holder("sky", "parrot")


def test_a_module_that_cannot_start_does_not_stop_the_host():
    """An error in a module's constructor suspends it; the others still run."""

    class Stillborn(Module):
        manifest = Manifest(name="stillborn", title="Stillborn", version="1")

        def __init__(self, link, settings):
            raise RuntimeError("no licence")

    heard = []
    kernel = kernel_with(Stillborn, Listener, heard=heard)
    assert kernel.seats["stillborn"].state == "suspended"
    assert "no licence" in kernel.last_fault("stillborn").error
    kernel.inject(Poke(value=1))
    kernel.pump()
    assert len(heard) == 1


PLACE = SetPlace(latitude_deg=50.0, longitude_deg=14.0)
CAMERA = MoveCamera(eye_m=(0.0, 2.0, 0.0), target_m=(0.0, 2.0, -1.0))


@pytest.mark.parametrize(
    ("good", "wrong", "says"),
    [
        (PLACE, {"latitude_deg": 91.0}, "latitude_deg"),
        (PLACE, {"longitude_deg": float("nan")}, "longitude_deg"),
        (PLACE, {"altitude_m": -1e7}, "altitude_m"),
        (PLACE, {"north_offset_rad": 1e9}, "north_offset_rad"),
        (CAMERA, {"eye_m": (0.0, float("nan"), 0.0)}, "finite"),
        (CAMERA, {"target_m": (float("inf"), 0.0, 0.0)}, "finite"),
        (CAMERA, {"target_m": (0.0, 2.0, 0.0)}, "one point"),
        (CAMERA, {"vertical_field_of_view_rad": 0.0}, "between 0 and pi"),
        (CAMERA, {"vertical_field_of_view_rad": float("nan")}, "between 0 and pi"),
    ],
)
def test_invalid_inputs_reach_no_module(good, wrong, says):
    """One bad number must neither suspend the sun's module nor come into every picture."""
    heard = []

    class Watcher(Module):
        manifest = Manifest(name="watcher", title="Watcher", version="1")

        @handles(SetPlace)
        @handles(MoveCamera)
        def on_any(self, message: Message) -> None:
            heard.append(message)

    kernel = kernel_with(Watcher)
    faults = faults_of(kernel)
    for message in (good, msgspec.structs.replace(good, **wrong)):
        kernel.inject(message)
        kernel.pump()
    assert heard == [good]
    assert kernel.last(type(good)) == good
    assert faults[0].for_user
    assert says in faults[0].error

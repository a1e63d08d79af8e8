"""What came before a recording: done again in the replay, or refused in a sentence."""

import io
from typing import Annotated

import msgspec
import pytest

from vrut_lite.errors import UserError
from vrut_lite.kernel import setup_log
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import (
    ChooseSlot,
    Demand,
    Derived,
    EnableModule,
    Input,
    JobResult,
    RestartModule,
    SetSetting,
    SettingChanged,
    Tick,
)
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import rerecord


class Knock(Input, frozen=True, kw_only=True):
    """It has no key, so that the kernel does not remember it."""

    number: int = 0

    def key(self) -> None:
        return None


class Told(Derived, frozen=True, kw_only=True):
    """The state of a module."""

    module: str
    history: tuple[str, ...]

    def key(self) -> None:
        return None


class ClerkSettings(msgspec.Struct, frozen=True):
    level: Annotated[int, msgspec.Meta(ge=0, le=9, description="How much")] = 0
    mood: str = "calm"


def count(number):
    return number


class Clerk(Module):
    """Remembers everything that it hears, in order, and fails at some settings."""

    manifest = Manifest(name="clerk", title="Clerk", version="1", provides=("desk",))
    speaks = (Told,)
    settings_type = ClerkSettings

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.history = []
        if settings.level == 8:
            raise ValueError("cannot begin")
        if settings.level == 7:
            link.start_job("count", count, 7)

    def settings_changed(self, name):
        self.history.append(f"{name} {self.settings.level}")
        if self.settings.level in (1, 2):
            raise ValueError("no")
        if self.settings.level == 6:
            for _ in range(10_001):
                self.link.post(SettingChanged(module="clerk", name="storm", value=0))

    @handles(SettingChanged)
    @handles(Demand)
    @handles(JobResult)
    def on_any(self, message) -> None:
        self.history.append(repr(message))

    @handles(Tick)
    def on_tick(self, message: Tick) -> None:
        name = self.manifest.name
        self.link.post(Told(module=name, history=tuple(self.history)))
        if message.elapsed_s > 1.0:
            raise ValueError("again")

    @handles(Knock)
    def on_knock(self, message: Knock) -> None:
        self.history.append("knock")


class Other(Clerk):
    manifest = Manifest(name="other", title="Other", version="1", provides=("desk",))


MODULES = (Clerk, Other)


def level(value, module="clerk"):
    return SetSetting(module=module, name="level", value=value)


def mood(value):
    return SetSetting(module="clerk", name="mood", value=value)


def kernel_with(*modules):
    kernel = Kernel()
    for module in modules:
        kernel.add_module(module)
    return kernel


def act(kernel, *inputs):
    for message in inputs:
        kernel.inject(message)
        kernel.pump_until_idle()


def replayed(folder, kernel, *inputs):
    """How the replay of these inputs differs, after what was done to the kernel before."""
    stream = io.BytesIO()
    recorder = Recorder(kernel, stream)
    act(kernel, *inputs)
    recorder.close()
    kernel.close()
    path, again = folder / "session.mcap", io.BytesIO()
    path.write_bytes(stream.getvalue())
    outcome = rerecord(Journal(path), again, MODULES)
    assert outcome.difference is not None or again.getvalue() == stream.getvalue()
    return outcome.difference


TICK, FAILING = Tick(elapsed_s=0.5), Tick(elapsed_s=2.0)


@pytest.mark.parametrize(
    ("before", "state"),
    [
        ([level(1), level(2), level(3)], "running"),  # Two faults: one more suspends.
        ([level(1), level(2), level(1)], "suspended"),
        ([level(6)], "suspended"),  # A storm.
        ([level(8), RestartModule(module="clerk")], "running"),  # The old instance goes on.
        ([EnableModule(module="clerk", enabled=False), level(8),
          EnableModule(module="clerk")], "suspended"),
        ([level(1), RestartModule(module="clerk"), level(2)], "running"),
        ([EnableModule(module="clerk", enabled=False)], "disabled"),
        ([level(77), SetSetting(module="nobody", name="level", value=1)], "running"),
    ],
)  # fmt: skip
def test_faults_before_the_recording_count(tmp_path, before, state):
    """A module is suspended in the replay where it was, and not before and not after."""
    kernel = kernel_with(*MODULES)
    act(kernel, *before)
    seat = kernel.seats["clerk"]
    if before[0] != level(8):
        assert seat.state == state
    assert replayed(tmp_path, kernel, TICK, FAILING, TICK, FAILING, TICK) is None


@pytest.mark.parametrize(
    "before",
    [
        [mood("a"), level(3), mood("b"), level(0), mood("calm")],  # Back to what it was.
        [level(4), level(3, "other"), RestartModule(module="clerk")],  # Last values, in order.
        [level(3, "other"), level(4), RestartModule(module="clerk")],
        [Demand(consumer="a", message="Told", size=3), Demand(consumer="b", message="Told"),
         Demand(consumer="a", message="Told", size=0)],
        [ChooseSlot(slot="desk", module="other"), ChooseSlot(slot="desk", module="clerk")],
        [level(7), RestartModule(module="clerk"), level(3)],  # A job's result.
    ],
)  # fmt: skip
def test_a_module_s_state_of_its_set_up_is_repeated(tmp_path, before):
    """Every step is done again, in order: final values would not tell what was heard."""
    kernel = kernel_with(*MODULES)
    act(kernel, *before)
    assert replayed(tmp_path, kernel, TICK, RestartModule(module="clerk"), TICK) is None


def test_a_module_that_came_late_is_late_in_the_replay(tmp_path):
    """It hears last values where others heard all of them."""
    kernel = kernel_with(Clerk)
    act(kernel, level(3), level(4))
    kernel.add_module(Other)
    kernel.pump()
    act(kernel, mood("b"))
    assert replayed(tmp_path, kernel, TICK) is None


class Owner(Module):
    """Demands messages by itself, like the runner of GPU jobs."""

    manifest = Manifest(name="owner", title="Owner", version="1")

    def __init__(self, link, settings):
        super().__init__(link, settings)
        link.demand(Told, size=5)


class StandIn(Module):
    manifest = Owner.manifest


class Asked(Clerk):
    manifest = Manifest(name="asked", title="Asked", version="1")

    @handles(Tick)
    def on_tick(self, message: Tick) -> None:
        wish = self.link.wanted(Told)
        self.link.post(Told(module="asked", history=(wish.consumer, str(wish.size))))


def test_a_stand_in_repeats_the_module_s_demands(tmp_path):
    """Or a sky that was asked of the GPU would be made by the CPU in the replay."""
    kernel, stream = kernel_with(Owner, Asked), io.BytesIO()
    recorder = Recorder(kernel, stream)
    act(kernel, TICK)
    recorder.close()
    path = tmp_path / "session.mcap"
    path.write_bytes(stream.getvalue())
    outcome = rerecord(Journal(path), io.BytesIO(), [StandIn, Asked])
    assert (outcome.difference, outcome.messages) == (None, 1)


class Chooser(Module):
    """Tells which renderer was tried."""

    manifest = Manifest(name="chooser", title="Chooser", version="1")
    speaks = (Told,)

    @handles(Tick)
    def on_tick(self, message: Tick) -> None:
        tried = self.link.last(RendererTried)
        self.link.post(Told(module="chooser", history=(str(tried),)))


def test_a_renderer_that_was_tried_before_is_in_the_set_up(tmp_path):
    """A host tries it at its start: "auto" must choose the same in a replay without that card."""
    kernel, stream = kernel_with(Chooser), io.BytesIO()
    act(kernel, RendererTried(renderer="a card", trial_ns=0.1))
    recorder = Recorder(kernel, stream)
    act(kernel, TICK)
    recorder.close()
    path = tmp_path / "session.mcap"
    path.write_bytes(stream.getvalue())
    assert "a card" in str([e.message for e in Journal(path).entries() if e.type_name == "Told"])
    outcome = rerecord(Journal(path), io.BytesIO(), [Chooser])
    assert (outcome.difference, outcome.messages) == (None, 1)


def test_a_job_that_runs_when_the_recording_begins_is_done_in_the_replay(tmp_path):
    """It was begun before and its result is admitted after."""
    kernel = kernel_with(*MODULES)
    act(kernel, level(7))
    kernel.inject(RestartModule(module="clerk"))
    assert replayed(tmp_path, kernel, TICK, TICK) is None


@pytest.mark.parametrize(
    "message",
    [Knock(), Tick(elapsed_s=1.0), JobResult(module="clerk", job="count", value=3)],
)
def test_what_a_setup_does_not_hold_is_refused(message):
    """Also inputs that the kernel does not remember: a module may."""
    kernel = kernel_with(*MODULES)
    act(kernel, message)
    with pytest.raises(UserError, match=f"a {type(message).__name__} has been admitted: start a"):
        Recorder(kernel, io.BytesIO())


def test_a_setup_does_not_grow_without_end(monkeypatch):
    """A recording after a day of slider moves is refused with a sentence."""
    monkeypatch.setattr(setup_log, "MOST_STEPS", 20)
    kernel = kernel_with(*MODULES)
    act(kernel, *(mood(str(number)) for number in range(30)))
    assert kernel.beginning.steps == []
    with pytest.raises(UserError, match="more than 20 settings and choices have been admitted"):
        Recorder(kernel, io.BytesIO())


def test_a_module_that_is_added_to_a_recording_ends_it():
    """The journal could not tell of it, and its replay would lack the module."""
    kernel = kernel_with(Clerk)
    recorder = Recorder(kernel, io.BytesIO())
    act(kernel, TICK)
    kernel.add_module(Other)
    act(kernel, TICK)
    with pytest.raises(UserError, match="the module other was added after the recording began"):
        recorder.close()

"""Messages are kept as they were delivered."""

import copy
from collections import namedtuple
from dataclasses import dataclass, field

import msgspec
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.app.engine.flight_recorder import FlightRecorder
from vrut_lite.array import Array
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import SettingChanged, Tick
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.message_codec import to_plain
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.sun import SunMoved
from vrut_lite.recording.frozen_copy import frozen_copy
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.replay import Replay

Pair = namedtuple("Pair", "left right")


class Open(msgspec.Struct):
    """A structure that is not frozen."""

    values: list
    size: float = 1


@dataclass
class Box:
    content: list = field(default_factory=list)


def spoil(value):
    """Change everything in a value that can be changed."""
    match value:
        case list():
            for item in value:
                spoil(item)
            value.append("spoilt")
        case dict():
            for item in value.values():
                spoil(item)
            value["spoilt"] = True
        case tuple():
            for item in value:
                spoil(item)
        case np.ndarray():
            value[...] = 77
        case Open():
            spoil(value.values)
            value.size = -1
        case Box():
            spoil(value.content)
            value.content = None


ATOMS = st.none() | st.booleans() | st.integers(-9, 9) | st.floats(-9, 9) | st.text(max_size=3)
VALUES = st.recursive(
    ATOMS | st.builds(lambda n: np.arange(float(n)), st.integers(1, 4)),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.lists(inner, max_size=3).map(tuple)
        | st.dictionaries(st.text(max_size=2), inner, max_size=3)
        | st.builds(Pair, inner, inner)
        | st.builds(Open, values=st.lists(inner, max_size=2))
        | st.builds(Box, st.lists(inner, max_size=2))
    ),
    max_leaves=8,
)


@given(VALUES)
def test_later_changes_change_no_record(value):
    """A journal says the same of the message then and of the one that was kept, later."""
    message = SettingChanged(module="m", name="x", value=value)
    then = copy.deepcopy(to_plain(message))
    kept = frozen_copy(message)
    assert to_plain(kept) == then
    spoil(value)
    assert to_plain(kept) == then


def test_what_cannot_change_is_shared():
    """The usual messages are not copied: their tuples and arrays are theirs for ever."""
    sun = SunMoved(
        direction=(0.0, 1.0, 0.0),
        azimuth_rad=0.0,
        elevation_rad=1.0,
        apparent_elevation_rad=1.0,
        visible_disc_fraction=1.0,
    )
    cube = SettingChanged(module="m", name="x", value=(Array(np.zeros(3)), ("a", (1, 2.5))))
    assert frozen_copy(sun) is sun
    assert frozen_copy(cube) is cube


def test_a_description_does_not_keep_its_texture():
    """Unused texels are freed, also before the journal is written."""
    texture = GpuTexture(size=4, format="rgba16f", recipe="ab").holding(object())
    kept = frozen_copy(SettingChanged(module="m", name="x", value=texture))
    assert to_plain(kept.value) == to_plain(texture)
    assert not isinstance(kept.value, GpuTexture)


class Meddler(Module):
    """Changes what it posted before it is delivered, when it hears it, and after."""

    manifest = Manifest(name="meddler", title="Meddler", version="1")

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.last = {"list": [], "array": np.zeros(2)}

    @handles(Tick)
    def on_tick(self, message: Tick) -> None:
        self.last["list"].append("late")
        self.last["array"][:] += 1.0
        self.last = {"list": [1, {"deep": [2]}], "array": np.zeros(2)}
        self.link.post(SettingChanged(module="meddler", name="x", value=self.last))
        self.last["list"][1]["deep"].append("before")

    @handles(SettingChanged)
    def on_changed(self, message: SettingChanged) -> None:
        spoil(message.value)


class Nest(Module):
    """Says something that contains itself."""

    manifest = Manifest(name="nest", title="Nest", version="1")

    @handles(Tick)
    def on_tick(self, message: Tick) -> None:
        endless: list = []
        endless.append(endless)
        self.link.post(SettingChanged(module="nest", name="x", value=endless))


def flown(module, path, ticks):
    kernel = Kernel()
    kernel.add_module(module)
    recorder = FlightRecorder(kernel)
    for _ in range(ticks):
        kernel.inject(Tick(elapsed_s=1.0))
        assert kernel.pump() == 1
    recorded = recorder.save(path).result()
    recorder.close()
    return recorded


def test_the_windows_journal_holds_what_was_delivered(tmp_path):
    """Its thread makes entries long after a handler has changed what it heard."""
    recorded = flown(Meddler, tmp_path / "j.mcap", 200)
    assert recorded.messages == 200
    journal = Journal(tmp_path / "j.mcap")
    said = [entry.message["value"] for entry in journal.entries() if entry.kind == "derived"]
    assert {repr(value["list"]) for value in said} == {"[1, {'deep': [2, 'before']}]"}
    assert {repr(value["array"]["sample"]) for value in said} == {"[0.0, 0.0]"}
    assert Replay(journal, [Meddler]).run().difference is None


def test_endless_nesting_ends_the_recording_and_not_the_session(tmp_path):
    """The kernel's thread looks at the message now, and must not die of it."""
    recorded = flown(Nest, tmp_path / "j.mcap", 3)
    assert recorded.ended.startswith("recording ended at a SettingChanged: ")
    assert recorded.inputs == 1

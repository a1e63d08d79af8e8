"""What was recorded replays to the byte; what differs, or cannot be replayed, is named."""

import io

import msgspec
import numpy as np
import pytest
from journal_toys import TOYS, Parrot, Poke, record_inputs, toy_kernel

from vrut_lite import __version__
from vrut_lite.array import Array
from vrut_lite.daylight_kernel import daylight_kernel, demand_light
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import (
    Demand,
    EnableModule,
    Input,
    JobResult,
    SetClockRate,
    SetSetting,
    Tick,
)
from vrut_lite.kernel.module import Manifest, handles
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.place import SetPlace
from vrut_lite.recording import registry
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import Replay, rerecord


def saved(folder, data, name="journal.mcap"):
    path = folder / name
    path.write_bytes(data)
    return path


def replayed(path):
    """The bytes of a journal's replay, recorded anew, and the outcome."""
    stream = io.BytesIO()
    outcome = rerecord(Journal(path), stream, TOYS)
    return stream.getvalue(), outcome


def test_a_whole_number_in_a_field_of_floats_is_what_will_be_read(tmp_path):
    """A journal holds 1.0 where 1 was given, or its replay would not be equal to the byte."""
    live = record_inputs([SetPlace(latitude_deg=50, longitude_deg=14), Tick(elapsed_s=1)])
    again, _ = replayed(saved(tmp_path, live))
    assert again == live


FOREIGN = JobResult(module="parrot", job="gpu", value=Array(np.arange(3.0)))
EMPTY = JobResult(module="parrot", job="gpu", value=Array(np.zeros((0, 3))))


def test_a_result_from_elsewhere_is_read_from_a_full_journal(tmp_path):
    """Results of the GPU's owner are no jobs of the kernel, so the journal holds them."""
    live = record_inputs([FOREIGN, EMPTY, Poke(value=0.3)], full=True)
    again, outcome = replayed(saved(tmp_path, live))
    assert outcome.difference is None
    assert again == live


def test_a_light_journal_says_that_it_lacks_the_result(tmp_path):
    """One sentence with the way out."""
    path = saved(tmp_path, record_inputs([FOREIGN]))
    with pytest.raises(UserError, match=r"message 0: JobResult: .* record it with --full"):
        replayed(path)


class Hoarse(Parrot):
    """A parrot of a later version, that says something else above a value."""

    @handles(Poke)
    def on_poke(self, message):
        super().on_poke(Poke(value=min(message.value, 0.25)))


def test_the_first_message_that_differs_is_named(tmp_path):
    """Number, cause, type, sender, and how: enough to look it up in a dump."""
    path = saved(tmp_path, record_inputs([Poke(value=0.2), Poke(value=0.55), Poke(value=0.56)]))
    modules = [Hoarse, *TOYS[1:]]
    outcome = Replay(Journal(path), modules).run()
    assert outcome.difference.startswith("message ")
    assert "after input 1 (Poke), Echo from parrot: value is 0.25 here and 0.55 in the journal" in (
        outcome.difference
    )


def test_a_message_that_is_missing_is_named(tmp_path):
    """A module that says less than it did."""

    class Mute(Parrot):
        @handles(Poke)
        def on_poke(self, message):
            pass

    off = EnableModule(module="other_sun", enabled=False)
    path = saved(tmp_path, record_inputs([off, Poke(value=0.2)]))
    outcome = Replay(Journal(path), [Mute, *TOYS[1:]]).run()
    assert "Echo from parrot, is in the journal and not here" in outcome.difference


def test_another_version_of_a_module_is_compared_by_value(tmp_path):
    """Digests bind one set of versions; the outcome says which version was which."""

    class Newer(Parrot):
        manifest = Manifest(name="parrot", title="Parrot", version="2", provides=("sun",))

    path = saved(tmp_path, record_inputs([Poke(value=0.2)]))
    outcome = Replay(Journal(path), [Newer, *TOYS[1:]]).run()
    assert outcome.signature_differences == ("module parrot 1 there, 2 here",)
    assert outcome.difference is None


def test_settings_and_slots_at_the_start_are_restored(tmp_path):
    """A recording begins with what the user had set before."""
    stream = io.BytesIO()
    kernel = toy_kernel()
    kernel.inject(SetSetting(module="parrot", name="volume", value=5))
    kernel.pump()
    recorder = Recorder(kernel, stream)
    kernel.inject(Poke(value=0.4))
    kernel.pump()
    recorder.close()
    journal = Journal(saved(tmp_path, stream.getvalue()))
    assert journal.setup.modules[0].settings == {"volume": 5.0, "tone": "low"}
    assert Replay(journal, TOYS).run().difference is None


def test_a_module_that_is_missing_is_named(tmp_path):
    """A journal of a module that is not installed cannot be replayed."""
    path = saved(tmp_path, record_inputs([Poke(value=0.2)]))
    with pytest.raises(UserError, match="needs the module other_sun 1: install it"):
        Replay(Journal(path), TOYS[:2])


def test_an_input_that_changed_names_message_and_field(tmp_path, monkeypatch):
    """A journal of an older version tells what changed instead of a traceback."""
    path = saved(tmp_path, record_inputs([SetPlace(latitude_deg=50, longitude_deg=14)]))
    newer = msgspec.defstruct(
        "SetPlace",
        [("latitude_rad", float), ("longitude_rad", float)],
        bases=(Input,),
        frozen=True,
        kw_only=True,
    )
    monkeypatch.setattr(registry, "DAYLIGHT_MESSAGES", (newer,))
    replay = Replay(Journal(path), TOYS)
    with pytest.raises(UserError, match="message 0: SetPlace has no field 'latitude_deg'") as told:
        replay.run()
    assert f"written by vrut_lite {__version__}" in str(told.value)


def test_recording_begins_on_a_fresh_kernel():
    """A module's memory of earlier inputs cannot be recorded."""
    kernel = toy_kernel()
    kernel.inject(SetClockRate(rate=2.0))
    kernel.pump()
    with pytest.raises(UserError, match="a SetClockRate has been admitted"):
        Recorder(kernel, io.BytesIO())


def test_an_unrecordable_message_ends_the_recording_and_not_the_session():
    """`close` reports a number that no journal holds; the kernel goes on."""
    kernel = toy_kernel()
    recorder = Recorder(kernel, io.BytesIO())
    kernel.inject(Demand(consumer="c", message="Echo", size=10**30))
    kernel.inject(Poke(value=0.5))
    assert kernel.pump() == 2
    with pytest.raises(UserError, match="recorded at a Demand: Demand: a whole number has more"):
        recorder.close()


def test_what_the_kernel_refuses_is_recorded_as_refused(tmp_path):
    """A slip of the user is no end of a recording: the replay refuses it with the same words."""
    slips = [
        SetPlace(latitude_deg=91.0, longitude_deg=0.0),
        Resize(width_px=0, height_px=10),
        Demand(consumer="c", message="Echo", size=10**9),
        SetSetting(module="parrot", name="volume", value=[1]),
        Tick(elapsed_s=float("nan")),
    ]
    path = saved(tmp_path, record_inputs([*slips, Poke(value=0.5)]))
    assert replayed(path)[1].difference is None
    said = [e.message["error"] for e in Journal(path).entries() if e.type_name == "Fault"]
    assert [text[:24] for text in said[:5]] == [
        "latitude_deg of a place ", "width_px of Resize must ", "size of Demand must be a",
        "SetSetting: a setting's ", "a tick must be of 0 s or",
    ]  # fmt: skip


def test_a_full_disk_ends_the_recording_and_not_the_session():
    """An error of the file is no error of the module whose message was to be written."""

    class FullDisk(io.BytesIO):
        full = False

        def write(self, data):
            if self.full:
                raise OSError(28, "No space left on device")
            return super().write(data)

    kernel, disk = toy_kernel(), FullDisk()
    recorder = Recorder(kernel, disk, full=True)
    disk.full = True
    kernel.inject(Poke(value=0.5))
    assert kernel.pump() == 1
    assert kernel.last_fault("parrot") is None
    with pytest.raises(UserError, match="No space left on device"):
        recorder.close()


def test_a_journal_of_any_daylight_replays_without_naming_modules(tmp_path):
    """Whoever gets a journal from somebody else has the installed modules and the host's own."""
    path = tmp_path / "noon.mcap"
    kernel, _ = daylight_kernel()
    with path.open("wb") as stream:
        recorder = Recorder(kernel, stream)
        demand_light(kernel, "test", 16)
        kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.0))
        kernel.pump_until_idle()
        recorder.close()
    kernel.close()
    assert Replay(Journal(path)).run().difference is None

"""Journal files: readable by others, equal for equal sessions, and safe from strangers."""

import io
import random
import resource

import mcap.reader
import msgspec
import numpy as np
import pytest
import zstandard
from journal_toys import TOYS, Poke, record_inputs
from mangling import (
    flip,
    forge_bytes,
    forge_content,
    forge_records,
    forged,
    opened,
    truncate,
)
from mcap.writer import CompressionType, Writer

from vrut_lite import message_codec
from vrut_lite.app.engine.message_rows import open_journal
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import ChooseSlot, SetSetting
from vrut_lite.recording import limits
from vrut_lite.recording.entry import Setup
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.journal_writer import FORMAT, METADATA
from vrut_lite.recording.lines import dump_lines, read_inputs
from vrut_lite.recording.registry import Registry
from vrut_lite.recording.replay import Replay, rerecord

SCRIPT = [
    Poke(value=0.3),
    SetSetting(module="parrot", name="volume", value=7),
    Poke(value=0.1),
    Poke(value=0.7),
    ChooseSlot(slot="sun", module="other_sun"),
    Poke(value=0.95),
]


@pytest.fixture(scope="module")
def light():
    return record_inputs(SCRIPT)


@pytest.fixture(scope="module")
def full():
    return record_inputs(SCRIPT, full=True)


@pytest.fixture
def saved(tmp_path):
    def save(data):
        path = tmp_path / "journal.mcap"
        path.write_bytes(data)
        return path

    return save


def test_equal_sessions_make_equal_bytes(light, full):
    """No wall time, no address, no hash order may enter the file."""
    assert record_inputs(SCRIPT) == light
    assert record_inputs(SCRIPT, full=True) == full


def test_other_programs_can_read_it(light):
    """mcap's own reader finds a JSON-schema channel for each type, and times that ascend."""
    reader = mcap.reader.make_reader(io.BytesIO(light), validate_crcs=True)
    found = list(reader.iter_messages())
    assert {schema.encoding for schema, _, _ in found} == {"jsonschema"}
    assert found[0][1].topic == "/input/Poke"
    assert [message.log_time for _, _, message in found] == list(range(len(found)))
    for schema, _, message in found:
        described = msgspec.json.decode(schema.data)["properties"]["message"]["properties"]
        said = msgspec.json.decode(message.data)["message"]
        assert set(said) <= set(described)


def test_a_light_journal_is_small(light, full):
    """A few kB fit in git; arrays are in the full one only."""
    assert len(light) < 12_000
    light_reader = mcap.reader.make_reader(io.BytesIO(light))
    assert list(light_reader.iter_attachments()) == []
    full_reader = mcap.reader.make_reader(io.BytesIO(full))
    assert list(full_reader.iter_attachments())


def test_a_full_journal_holds_every_array_by_its_content(saved, full):
    """An array is found by its digest, with its type and shape, and is what was said."""
    journal = Journal(saved(full))
    echo = next(entry for entry in journal.entries() if entry.type_name == "Echo")
    wave = journal.array(echo.message["wave"])
    expected = np.exp(0.3 * np.linspace(0.0, 3.0, 100)).astype(np.float32)
    np.testing.assert_array_equal(wave.values, expected)


def test_an_array_that_was_exchanged_is_refused(saved, full):
    """The name of an attachment is a promise about its content."""
    journal = Journal(saved(full))
    handles = [e.message["wave"] for e in journal.entries() if e.type_name == "Echo"]
    journal.array(handles[0])
    first = handles[0]["$array"]
    other = next(h["$array"] for h in handles if h["shape"] == [100] and h["$array"] != first)
    parts = opened(full)
    contents = dict(parts.arrays)
    parts.arrays = list((contents | {first: contents[other]}).items())
    journal = Journal(saved(forged(parts)))
    with pytest.raises(UserError, match="another content than its name says"):
        journal.array(handles[0])


@pytest.mark.parametrize(
    "change", [{"dtype": "O"}, {"dtype": "<f9"}, {"shape": [-1]}, {"shape": 4}]
)
def test_an_array_of_an_odd_type_is_refused(saved, full, change):
    """An array of objects would be a door for code; a shape that is none, a crash."""
    journal = Journal(saved(full))
    echo = next(entry for entry in journal.entries() if entry.type_name == "Echo")
    with pytest.raises(UserError, match="cannot read the journal"):
        journal.array(echo.message["wave"] | change)


@pytest.mark.parametrize(
    ("content", "says"),
    [(b"", "no journal"), (b"RIFF" * 100, "no journal"), (b"\x89MCAP0\r\n", "cut short")],
)
def test_files_that_are_no_journal(saved, content, says):
    """An empty file, another format, and the first bytes of one."""
    with pytest.raises(UserError, match=says):
        Journal(saved(content))


def test_a_missing_journal(tmp_path):
    """The most common slip."""
    with pytest.raises(UserError, match="cannot open the journal"):
        Journal(tmp_path / "none.mcap")


def test_a_file_that_is_too_large(saved, monkeypatch, light):
    """Nothing is read of a file beyond the limit."""
    monkeypatch.setattr("vrut_lite.recording.journal_reader.FILE_BYTES", 100)
    with pytest.raises(UserError, match="larger than 100 bytes"):
        Journal(saved(light))


def written(chunk=None, schema=b"{}", data=None):
    """An MCAP file with a journal's metadata, made by hand."""
    stream = io.BytesIO()
    writer = Writer(stream, compression=CompressionType.ZSTD, enable_data_crcs=True)
    writer.start(profile="vrut_lite", library="by hand")
    setup = msgspec.json.encode(Setup(modules=[], slots={})).decode()
    facts = {"format": FORMAT, "full": "false", "signature": "{}", "setup": setup}
    writer.add_metadata(METADATA, facts)
    channel = writer.register_channel(
        "/input/Poke", "json", writer.register_schema("Poke", "jsonschema", schema)
    )
    writer.add_message(channel, 0, data if data is not None else b"{}", 0)
    writer.finish()
    return stream.getvalue()


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"not json", "malformed"),
        (b'{"sender": "", "digest": "", "message": {"a": ' + b"[" * 50_000, "recursion"),
        (b'{"sender": "host", "digest": "00", "message": {"value": 1.0}}', "its own digest"),
        (b"0" * (message_codec.MESSAGE_BYTES + 1), "larger than"),
    ],
)
def test_invalid_messages_in_a_journal(saved, data, says):
    """Each is refused in a sentence, the deep one without a crash."""
    journal = Journal(saved(written(data=data)))
    with pytest.raises(UserError, match=says):
        list(journal.entries())


def test_a_chunk_that_unpacks_to_gigabytes(saved, monkeypatch):
    """zstandard allocates what a frame claims: the claim is compared with what is said of it."""
    bomb = zstandard.compress(bytes(limits.CHUNK_BYTES + 1))
    assert len(bomb) < 2_000
    monkeypatch.setattr("mcap.writer.zstandard.compress", lambda data: bomb)
    journal = Journal(saved(written()))
    monkeypatch.undo()
    with pytest.raises(UserError, match="another size than is said of it"):
        list(journal.entries())


def attempt(path):
    """Replay a journal: 'equal', 'differs', or the sentence of the refusal."""
    try:
        outcome = Replay(Journal(path), TOYS).run()
    except UserError as error:
        return str(error)
    return "equal" if outcome.difference is None else "differs"


def attempt_all(path):
    """What else reads journals: each reads it, or refuses it in a sentence that can be shown."""
    for read in (
        lambda: Replay(Journal(path), TOYS).run(to_the_end=True).difference or "",
        lambda: rerecord(Journal(path), io.BytesIO(), TOYS).difference or "",
        lambda: "".join(str(len(row.fields)) for row in open_journal(path).rows),
        lambda: dump_and_read(path),
    ):
        try:
            said = read()
        except UserError as error:
            said = str(error)
        assert said.isprintable()
        assert len(said) < 3000


def dump_and_read(path):
    """A journal's lines as a script of inputs."""
    script = path.with_suffix(".jsonl")
    script.write_text("\n".join(dump_lines(Journal(path))), encoding="utf-8")
    read_inputs(script, Registry(TOYS))
    return ""


@pytest.mark.parametrize("spoil", [flip, truncate])
def test_a_spoilt_journal_is_refused_in_one_sentence(saved, spoil, light):
    """100 each, seeded: every one is told by a checksum, before anything is decoded."""
    for seed in range(100):
        said = attempt(saved(spoil(light, random.Random(seed))))
        assert said.startswith("cannot read the journal"), (seed, said)
        assert "\n" not in said


@pytest.mark.parametrize(
    ("forgery", "count"), [(forge_bytes, 50), (forge_content, 100), (forge_records, 50)]
)
def test_a_forged_journal_is_refused_or_replayed(saved, full, forgery, count):
    """A forged journal with correct checksums is refused or compared, in little memory."""
    before_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    said = [attempt(saved(forgery(full, random.Random(seed)))) for seed in range(count)]
    assert all("\n" not in sentence for sentence in said)
    assert len(set(said)) > 5
    grown_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb
    assert grown_kb < 200_000


def test_every_reader_of_a_forged_journal_prints_one_line(saved, full):
    """Replays to the end, new recordings, the window's list, and dumps that are played again."""
    for seed in range(1000, 1050):
        attempt_all(saved(forge_records(full, random.Random(seed))))

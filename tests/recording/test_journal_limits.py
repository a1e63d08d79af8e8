"""Limits of a hostile journal: sizes are counted first, and everything is read once."""

import gc
import io
import random
import tracemalloc

import msgspec
import numpy as np
import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st
from journal_toys import TOYS, Poke, record_inputs, toy_kernel
from mangling import Parts, forged, nested, opened, sealed

from vrut_lite import message_codec
from vrut_lite.app.engine.message_rows import open_journal
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import JobResult
from vrut_lite.recording import limits
from vrut_lite.recording.entry import Setup
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.journal_writer import JournalWriter
from vrut_lite.recording.lines import dump_lines, read_inputs
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.registry import Registry
from vrut_lite.recording.replay import Replay, transactions

FACTS = opened(record_inputs([Poke(value=0.3)])).facts
MIB = 2**20


@pytest.fixture
def saved(tmp_path):
    def save(messages, arrays=(), facts=FACTS, **more):
        path = tmp_path / "journal.mcap"
        path.write_bytes(forged(Parts(dict(facts), list(arrays), messages, **more)))
        return path

    return save


@pytest.fixture
def unpackings(monkeypatch):
    """Sizes of what zstandard unpacks, one by one."""
    sizes = []
    unpack = zstandard.decompress

    def counting(data):
        unpacked = unpack(data)
        sizes.append(len(unpacked))
        return unpacked

    monkeypatch.setattr("vrut_lite.recording.contents.zstandard.decompress", counting)
    return sizes


def entry(kind, type_name, message, sender="host"):
    body = {"sender": sender, "digest": "", "message": message}
    return (f"/{kind}/{type_name}", sealed(type_name, body))


def result(value):
    fields = {"module": "parrot", "job": "think", "value": value, "error": "", "for_user": False}
    return entry("input", "JobResult", fields)


def fault(where):
    return entry("derived", "Fault", {"module": "m", "where": where, "error": ""})


def handle(array):
    shape = list(array.shape)
    return {"$array": array.digest, "dtype": array.dtype.str, "shape": shape, "sample": []}


def packed(array):
    return (array.digest, zstandard.compress(array.values.tobytes()))


POKE = entry("input", "Poke", {"value": 0.3})


def test_an_array_is_unpacked_once_however_often_it_is_referred_to(saved, unpackings):
    """5,000 handles in five messages, of 4 MiB: 20 GB if each had a copy."""
    array = Array(np.arange(MIB, dtype=np.float32))
    path = saved([result([handle(array)] * 1000)] * 5, [packed(array)])
    Replay(Journal(path), TOYS).run(to_the_end=True)
    assert unpackings.count(4 * MIB) == 1


def test_arrays_count_before_they_are_unpacked(saved, unpackings, monkeypatch):
    """The declared sizes are added up when the journal is opened."""
    arrays = [Array(np.full(MIB, i, np.float32)) for i in range(5)]
    path = saved([result([handle(array) for array in arrays])], [packed(a) for a in arrays])
    monkeypatch.setenv("VRUT_LITE_MEMORY_GIB", str(18 / 1024))
    with pytest.raises(UserError, match="unpacked are 20 MiB, and 18 MiB is the limit: set VRUT"):
        Journal(path)
    assert not unpackings
    monkeypatch.setenv("VRUT_LITE_MEMORY_GIB", str(22 / 1024))
    assert Journal(path).array(handle(arrays[3])) == arrays[3]


def test_a_handle_does_not_make_an_array_larger_than_its_bytes(saved, unpackings):
    """Shape and type are compared with the packed size before it is unpacked."""
    array = Array(np.zeros(MIB, np.float32))
    journal = Journal(saved([POKE], [packed(array)]))
    for change in ({"shape": [2**62, 2**62]}, {"shape": [MIB, 0]}, {"shape": [1] * 99}):
        with pytest.raises(UserError, match=r"does not fill its shape|shape is \["):
            journal.array(handle(array) | change)
    assert not unpackings


def test_messages_that_unpack_to_no_sessions_size_are_not_unpacked(saved, unpackings):
    """100 MB of one letter from some kB: the sizes of chunks say so."""
    path = saved([POKE, *[fault("y" * 900_000)] * 100])
    with pytest.raises(UserError, match=r"its messages unpack to .* MiB, more than 200 times"):
        Journal(path)
    assert not unpackings


def test_a_long_transaction_is_not_kept(saved):
    """Messages after one input are compared one by one: 30 MB of them take a few."""
    letters = random.Random(1).randbytes(250_000).hex()
    path = saved([POKE, *(fault(f"{i}{letters}") for i in range(60))])
    journal = Journal(path)
    replay = Replay(journal, TOYS)
    gc.collect()
    tracemalloc.start()
    outcome = replay.run(to_the_end=True)
    _, peak_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert outcome.messages == 60
    assert peak_bytes < 10 * MIB


def test_a_transaction_ends_where_the_next_input_is(saved):
    """Read to its end or not, the next one begins with its own input."""
    path = saved([POKE, fault("a"), fault("b"), POKE, POKE, fault("c")])
    kinds = [[e.kind for e in group] for group in transactions(Journal(path).entries())]
    assert kinds == [["input", "derived", "derived"], ["input"], ["input", "derived"]]
    assert [next(group).kind for group in transactions(Journal(path).entries())] == ["input"] * 3


@given(
    levels=st.integers(message_codec.NESTING, 480),
    value=st.sampled_from([1, {"$float": "x"}, {"$array": "0"}, "", {}]),
    seed=st.integers(0, 99),
    place=st.sampled_from(["result", "fault", "setting", "handle"]),
)
def test_a_deep_message_is_refused_by_its_number(tmp_path_factory, levels, value, seed, place):
    """Lists and objects nested more deeply than the limit."""
    deep = nested(value, levels, random.Random(seed))
    message = {
        "result": lambda: result(deep),
        "fault": lambda: fault(deep),
        "setting": lambda: entry(
            "input", "SetSetting", {"module": "parrot", "name": "tone", "value": deep}
        ),
        "handle": lambda: result({"$array": "0", "shape": deep, "sample": deep}),
    }[place]()
    path = tmp_path_factory.mktemp("deep") / "journal.mcap"
    path.write_bytes(forged(Parts(FACTS, [], [POKE, message])))
    for read in (lambda: Replay(Journal(path), TOYS).run(True), lambda: open_journal(path)):
        with pytest.raises(UserError, match=r"message 1, a .*: it nests more than 64 levels deep"):
            read()


def test_a_message_may_nest_as_deep_as_is_said(saved):
    """A message nested to the limit is accepted."""
    deep = nested(1.0, message_codec.NESTING - 2)
    assert list(dump_lines(Journal(saved([result(deep)]))))
    Replay(Journal(saved([result(deep)])), TOYS).run(to_the_end=True)


@pytest.mark.parametrize("fields", [{}, {"x": 1}, {"module": []}, {"module": {"$array": 1}}])
def test_a_result_without_a_job_is_compared_like_a_message(saved, fields):
    """A derived JobResult does not exist; without its module it is a difference all the same."""
    for type_name in ("JobResult", "Fault"):
        path = saved([POKE, entry("derived", type_name, fields)])
        assert f"a {type_name} from host" in Replay(Journal(path), TOYS).run(True).difference


def test_a_difference_fits_one_line(saved):
    """Names of fields are a stranger's too."""
    path = saved([entry("input", "SetSetting", {"module": "x", "name": "y", "value": 1})])
    fields = {"module": "x", "where": "setting", "\x1b[2J" + "n" * 500_000: 1}
    first = next(iter(opened(path.read_bytes()).messages))
    path = saved([first, entry("derived", "Fault", fields)])
    said = Replay(Journal(path), TOYS).run().difference
    assert said.isprintable()
    assert len(said) < 1500


def changed_setup(**changes):
    setup = msgspec.json.decode(FACTS["setup"])
    return FACTS | {"setup": msgspec.json.encode(setup | changes).decode()}


WISH = {"consumer": "c", "message": "Echo", "size": 1, "encoding": ""}


@pytest.mark.parametrize(
    ("facts", "says"),
    [
        (changed_setup(demands=[WISH] * 5000), "length <= 1024"),
        (changed_setup(slots={f"s{i}": "" for i in range(5000)}), "length <= 1024"),
        (changed_setup(demands=[WISH | {"consumer": nested(1, 300)}]), "nests more than 64"),
        (changed_setup(demands=[{"size": 1}]), "cannot replay the journal .*: Demand: "),
        (changed_setup(modules=[]), "cannot replay the journal|no module"),
        (FACTS | {"more": "x" * limits.METADATA_BYTES}, "its facts take more than"),
        (FACTS | {"setup": "[" * 50_000}, "cannot read the journal"),
        ({}, "its format is not 1"),
    ],
)
def test_what_a_setup_may_hold_is_bounded(saved, facts, says):
    """A kernel is asked each of it before the first input."""
    with pytest.raises(UserError, match=says):
        Replay(Journal(saved([POKE], facts=facts)), TOYS)


def test_an_array_is_there_once(saved):
    """Two of one name: programs could read either."""
    array = Array(np.zeros(9))
    with pytest.raises(UserError, match="is there twice"):
        Journal(saved([POKE], [packed(array)] * 2))


def test_a_channel_carries_one_type(saved):
    """Named anew half-way, other programs would show other messages."""
    with pytest.raises(UserError, match="now this and now that"):
        list(
            Journal(
                saved([entry("input", "Tick", {"elapsed_s": 0.0})], moved_channels=True)
            ).entries()
        )


def test_the_window_lists_no_more_than_fits(saved, monkeypatch):
    """A row takes many times what its message does; `vrut-lite dump` needs no list."""
    path = saved([POKE, *[fault(f"{i}") for i in range(3000)]])
    assert len(open_journal(path).rows) == 3001
    monkeypatch.setenv("VRUT_LITE_MEMORY_GIB", "0.005")
    with pytest.raises(
        UserError, match=r"too many for a list .*: look at them with `vrut-lite dump`"
    ):
        open_journal(path)
    assert sum(1 for _ in dump_lines(Journal(path))) == 3002


def test_a_row_names_the_first_fields_of_very_many(saved):
    """A message of 5,000 fields is no table for people."""
    path = saved([POKE, fault({f"f{i}": i for i in range(5000)})])
    assert 10 < len(open_journal(path).rows[1].fields) < 100


def test_a_dump_does_not_steer_the_terminal(saved):
    """Control characters that JSON would leave unchanged are escaped."""
    where = "\x1b[2J\x9b2J\x7f\u202e"
    line = list(dump_lines(Journal(saved([POKE, fault(where)]))))[-1]
    assert line.isprintable()
    assert msgspec.json.decode(line)["message"]["where"] == where


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ('"' + "y" * 2_500_000, "line 2: a line is longer than 2097152 bytes"),
        ('{"input":"Poke","message":' + "[" * 450 + "]" * 450 + "}", "line 2: it nests more than"),
        ('{"input":"Poke","message":{"value":' + "9" * 10_000 + "}}", "line 2: Integer value"),
        ('{"input":"Poke","message":{"value":"\\ud800"}}', "line 2: "),
        ('{"input":"\\u001b[2J"}', r"line 2: the message type '\\x1b\[2J' is unknown"),
    ],
)
def test_a_line_that_costs_too_much_is_named(tmp_path, line, says):
    """Files of inputs are read line by line, each no longer than a message may be."""
    script = tmp_path / "script.jsonl"
    script.write_text('{"input": "Poke", "message": {"value": 1.0}}\n' + line)
    with pytest.raises(UserError, match=says):
        read_inputs(script, Registry(TOYS))


def test_inputs_of_a_file_are_bounded_together(tmp_path, monkeypatch):
    """They wait as messages for their turn; lines that are no inputs take nothing."""
    script = tmp_path / "script.jsonl"
    line = '{"input": "Poke", "message": {"value": 1.0}}\n'
    script.write_text(line * 1000 + '{"derived": "Echo"}\n' * 9000)
    monkeypatch.setenv("VRUT_LITE_MEMORY_GIB", "0.002")
    assert len(read_inputs(script, Registry(TOYS))) == 1000
    monkeypatch.setenv("VRUT_LITE_MEMORY_GIB", "0.001")
    with pytest.raises(UserError, match=r"line 7.*: these inputs take more memory than they may"):
        read_inputs(script, Registry(TOYS))


def test_a_recording_that_could_not_be_read_is_refused_at_its_beginning():
    """Demands beyond the limit of a setup are refused before the session, not after it."""
    setup = msgspec.json.decode(FACTS["setup"], type=Setup)
    crowded = msgspec.structs.replace(setup, demands=[WISH] * 1025)
    with pytest.raises(UserError, match="cannot be recorded as it began"):
        JournalWriter(io.BytesIO(), {}, crowded)
    with pytest.raises(UserError, match="too many for a journal"):
        JournalWriter(io.BytesIO(), {"machine": "x" * limits.METADATA_BYTES}, setup)


def test_a_message_too_deep_for_a_reader_ends_the_recording():
    """The session goes on; `close` reports values that a journal cannot hold."""
    kernel = toy_kernel()
    recorder = Recorder(kernel, io.BytesIO())
    kernel.inject(JobResult(module="parrot", job="other", value=nested(1, 90)))
    kernel.pump()
    with pytest.raises(UserError, match=r"could not be recorded at a JobResult: .*nests more than"):
        recorder.close()

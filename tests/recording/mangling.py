"""Ways to spoil a journal, with and without mending its checksums."""

import dataclasses
import hashlib
import io
import struct
import zlib
from datetime import datetime
from typing import get_type_hints

import msgspec
import zstandard
from journal_toys import TOYS, Echo
from mcap.reader import make_reader
from mcap.records import Channel
from mcap.writer import Writer

from vrut_lite.kernel.messages import Fault, JobResult
from vrut_lite.message_codec import digest_of
from vrut_lite.recording.registry import Registry

MAGIC = 8
FOOTER = struct.Struct("<BQQQI")
DATA_END = struct.Struct("<BQI")


def flip(data, dice):
    """A few bytes changed anywhere."""
    spoilt = bytearray(data)
    for _ in range(dice.choice([1, 1, 2, 8])):
        spoilt[dice.randrange(len(spoilt))] ^= 1 << dice.randrange(8)
    return bytes(spoilt)


def truncate(data, dice):
    """The end, or a stretch within, is missing."""
    start = dice.randrange(len(data))
    end = dice.choice([len(data), dice.randrange(start, len(data))])
    return data[:start] + data[max(end, start + 1) :]


def forge_bytes(data, dice):
    """Changed bytes with correct checksums of the data section and the footer."""
    footer_start = len(data) - MAGIC - FOOTER.size
    opcode, length, summary_start, offsets, _ = FOOTER.unpack_from(data, footer_start)
    data_end = summary_start - DATA_END.size
    body = bytearray(data[:data_end])
    for _ in range(dice.choice([1, 2, 4])):
        body[dice.randrange(MAGIC, len(body))] = dice.choice([0, 1, 127, 255, dice.randrange(256)])
    end = DATA_END.pack(0x0F, 4, zlib.crc32(body))
    head = FOOTER.pack(opcode, length, summary_start, offsets, 0)[:-4]
    summary = data[summary_start:footer_start] + head
    crc = struct.pack("<I", zlib.crc32(summary))
    return bytes(body) + end + summary + crc + data[-MAGIC:]


def forge_content(data, dice):
    """A journal with changed texts and correct digests."""
    parts = opened(data)
    parts.facts = {k: _maybe(_spoil_text, v, dice, 0.05) for k, v in parts.facts.items()}
    topics = {topic: _maybe(_spoil_text, topic, dice, 0.05) for topic, _ in parts.messages}
    parts.messages = [
        (topics[topic], _maybe(_spoil_body, body, dice, 0.2, topic.split("/")[-1]))
        for topic, body in parts.messages
    ]
    return forged(parts)


@dataclasses.dataclass
class Parts:
    """What a journal consists of: facts, arrays by name, and messages with their topics."""

    facts: dict
    arrays: list
    messages: list
    # Register every channel twice, the second time with another's topic.
    moved_channels: bool = False


def opened(data):
    """The parts of a journal."""
    reader = make_reader(io.BytesIO(data))
    return Parts(
        next(reader.iter_metadata()).metadata,
        [(part.name, part.data) for part in reader.iter_attachments()],
        [(channel.topic, message.data) for _, channel, message in reader.iter_messages()],
    )


def forged(parts):
    """A journal of these parts, its checksums as they should be."""
    stream = io.BytesIO()
    writer = Writer(stream, enable_data_crcs=True)
    writer.start(profile="vrut_lite", library="forged")
    writer.add_metadata("journal", parts.facts)
    for name, content in parts.arrays:
        writer.add_attachment(0, 0, name, "application/zstd", content)
    channels = {}
    for topic, body in parts.messages:
        if topic not in channels:
            channels[topic] = writer.register_channel(topic, "json", 0)
        writer.add_message(channels[topic], 0, body, 0)
    if parts.moved_channels:
        first = next(iter(channels.values()))
        writer._Writer__chunk_builder.add_channel(Channel(first, "/input/Poke", "json", {}, 0))
        writer.add_message(first, 0, parts.messages[0][1], 0)
    writer.finish()
    return stream.getvalue()


def sealed(type_name, body):
    """The body of an entry, its digest mended however it looks."""
    message = body.get("message")
    try:
        digest = digest_of(type_name, message)
    except Exception:
        plain = msgspec.json.encode(message, order="sorted")
        digest = hashlib.blake2b(f"{type_name}\0".encode() + plain, digest_size=16).hexdigest()
    return msgspec.json.encode(body | {"digest": digest})


def nested(value, levels, dice=None):
    """A value within so many lists or objects."""
    for _ in range(levels):
        value = {"a": value} if dice is not None and dice.random() < 0.3 else [value]
    return value


def forge_records(data, dice):
    """A journal of which decoded records were changed, one to four times."""
    parts = opened(data)
    for _ in range(dice.choice([1, 1, 2, 4])):
        dice.choice(FORGERIES)(parts, dice)
    return forged(parts)


def _change_message(parts, dice):
    """A value somewhere in a message is missing, of another type, nested or absurd."""
    number = dice.randrange(len(parts.messages))
    topic, data = parts.messages[number]
    body = msgspec.json.decode(data)
    place = body["message"] if dice.random() < 0.9 else body
    _change_somewhere(place, dice)
    parts.messages[number] = (topic, sealed(topic.split("/")[-1], body))


def _change_somewhere(place, dice):
    if not place:
        return
    while True:
        name = dice.choice(list(place)) if isinstance(place, dict) else dice.randrange(len(place))
        if not (isinstance(place[name], dict | list) and place[name] and dice.random() < 0.7):
            break
        place = place[name]
    change = dice.randrange(4)
    if change == 0:
        del place[name]
    elif change == 1:
        place[name] = dice.choice(ABSURD_VALUES)
    elif change == 2:
        place[name] = nested(place[name], dice.choice([1, 60, 70, 300, 450]), dice)
    elif isinstance(place, dict):
        place[dice.choice(ABSURD_TEXTS)] = place[name]
    else:
        place.append(place[name])


def _change_facts(parts, dice):
    if not parts.facts:
        return
    name = dice.choice(list(parts.facts))
    content = {name: msgspec.json.decode(parts.facts[name])}
    _change_somewhere(content, dice)
    parts.facts.pop(name)
    parts.facts |= {key: msgspec.json.encode(value).decode() for key, value in content.items()}


def _change_demands(parts, dice):
    setup = msgspec.json.decode(parts.facts.get("setup", "{}"))
    if not isinstance(setup, dict):
        return
    wish = {"consumer": "c", "message": "SunMoved", "size": 1, "encoding": ""}
    wishes = [wish | {"consumer": f"c{i}"} for i in range(dice.choice([1, 100, 5000]))]
    _change_somewhere(wishes, dice)
    parts.facts["setup"] = msgspec.json.encode(setup | {"demands": wishes}).decode()


def _change_order(parts, dice):
    messages = parts.messages
    first, second = sorted(dice.choices(range(len(messages)), k=2))
    change = dice.randrange(4)
    if change == 0:
        messages[first], messages[second] = messages[second], messages[first]
    elif change == 1:
        del messages[first]
    elif change == 2:
        messages[first:first] = [messages[second]] * dice.choice([1, 50])
    else:
        topic = messages[second][0]
        body = msgspec.json.decode(messages[first][1])
        messages[first] = (topic, sealed(topic.split("/")[-1], body))


def _change_arrays(parts, dice):
    if not parts.arrays:
        return
    number = dice.randrange(len(parts.arrays))
    name, content = parts.arrays[number]
    change = dice.randrange(5)
    if change == 0:
        del parts.arrays[number]
    elif change == 1:
        parts.arrays.append((name, content))
    elif change == 2:
        parts.arrays[number] = (dice.choice(ABSURD_TEXTS), content)
    elif change == 3:
        parts.arrays[number] = (name, dice.choice([b"", b"\0" * 9, content[:-3], content[:9]]))
    else:
        parts.arrays[number] = (name, zstandard.compress(bytes(dice.choice([0, 7, 2**24]))))


def _invent_message(parts, dice):
    """A message of some type that is known; most of its fields fit, and say what nobody would."""
    kind = dice.choice([*REGISTRY.inputs(), Fault, JobResult, Echo])
    hints = get_type_hints(kind)
    fields = {
        name: dice.choice(LIKELY_VALUES.get(hints[name], ABSURD_VALUES))
        if dice.random() < 0.9
        else dice.choice(ABSURD_VALUES)
        for name in kind.__struct_fields__
        if dice.random() < 0.9
    }
    body = {"sender": dice.choice(["host", "parrot"]), "digest": "", "message": fields}
    place = dice.randrange(len(parts.messages) + 1)
    topic = f"/{dice.choice(['input', 'input', 'derived'])}/{kind.__name__}"
    parts.messages.insert(place, (topic, sealed(kind.__name__, body)))


def _move_channels(parts, dice):
    parts.moved_channels = True


FORGERIES = [
    *[_change_message] * 8,
    *[_invent_message] * 3,
    _change_facts,
    _change_demands,
    _change_order,
    _change_arrays,
    _move_channels,
]


def _maybe(spoil, value, dice, chance, *arguments):
    return spoil(value, dice, *arguments) if dice.random() < chance else value


def _spoil_text(text, dice):
    place = dice.randrange(len(text))
    return text[:place] + dice.choice(["", "9", "x", '"', "[", "é", "\0"]) + text[place + 1 :]


def _spoil_body(data, dice, name):
    """Change some characters or some value; the digest fits if the JSON still is one."""
    if dice.random() < 0.3:
        text = _spoil_text(data.decode(), dice)
        try:
            body = msgspec.json.decode(text)
        except msgspec.DecodeError:
            return text.encode()
    else:
        body = msgspec.json.decode(data)
        field = dice.choice(list(body["message"]))
        body["message"][field] = dice.choice(ODD_VALUES)
    if isinstance(body, dict) and isinstance(body.get("message"), dict):
        body["digest"] = digest_of(name, body["message"])
    return msgspec.json.encode(body)


HANDLES = [{"$array": "00"}, {"$array": []}, {"$array": {}}]
TAGGED = [*HANDLES, {"$float": "nan"}, {"$float": 3}, {"$opaque": 1}]
NUMBERS = [True, 0, -1, 2**63, 10**30, 1e308]
ODD_VALUES = [None, *NUMBERS, "", "parrot", "\ud7ff" * 100, [], [[[]]], {}, {"a": 1}, *TAGGED]
ABSURD_TEXTS = [
    "",
    "a" * 100_000,
    "\x1b[2J\x9b\u202e\n",
    "../" * 99,
    "$array",
    "$float",
    "host",
    "é",
]
INFINITE = ("nan", "inf", "-inf")
ABSURD_VALUES = [
    *ODD_VALUES,
    *ABSURD_TEXTS,
    10**4000,
    -(2**63),
    2**64,
    1e-320,
    "0000-00-00T00:00:00Z",
    "9999-12-31T23:59:59-23:59",
    "0001-01-01T00:00:00+23:59",
    [0.0] * 10_000,
    {"$array": "0" * 32, "dtype": "<f4", "shape": [2**62, 2**62], "sample": ["x", None]},
    {"$array": "\x1b", "dtype": ["O"], "shape": 4, "sample": 3},
    {"$float": "\x1b" * 3000},
    {"$opaque": [[]]},
    {str(i): i for i in range(3000)},
]
MODULES_AND_MORE = ["parrot", "other_sun", "sun", "volume", "think", "SunMoved", "Echo", "clouds"]
LIKELY_VALUES = {
    str: [*MODULES_AND_MORE * 3, *ABSURD_TEXTS],
    float: [0.5, 0.5, 0.0, -1.0, 1e308, -1e308, 5e-324, *({"$float": text} for text in INFINITE)],
    int: [0, 1, 64, -1, 4096, 4097, 2**31, 2**63 - 1, -(2**63)],
    bool: [True, False],
    datetime: ["2026-06-21T12:00:00Z", *(value for value in ABSURD_VALUES if "T00" in str(value))],
}
REGISTRY = Registry(TOYS)

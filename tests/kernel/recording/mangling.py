"""Ways to spoil a journal, with and without mending its checksums."""

import io
import struct
import zlib

import msgspec
from mcap.reader import make_reader
from mcap.writer import Writer

from vrut_lite.kernel.recording.codec import digest_of

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
    """Bytes changed by someone who mends the checksums of the data section and the footer."""
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
    """A journal written anew by someone who changed messages and mended their digests."""
    reader, stream = make_reader(io.BytesIO(data)), io.BytesIO()
    writer = Writer(stream, enable_data_crcs=True)
    writer.start(profile="vrut_lite", library="forged")
    for metadata in reader.iter_metadata():
        facts = {k: _maybe(_spoil_text, v, dice, 0.05) for k, v in metadata.metadata.items()}
        writer.add_metadata(metadata.name, facts)
    for attachment in reader.iter_attachments():
        writer.add_attachment(0, 0, attachment.name, attachment.media_type, attachment.data)
    channels = {}
    for schema, channel, message in reader.iter_messages():
        if channel.topic not in channels:
            number = writer.register_schema(schema.name, schema.encoding, schema.data)
            topic = _maybe(_spoil_text, channel.topic, dice, 0.05)
            channels[channel.topic] = writer.register_channel(topic, "json", number)
        body = _maybe(_spoil_body, message.data, dice, 0.2, schema.name)
        writer.add_message(channels[channel.topic], 0, body, 0)
    writer.finish()
    return stream.getvalue()


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

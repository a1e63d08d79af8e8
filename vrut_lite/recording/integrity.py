"""Whether a journal's bytes are those that were written, before anything reads them."""

import struct
import zlib

from vrut_lite.errors import UserError

_MAGIC = b"\x89MCAP0\r\n"
_DATA_END = struct.Struct("<BQI")
_FOOTER = struct.Struct("<BQQQI")
_DATA_END_OPCODE, _FOOTER_OPCODE = 0x0F, 0x02


def checked_section(data: bytes) -> memoryview:
    """The records of the data section, after its checksum and the summary's were compared.

    Raises:
        UserError: the bytes are no MCAP file, cut short, or changed after writing.
    """
    if not data.startswith(_MAGIC):
        raise UserError("it is no journal: it does not begin as an MCAP file")
    footer_start = len(data) - len(_MAGIC) - _FOOTER.size
    if footer_start < len(_MAGIC) or not data.endswith(_MAGIC):
        raise UserError("it is cut short, or its end was changed")
    opcode, _, summary_start, _, summary_crc = _FOOTER.unpack_from(data, footer_start)
    data_end = summary_start - _DATA_END.size
    if opcode != _FOOTER_OPCODE or not len(_MAGIC) <= data_end <= footer_start:
        raise UserError("it is damaged: its footer does not fit")
    end_opcode, _, data_crc = _DATA_END.unpack_from(data, data_end)
    view = memoryview(data)
    summary = view[summary_start : footer_start + _FOOTER.size - 4]
    if end_opcode != _DATA_END_OPCODE or data_crc != zlib.crc32(view[:data_end]):
        raise UserError("it is damaged: the checksum of its messages does not fit")
    if summary_crc != zlib.crc32(summary):
        raise UserError("it is damaged: the checksum of its summary does not fit")
    return view[len(_MAGIC) : data_end]

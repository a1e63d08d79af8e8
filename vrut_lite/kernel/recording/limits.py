"""How large things in a journal may be: a stranger's file must not fill the memory."""

from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Demand, Message, Resize

FILE_BYTES = 2**30
CHUNK_BYTES = 2**23
MESSAGE_BYTES = 2**20
METADATA_BYTES = 2**23
# Messages of sessions unpack to some 10 to 50 times what they take; they are read one by one, so
# that this bounds the time that a small file can cost.
MOST_PACKED_RATIO = 200
MOST_UNPACKED_BYTES = 2**24
ARRAY_BYTES = 2**28

# Records in a file, and types of messages: each costs time and some memory, however short.
RECORDS = 2**17
# Lists in lists: whoever walks through a message calls itself for each level.
NESTING = 64
# What a byte of JSON may become as Python's objects: '{"":0},' becomes some 200 bytes.
DECODED_PER_BYTE = 32

# The largest cube and the largest picture that the command line offers.
LARGEST_DEMAND = 4096
LARGEST_PICTURE_PX = 16384


def check_limits(message: Message) -> None:
    """Refuse an input whose consequences would not fit.

    Raises:
        UserError: the size it asks for is beyond what the command line offers.
    """
    match message:
        case Demand(size=size) if not 0 <= size <= LARGEST_DEMAND:
            raise UserError(f"Demand: size {size} lies outside 0 to {LARGEST_DEMAND}")
        case Resize(width_px=width, height_px=height) if not (
            0 < width <= LARGEST_PICTURE_PX and 0 < height <= LARGEST_PICTURE_PX
        ):
            raise UserError(
                f"Resize: {width}x{height} lies outside 1x1 to "
                f"{LARGEST_PICTURE_PX}x{LARGEST_PICTURE_PX} pixels"
            )

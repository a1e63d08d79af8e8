"""Limits of sizes in a journal: a hostile file must not fill the memory."""

FILE_BYTES = 2**30
CHUNK_BYTES = 2**23
METADATA_BYTES = 2**23
# Messages of sessions unpack to 10 to 50 times their packed size; they are read one by one, so that
# this bounds the time that a small file can take.
MOST_PACKED_RATIO = 200
MOST_UNPACKED_BYTES = 2**24

# Records in a file, and types of messages: each costs time and some memory, however short.
RECORDS = 2**17
# Memory of a byte of JSON as Python objects: '{"":0},' becomes some 200 bytes.
DECODED_PER_BYTE = 32

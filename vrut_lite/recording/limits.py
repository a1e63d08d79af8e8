"""How large things in a journal may be: a stranger's file must not fill the memory."""

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

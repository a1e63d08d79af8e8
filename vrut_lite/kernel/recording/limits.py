"""How large things in a journal may be: a stranger's file must not fill the memory."""

FILE_BYTES = 2**30
CHUNK_BYTES = 2**23
MESSAGE_BYTES = 2**20
ARRAY_BYTES = 2**28

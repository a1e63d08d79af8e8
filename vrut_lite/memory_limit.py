"""The memory limit for files that may come from strangers: journals and scenes."""

import os
import re

from vrut_lite.errors import UserError

VARIABLE = "VRUT_LITE_MEMORY_GIB"
_DEFAULT_GIB = 4.0
_MOST_GIB = 2**20
_NUMBER = re.compile(r"[0-9]{1,9}(\.[0-9]{1,9})?")


def memory_limit_bytes() -> int:
    """VRUT_LITE_MEMORY_GIB of the environment in bytes; 4 GiB if it is unset or empty.

    Raises:
        UserError: it is not a number above 0.
    """
    text = os.environ.get(VARIABLE, "").strip() or str(_DEFAULT_GIB)
    limit_gib = float(text) if _NUMBER.fullmatch(text) else 0.0
    if not 0.0 < limit_gib <= _MOST_GIB:
        raise UserError(
            f"{VARIABLE} is {text!r}: give the memory that a file may take in GiB, 8 or 0.5, say"
        )
    return int(limit_gib * 2**30)

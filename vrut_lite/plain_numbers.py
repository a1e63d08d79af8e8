"""Numbers as people type them: ASCII digits, one sign, one point, an exponent.

Python's own `float` and `int` take more: digits of every script, and `1_0` for ten.
"""

import re

_WHOLE = re.compile(r"[+-]?\d+", re.ASCII)
_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf(inity)?|nan)", re.ASCII | re.I)


def plain_float(text: str) -> float:
    """The number that the text writes, spaces around it aside; inf and nan have their names.

    Raises:
        ValueError: it writes none.
    """
    if not _NUMBER.fullmatch(text.strip()):
        raise ValueError(f"{text!r} is no number")
    return float(text)


def plain_int(text: str) -> int:
    """The whole number that the text writes, spaces around it aside.

    Raises:
        ValueError: it writes none, or one of thousands of digits.
    """
    if not _WHOLE.fullmatch(text.strip()):
        raise ValueError(f"{text!r} is no whole number")
    return int(text)

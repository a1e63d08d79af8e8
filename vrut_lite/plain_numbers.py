"""Parses numbers in plain form: ASCII digits, one sign, one point, an exponent.

Python's own `float` and `int` accept more: digits of every script, and `1_0` for ten.
"""

import re

_WHOLE = re.compile(r"[+-]?\d+", re.ASCII)
_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf(inity)?|nan)", re.ASCII | re.I)


def plain_float(text: str) -> float:
    """Parse a number, also inf and nan; spaces around it are ignored.

    Raises:
        ValueError: the text is not a number.
    """
    if not _NUMBER.fullmatch(text.strip()):
        raise ValueError(f"{text!r} is no number")
    return float(text)


def plain_int(text: str) -> int:
    """Parse a whole number; spaces around it are ignored.

    Raises:
        ValueError: the text is not a whole number, or has thousands of digits.
    """
    if not _WHOLE.fullmatch(text.strip()):
        raise ValueError(f"{text!r} is no whole number")
    return int(text)

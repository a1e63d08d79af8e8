"""Checks of message fields: each passes, or raises a UserError of one sentence.

Messages are made without type checks, so that a field may hold a value of any type. `of` names the
message in the sentence, by default by its type.
"""

import math
import sys
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any, NoReturn, Protocol

import numpy as np

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import safe_text, sentence_of
from vrut_lite.interrupts import pass_interrupt

_MOST = sys.float_info.max
_WHOLES = (int, np.integer)
_NUMBERS = (float, *_WHOLES, np.floating)
# Tolerance of a unit vector in 32 bits, or written with three digits.
_UNIT_TOLERANCE = 2e-3
_LONGEST_SHOWN = 80
# Largest coefficient of a polynomial: a sum of a few cannot overflow.
_MOST_TERM = 1e6


class Checked(Protocol):
    """A message or a struct with fields."""

    def check(self) -> None:
        """Check all fields."""


def refusal_of(message: Checked) -> str | None:
    """The reason why a message is invalid, or None; a module may have written its check."""
    try:
        message.check()
    except BaseException as error:
        pass_interrupt(error)
        return sentence_of(error)
    return None


def number(
    message: object, name: str, low: float = -_MOST, high: float = _MOST, of: str = ""
) -> None:
    """Check that a field is a finite number from `low` to `high`."""
    value = getattr(message, name)
    # Written so that a NaN is refused too.
    if not (_is_number(value) and low <= _wide(value) <= high):
        _refuse(message, name, of, _range(low, high), value)


def numbers(message: object, name: str, length: int, of: str = "") -> None:
    """Check that a field is a tuple of so many finite numbers."""
    value = getattr(message, name)
    if not (isinstance(value, tuple) and len(value) == length and all(map(is_finite, value))):
        words = {2: "two", 3: "three"}
        _refuse(message, name, of, f"be {words.get(length, length)} finite numbers", value)


def direction(message: object, name: str) -> None:
    """Check that a field is a unit vector: a tuple of three numbers."""
    numbers(message, name, 3)
    value = getattr(message, name)
    if not abs(math.hypot(*value) - 1.0) <= _UNIT_TOLERANCE:
        _refuse(message, name, "", "be a unit vector", value)


def light(message: object, name: str, most: float) -> None:
    """Check that a field is a colour of light: a tuple of three numbers from 0 to `most`."""
    numbers(message, name, 3)
    if not all(0.0 <= _wide(part) <= most for part in getattr(message, name)):
        refuse(message, name, f"be three numbers from 0 to {most:g}")


def polynomials(message: object, name: str, count: int, terms: int) -> None:
    """Check that a field is a tuple of so many tuples of 1 to `terms` numbers each."""
    value = getattr(message, name)
    fits = isinstance(value, tuple) and len(value) == count
    if not (
        fits
        and all(isinstance(one, tuple) and 0 < len(one) <= terms for one in value)
        and all(is_finite(term) and abs(_wide(term)) <= _MOST_TERM for one in value for term in one)
    ):
        refuse(message, name, f"be {count} polynomials of 1 to {terms} terms")


def shader_inputs(message: object) -> None:
    """Check `uniforms`, numbers and tuples of them by name, and `buffers`, arrays by binding."""
    uniforms, buffers = (getattr(message, name) for name in ("uniforms", "buffers"))
    if not isinstance(uniforms, dict):
        refuse(message, "uniforms", "be values by name")
    for name, value in uniforms.items():
        parts = value if isinstance(value, tuple) else (value,)
        if not (isinstance(name, str) and parts and all(map(_is_number_or_flag, parts))):
            refuse(message, "uniforms", "be numbers and tuples of numbers by name")
    if not (isinstance(buffers, tuple) and all(map(_is_buffer, buffers))):
        refuse(message, "buffers", "be pairs of a binding and an array of float32")


def whole(message: object, name: str, low: int, high: int) -> None:
    """Check that a field is a whole number from `low` to `high`."""
    value = getattr(message, name)
    if not (is_whole(value) and low <= value <= high):
        _refuse(message, name, "", f"be a whole number from {low} to {high}", value)


def wholes(message: object, name: str, low: int, high: int, most: int, least: int = 0) -> None:
    """Check that a field is a tuple of `least` to `most` whole numbers from `low` to `high`."""
    value = getattr(message, name)
    fits = isinstance(value, tuple) and least <= len(value) <= most
    if not (fits and all(is_whole(item) and low <= item <= high for item in value)):
        many = f"{most}" if least == most else f"{least} to {most}"
        _refuse(message, name, "", f"be {many} whole numbers from {low} to {high}", value)


def text(message: object, *names: str) -> None:
    """Check that fields are texts."""
    for name in names:
        if not isinstance(getattr(message, name), str):
            _refuse(message, name, "", "be a text", getattr(message, name))


def lines(message: object, name: str) -> None:
    """Check that a field is a tuple of texts."""
    value = getattr(message, name)
    if not (isinstance(value, tuple) and all(isinstance(line, str) for line in value)):
        _refuse(message, name, "", "be lines of text", value)


def pairs_of_texts(message: object, name: str) -> None:
    """Check that a field is a tuple of pairs of texts."""
    value = getattr(message, name)
    if not (isinstance(value, tuple) and all(map(_is_pair_of_texts, value))):
        _refuse(message, name, "", "be pairs of texts", value)


def flag(message: object, *names: str, of: str = "") -> None:
    """Check that fields are true or false."""
    for name in names:
        if not isinstance(getattr(message, name), bool | np.bool_):
            _refuse(message, name, of, "be true or false", getattr(message, name))


def choice(message: object, name: str, choices: Sequence[str], of: str = "") -> None:
    """Check that a field is one of these texts."""
    value = getattr(message, name)
    if not (isinstance(value, str) and value in choices):
        _refuse(message, name, of, f"be one of {', '.join(filter(None, choices))}", value)


def instant(message: object, name: str) -> None:
    """Check that a field is a time with a time zone, within the years that UTC can name."""
    value = getattr(message, name)
    if not isinstance(value, datetime):
        _refuse(message, name, "", "be a time", value)
    try:
        offset = value.utcoffset()
        if offset is not None:
            value.astimezone(UTC)
    except OverflowError:
        raise UserError(
            f"{value} lies outside the years 1 to 9999 in UTC: choose another"
        ) from None
    if offset is None:
        raise UserError(f"the clock needs a time zone with {value}: add an offset")


def instance(message: object, name: str, kind: type | tuple[type, ...]) -> None:
    """Check that a field is of a type, or of one of several."""
    value = getattr(message, name)
    if not isinstance(value, kind):
        kinds = kind if isinstance(kind, tuple) else (kind,)
        _refuse(message, name, "", f"be of {' or '.join(k.__name__ for k in kinds)}", value)


def array(message: object, name: str, shape: tuple[int, ...], dtypes: Sequence[str]) -> None:
    """Check that a field is an `Array` of such a shape and one of these element types.

    Of `shape` a positive number is a length, a negative one a length that may be anything up to
    that many; equal negative ones are one length. Element types are as numpy's `dtype.str`.
    """
    value = getattr(message, name)
    instance(message, name, Array)
    free = dict(zip(shape, value.shape, strict=False))
    fits = len(value.shape) == len(shape) and all(
        found == (free[wanted] if wanted < 0 else wanted) and 0 < found <= abs(wanted)
        for found, wanted in zip(value.shape, shape, strict=True)
    )
    if not fits or value.dtype.str not in dtypes:
        wanted = ", ".join(str(n) if n > 0 else f"up to {-n}" for n in shape)
        kinds = " or ".join(str(np.dtype(kind)) for kind in dtypes)
        found = f"{value.shape} of {value.dtype}"
        _refuse_as(message, name, "", f"be an array ({wanted}) of {kinds}", found)


def arrays(
    message: object, expected: Mapping[str, tuple[str, tuple[int | str, ...]]], of: str = ""
) -> None:
    """Check that fields are arrays of these element types and shapes, of any length.

    Element types are as numpy's `dtype.str`; in a shape equal letters stand for equal lengths.
    """
    lengths: dict[int | str, int] = {}
    for name, (dtype, shape) in expected.items():
        instance(message, name, Array)
        found: Array = getattr(message, name)
        fits = found.dtype.str == dtype and len(found.shape) == len(shape)
        for wanted, length in zip(shape, found.shape, strict=False):
            known = wanted if isinstance(wanted, int) else lengths.setdefault(wanted, length)
            fits = fits and known == length
        if not fits:
            refuse(message, name, f"be {dtype} of shape {shape}", of)


def contents(message: object, name: str, low: float, high: float) -> None:
    """Check that all values of a field, an `Array`, are numbers from `low` to `high`."""
    values = getattr(message, name).values
    # With a NaN among the values both ends are NaN.
    with np.errstate(invalid="ignore"):
        least, most = float(values.min()), float(values.max())
    if not (low <= least and most <= high):
        found = f"{least:g} to {most:g}"
        _refuse_as(message, name, "", f"hold numbers from {low:g} to {high:g}", found)


def is_finite(value: Any) -> bool:
    """Whether a value is a number, and neither infinite nor a NaN."""
    return _is_number(value) and -_MOST <= _wide(value) <= _MOST


def is_whole(value: Any) -> bool:
    """Whether a value is a whole number, and no truth value."""
    return isinstance(value, _WHOLES) and not isinstance(value, bool)


def refuse(message: object, name: str, must: str, of: str = "") -> NoReturn:
    """Raise a sentence with a field's allowed and actual value."""
    _refuse(message, name, of, must, getattr(message, name))


def shown(value: object) -> str:
    """A value of any type as one short line for a sentence."""
    plain = _is_number(value) or isinstance(value, bool)
    told = safe_text(lambda: str(value) if plain else repr(value), f"a {type(value).__name__}")
    told = "".join(letter if letter.isprintable() else "?" for letter in told[: _LONGEST_SHOWN + 1])
    return told if len(told) <= _LONGEST_SHOWN else told[:_LONGEST_SHOWN] + "..."


def _refuse(message: object, name: str, of: str, must: str, value: object) -> NoReturn:
    _refuse_as(message, name, of, must, shown(value))


def _refuse_as(message: object, name: str, of: str, must: str, found: str) -> NoReturn:
    raise UserError(f"{name} of {of or type(message).__name__} must {must}, not {found}")


def _range(low: float, high: float) -> str:
    if low > -_MOST and high < _MOST:
        return f"lie from {low:g} to {high:g}"
    if low > -_MOST:
        return f"be a finite number of {low:g} or more"
    return "be a finite number"


def _is_number_or_flag(value: object) -> bool:
    return isinstance(value, bool) or _is_number(value)


def _is_buffer(value: object) -> bool:
    if not (isinstance(value, tuple) and len(value) == 2):
        return False
    binding, data = value
    fits = is_whole(binding) and binding >= 0 and isinstance(data, Array)
    return fits and data.dtype == np.float32


def _is_pair_of_texts(value: object) -> bool:
    is_pair = isinstance(value, tuple) and len(value) == 2
    return is_pair and all(isinstance(part, str) for part in value)  # type: ignore[attr-defined]


def _wide(value: Any) -> float | int:
    """A number as Python's: numpy would round a bound to a narrow type, at worst to infinity."""
    if isinstance(value, np.floating):
        return float(value)
    return int(value) if isinstance(value, np.integer) else value


def _is_number(value: Any) -> bool:
    return isinstance(value, _NUMBERS) and not isinstance(value, bool)

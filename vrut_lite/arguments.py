"""Checks arguments of public functions; errors name the parameter, the value and the range.

Numbers are finite integers and floats of Python or numpy, in arrays of any shape. Booleans, texts,
complex numbers, masked arrays and objects are refused, though numpy would convert some of them.
"""

import math
import reprlib
from collections.abc import Sequence
from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.numeric_types import FloatArray

# Civil dates before 1583 were Julian. At both ends the ephemeris of astronomy-engine and NREL's SPA
# still agree to 0.004 degrees on the sun's position; beyond, they diverge.
FIRST_YEAR, LAST_YEAR = 1600, 2600
# Tolerance for rounding of angles and cosines, as a share of their range.
ROUNDING = 1e-9
_REAL_KINDS = "iuf"
_short = reprlib.Repr()
_short.maxstring = _short.maxother = 60


def as_number(
    name: str, value: float, low: float = -math.inf, high: float = math.inf, unit: str = ""
) -> float:
    """One finite number from `low` to `high`.

    Raises:
        ValueError: it is not one.
    """
    # A plain float, the usual case, needs no array, which would take microseconds.
    if type(value) is float and low <= value <= high and math.isfinite(value):
        return value
    array = _real(name, value, f"a number, {_range_text(low, high, unit)}")
    if array.ndim:
        raise ValueError(f"{name} must be a single number, not an array of shape {array.shape}")
    return float(_within(name, array, low, high, unit))


def as_numbers(
    name: str,
    value: ArrayLike,
    low: float = -math.inf,
    high: float = math.inf,
    unit: str = "",
    *,
    slack: float = 0.0,
) -> FloatArray:
    """Finite numbers (...,) from `low` to `high`.

    Values outside by at most `slack`, a share of the range, are clipped to it.

    Raises:
        ValueError: one of them is outside, or they are not numbers.
    """
    array = _real(name, value, f"a number or an array of them, {_range_text(low, high, unit)}")
    return _within(name, array, low, high, unit, slack * (high - low) if slack else 0.0)


def as_vectors(name: str, value: ArrayLike, longest: float = math.inf) -> FloatArray:
    """Finite vectors (..., 3) with components of at most `longest` in magnitude.

    Raises:
        ValueError: they are not.
    """
    array = _real(name, value, "finite numbers of shape (..., 3)")
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"{name} must be finite numbers of shape (..., 3), not {array.shape}")
    return _within(name, array, -longest, longest, "")


def as_count(name: str, value: object, low: int, high: int) -> int:
    """A whole number from `low` to `high`; 3.0 and True are refused.

    Raises:
        ValueError: it is not one.
    """
    if type(value) is int and low <= value <= high:
        return value
    if not isinstance(value, int | np.integer) or isinstance(value, bool):
        raise ValueError(f"{name} must be a whole number from {low} to {high}, not {shown(value)}")
    if not low <= int(value) <= high:
        raise ValueError(f"{name} must lie between {low} and {high}, not {shown(int(value))}")
    return int(value)


def as_flag(name: str, value: bool) -> bool:
    """True or False.

    Raises:
        ValueError: it is neither.
    """
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} must be True or False, not {shown(value)}")
    return bool(value)


def check_choice(name: str, value: object, choices: Sequence[str]) -> None:
    """Raise ValueError unless the value is one of the texts."""
    if not isinstance(value, str) or value not in choices:
        listed = ", ".join(repr(choice) for choice in choices)
        raise ValueError(f"{name} must be one of {listed}, not {shown(value)}")


def check_type(name: str, value: object, *kinds: type) -> None:
    """Raise ValueError unless the value is an instance of one of the classes."""
    if not isinstance(value, kinds):
        named = " or ".join(kind.__name__ for kind in kinds)
        raise ValueError(f"{name} must be of the class {named}, not {shown(value)}")


def check_instant(name: str, when: datetime) -> None:
    """Raise ValueError unless this is an aware datetime from FIRST_YEAR to LAST_YEAR."""
    check_type(name, when, datetime)
    if when.utcoffset() is None:
        raise ValueError(
            f"{name} has no time zone ({when}): give an aware datetime, such as one in UTC"
        )
    if not FIRST_YEAR <= when.year <= LAST_YEAR:
        raise ValueError(f"{name} must be of the years {FIRST_YEAR} to {LAST_YEAR}, not {when}")


def check_output(
    out: NDArray[Any], shape: tuple[int, ...], dtype: type[np.generic], name: str = "out"
) -> None:
    """Raise ValueError unless the array is C-contiguous, writable and of this shape and dtype."""
    if not isinstance(out, np.ndarray):
        given = shown(out)
    else:
        fits = out.shape == shape and out.dtype == dtype and out.dtype.isnative
        if fits and out.flags.c_contiguous and out.flags.writeable:
            return
        given = f"{out.dtype} of shape {out.shape}"
        given += "" if out.flags.writeable else ", read-only"
    raise ValueError(
        f"{name} must be a C-contiguous, writable {np.dtype(dtype)} array of shape {shape}, "
        f"not {given}"
    )


def broadcast(**arrays: FloatArray) -> tuple[FloatArray, ...]:
    """The arrays, broadcast against each other, in the order given.

    Raises:
        ValueError: their shapes do not broadcast; the sentence names them by their keywords.
    """
    check_shapes(**arrays)
    return np.broadcast_arrays(*arrays.values())


def check_shapes(**arrays: FloatArray) -> None:
    """Raise ValueError unless the arrays broadcast against each other."""
    try:
        np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise ValueError(f"shapes that do not broadcast: {shapes}") from None


def shown(value: object) -> str:
    """A value for a sentence: on one line, shortened."""
    try:
        return " ".join(_short.repr(value).split())
    except ValueError:  # Python refuses to print the longest integers.
        return f"one of the class {type(value).__name__}"


def _real(name: str, value: object, wanted: str) -> NDArray[Any]:
    try:
        array = np.asarray(value)
    except Exception:  # The conversion of a foreign class may raise anything.
        raise ValueError(f"{name} must be {wanted}, not {shown(value)}") from None
    # The first look at `np.ma` imports it, for 40 ms: plain arrays and lists need none of it.
    is_special = isinstance(value, np.ndarray) and type(value) is not np.ndarray
    masked = is_special and isinstance(value, np.ma.MaskedArray)
    if array.dtype.kind not in _REAL_KINDS or masked or _holds_booleans(value):
        raise ValueError(f"{name} must be {wanted}, not {shown(value)}")
    return array


def _holds_booleans(value: object) -> bool:
    """Whether there are booleans in a list, which numpy would turn into numbers."""
    if isinstance(value, list | tuple):
        return any(map(_holds_booleans, value))
    return isinstance(value, bool | np.bool_) or (
        isinstance(value, np.ndarray) and value.dtype.kind == "b"
    )


def _within(
    name: str, array: NDArray[Any], low: float, high: float, unit: str, slack: float = 0.0
) -> FloatArray:
    with np.errstate(over="ignore"):
        values: FloatArray = array.astype(np.float64, copy=False)
    if not values.size:
        return values
    # A NaN is both minimum and maximum, and fails every comparison.
    least, most = float(values.min()), float(values.max())
    if low <= least and most <= high and math.isfinite(least) and math.isfinite(most):
        return values
    if low - slack <= least and most <= high + slack and math.isfinite(most - least):
        return np.clip(values, low, high)
    fine = np.isfinite(values) & (values >= low - slack) & (values <= high + slack)
    wrong = float(values[~fine].flat[0])
    lie = "lie " if math.isfinite(high - low) else "be "
    raise ValueError(f"{name} must {lie}{_range_text(low, high, unit)}, not {wrong!r}")


def _range_text(low: float, high: float, unit: str) -> str:
    after = f" {unit}" if unit else ""
    if math.isfinite(low) and math.isfinite(high):
        return f"between {low:.10g} and {high:.10g}{after}"
    if math.isfinite(low):
        return f"finite and not below {low:.10g}{after}"
    return f"finite and not above {high:.10g}{after}" if math.isfinite(high) else "finite"

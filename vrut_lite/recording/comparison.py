"""The difference of two plain messages, exact or within the tolerance between machines."""

import math
from collections.abc import Callable
from typing import Any

from vrut_lite.errors import one_line
from vrut_lite.recording.earlier_names import UNKNOWN
from vrut_lite.recording.entry import Entry

# Relative tolerance of numbers, seventeen times the largest difference measured between processors:
# a number in float32 differs by its last bit, 1.2e-7, and a sum of float32 kernels by a few bits.
SCALAR_TOLERANCE = 1e-5
# Relative tolerance of samples, forty times the largest measured difference.
SAMPLE_TOLERANCE = 1e-3
# A number this small is the rounding of a difference of larger numbers in float64.
_ZERO = 1e-12
# Beside the largest value of its array, a sample this small is rounding: a thousandth of it is
# less than the last bit of the largest in float32.
_NEGLIGIBLE = 1e-4
_LONGEST_TEXT = 120

Difference = str | None


def entry_difference(there: Entry, here: Entry, by_value: bool) -> Difference:
    """How an entry `here` differs from the recorded one, as a phrase; None if it does not.

    By value, scalars may differ by SCALAR_TOLERANCE, relative, and the sampled values of arrays
    by SAMPLE_TOLERANCE; else digests must be equal.
    """
    if (there.kind, there.type_name, there.sender) != (here.kind, here.type_name, here.sender):
        return f"it is {_title(here)} here and {_title(there)} in the journal"
    if there.digest == here.digest:
        return None
    return _compare(
        there.message,
        here.message,
        "",
        _close if by_value else _same,
        _samples_differ if by_value else _contents_differ,
    )


def _title(entry: Entry) -> str:
    return f"a {entry.type_name} from {entry.sender}"


ScalarRule = Callable[[Any, Any], bool]
ArrayRule = Callable[[list[Any], list[Any]], Difference]


def _compare(there: Any, here: Any, path: str, same: ScalarRule, arrays: ArrayRule) -> Difference:
    """The first difference of two plain values, its path before it."""
    if there == UNKNOWN:
        return None
    if isinstance(there, dict) and isinstance(here, dict):
        if "$array" in there and "$array" in here:
            return _compare_arrays(there, here, path, arrays)
        return _compare_objects(there, here, path, same, arrays)
    if isinstance(there, list) and isinstance(here, list):
        if len(there) != len(here):
            return f"{path} has {len(here)} values here and {len(there)} in the journal"
        found = (
            _compare(a, b, f"{path}[{i}]", same, arrays)
            for i, (a, b) in enumerate(zip(there, here, strict=True))
        )
        return next((difference for difference in found if difference), None)
    if same(there, here):
        return None
    return f"{path} is {_short(here)} here and {_short(there)} in the journal"


def _compare_objects(
    there: dict[str, Any], here: dict[str, Any], path: str, same: ScalarRule, arrays: ArrayRule
) -> Difference:
    for name in sorted(here.keys() - there.keys()):
        return f"the journal knows no field {_short(_join(path, name))}"
    for name in sorted(there.keys() - here.keys()):
        return f"the journal's field {_short(_join(path, name))} is unknown here"
    found = (_compare(there[n], here[n], _join(path, n), same, arrays) for n in here)
    return next((difference for difference in found if difference), None)


def _compare_arrays(
    there: dict[str, Any], here: dict[str, Any], path: str, rule: ArrayRule
) -> Difference:
    if there["$array"] == here["$array"]:
        return None
    for fact in ("dtype", "shape"):
        if there.get(fact) != here.get(fact):
            said = f"{here.get(fact)} here and {there.get(fact)} in the journal"
            return f"{path} has {fact} {one_line(said, 2 * _LONGEST_TEXT)}"
    difference = rule(_numbers(there), _numbers(here))
    return f"{path}: {difference}" if difference else None


def _contents_differ(there: list[Any], here: list[Any]) -> Difference:
    differing = sum(a != b for a, b in zip(there, here, strict=False))
    worst = _worst(there, here)
    return (
        f"its content differs, {differing} of {len(here)} sampled values do, "
        f"by up to {worst:.2g} relative"
    )


def _samples_differ(there: list[Any], here: list[Any]) -> Difference:
    worst = _worst(there, here)
    if worst <= SAMPLE_TOLERANCE:
        return None
    return f"sampled values differ by up to {worst:.2g} relative, over {SAMPLE_TOLERANCE:g}"


def _worst(there: list[Any], here: list[Any]) -> float:
    """The largest relative difference; infinite where only one has a value."""
    if len(there) != len(here):
        return math.inf
    finite = [abs(value) for value in (*there, *here) if math.isfinite(value)]
    floor = _NEGLIGIBLE * max(finite, default=0.0)
    worst = 0.0
    for a, b in zip(there, here, strict=True):
        if a == b or (math.isnan(a) and math.isnan(b)):
            continue
        if not (math.isfinite(a) and math.isfinite(b)):
            return math.inf
        worst = max(worst, abs(a - b) / max(abs(a), abs(b), floor))
    return worst


def _numbers(handle: dict[str, Any]) -> list[float]:
    """The sampled values of an array's handle; nan for a value that is not a number."""
    sample = handle.get("sample")
    return [_number(value) for value in sample] if isinstance(sample, list) else []


def _number(value: Any) -> float:
    if isinstance(value, dict):
        return {"inf": math.inf, "-inf": -math.inf}.get(str(value.get("$float")), math.nan)
    if isinstance(value, int) and abs(value) >= 2**64:  # No element of an array; float() overflows.
        return math.nan
    return float(value) if isinstance(value, bool | int | float) else math.nan


def _close(there: Any, here: Any) -> bool:
    if isinstance(there, float) and isinstance(here, float):
        return math.isclose(there, here, rel_tol=SCALAR_TOLERANCE, abs_tol=_ZERO)
    return _same(there, here)


def _same(there: Any, here: Any) -> bool:
    # 1, 1.0 and True are equal in Python and different in a journal.
    return type(there) is type(here) and there == here


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def _short(value: Any) -> str:
    return one_line(repr(value), _LONGEST_TEXT)

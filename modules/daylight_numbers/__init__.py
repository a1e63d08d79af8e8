"""Daylight in numbers: illuminance at sensors, daylight factors, a year.

Rays from each sensor are traced once and kept as a matrix over cells of the sky and patches of the
light map; an hour or a year is then a product.
"""

from importlib import import_module
from typing import Any

# Imported at their first use: a start imports no compiler.
_FOUND_IN = {
    "annual": "daylight_numbers.year.year",
    "colour_temperature": "daylight_numbers.spectra.colour_temperature",
    "daylight_factor": "daylight_numbers.now",
    "eye_responses": "daylight_numbers.spectra.eye_responses",
    "numbers_now": "daylight_numbers.now",
    "work_of": "daylight_numbers.work",
}


def __getattr__(name: str) -> Any:
    if name not in _FOUND_IN:
        raise AttributeError(f"daylight_numbers has no {name}")
    return getattr(import_module(_FOUND_IN[name]), name)

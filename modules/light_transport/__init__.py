"""Light between the surfaces of a scene, baked once and relit by the hour.

From places on all surfaces rays are traced once; where they end is kept as counts. The light of an
hour is then a few sparse products: daylight coefficients (Tregenza and Waters 1983) and radiosity.
"""

from importlib import import_module
from typing import Any

# Taken from their files when they are asked for: a start imports no compiler.
_FOUND_IN = {
    "annual": "light_transport.daylight_numbers.annual",
    "daylight_factor": "light_transport.daylight_numbers.now",
    "numbers_now": "light_transport.daylight_numbers.numbers_now",
    "work_of": "light_transport.daylight_numbers.work",
}


def __getattr__(name: str) -> Any:
    if name not in _FOUND_IN:
        raise AttributeError(f"light_transport has no {name}")
    return getattr(import_module(_FOUND_IN[name]), name)

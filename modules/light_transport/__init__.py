"""Light between the surfaces of a scene, baked once and relit by the hour.

From places on all surfaces rays are traced once; where they end is kept as counts. The light of an
hour is then a few sparse products: daylight coefficients (Tregenza and Waters 1983) and radiosity.
"""

from importlib import import_module
from typing import Any

# Names that scripts of earlier versions import from here.
_OF_DAYLIGHT_NUMBERS = ("annual", "daylight_factor", "numbers_now", "work_of")


def __getattr__(name: str) -> Any:
    if name not in _OF_DAYLIGHT_NUMBERS:
        raise AttributeError(f"light_transport has no {name}")
    return getattr(import_module("daylight_numbers"), name)

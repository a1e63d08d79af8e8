"""Light between the surfaces of a scene, baked once and relit by the hour.

From places on all surfaces rays are traced once; where they end is kept as counts. The light of an
hour is then a few sparse products: daylight coefficients (Tregenza and Waters 1983) and radiosity.
"""

from vrut_lite.deprecation import MovedNames

# Light transport was the home of daylight numbers.
_MOVED = ("annual", "daylight_factor", "numbers_now", "work_of")
__getattr__ = MovedNames(__name__, dict.fromkeys(_MOVED, "daylight_numbers"), since="1.0")

"""The reach of a volume of air, in steps, so that few moves of the camera need a new volume.

A move of the camera changes how far off the things in its view stand. A volume that reaches too
far loses little sharpness, since its slices are dense near the eye; a new volume at each move would
cost more than it saves.
"""

import math

# The smallest share of light, taken or added by air, that is seen: below a step of 10 bits in
# display values.
UNSEEN_SHARE = 5e-4
_RUNG = math.sqrt(2.0)
# A lower rung is taken when it exceeds the need by this factor.
_SLACK = 1.1
# A metre of air is not seen: no lower rung is needed.
_LOWEST_M = 1.0


def rung_m(needed_m: float, shown_m: float = 0.0) -> float:
    """The reach (m) of a volume that needs `needed_m`; `shown_m` again while that still serves.

    0 where nothing is needed.
    """
    if needed_m <= 0.0:
        return 0.0
    if _rung(needed_m) <= shown_m <= _rung(needed_m * _SLACK):
        return shown_m
    return _rung(needed_m)


def _rung(needed_m: float) -> float:
    steps = math.ceil(math.log(max(needed_m / _LOWEST_M, 1.0), _RUNG) - 1e-9)
    return float(_LOWEST_M * _RUNG**steps)

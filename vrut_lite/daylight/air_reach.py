"""How far a volume of air is made to reach: in rungs, so that few moves ask for another.

A camera's move changes how far off the things in its view stand. A volume that reaches too far
loses little sharpness, since its slices are dense near the eye; one made anew at each move would
cost what it was made to save.
"""

import math

# Share of light that air must take or add to be seen: below a step of 10 bits in display values.
UNSEEN_SHARE = 5e-4
_RUNG = math.sqrt(2.0)
# So much less must be needed than a rung below before that is stepped down to.
_SLACK = 1.1
# Air of a metre is not seen: no finer steps are needed.
_LOWEST_M = 1.0


def rung_m(needed_m: float, shown_m: float = 0.0) -> float:
    """The reach to make for what is needed, both in m; `shown_m` again where that still serves.

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

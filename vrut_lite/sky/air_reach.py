"""Rounds the reach of a volume of air up to rungs, so that few camera moves need a new volume.

A volume that reaches too far loses little resolution, since its slices are dense near the eye; a
new one at each move would cost more than the volume saves.
"""

import math

# Share of light that air must remove or add to be visible: below a step of 10 bits on a display.
UNSEEN_SHARE = 5e-4
_RUNG = math.sqrt(2.0)
# The need must be this factor below the lower rung before the reach steps down to it.
_SLACK = 1.1
# A metre of air is invisible, so no finer rungs are needed.
_LOWEST_M = 1.0


def rung_m(needed_m: float, shown_m: float = 0.0) -> float:
    """The reach to compute for a needed reach, both in m; 0 if nothing is needed.

    The present reach `shown_m` is kept while it is large enough and at most a rung too large.
    """
    if needed_m <= 0.0:
        return 0.0
    if _rung(needed_m) <= shown_m <= _rung(needed_m * _SLACK):
        return shown_m
    return _rung(needed_m)


def _rung(needed_m: float) -> float:
    steps = math.ceil(math.log(max(needed_m / _LOWEST_M, 1.0), _RUNG) - 1e-9)
    return float(_LOWEST_M * _RUNG**steps)

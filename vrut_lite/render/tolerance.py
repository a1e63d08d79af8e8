"""What of a frame follows the tolerance of radiance.

| knob | what it is | source |
|---|---|---|
| `reflection_change` | by what a sky may differ from the one that is mirrored | proportion |

It bounds the change itself, so that no front has to be measured. Sizes and samples of the filtered
map do not follow: they are held to 1 % of the brightest by `tests/render/test_reflection.py`.
"""

from vrut_lite.daylight.tolerance import budget
from vrut_lite.render.specular_filter import CHANGE_SEEN


def reflection_change(tolerance: float) -> float:
    """Share by which no coarse cell of the sky may differ from the one that is mirrored."""
    return budget(tolerance, CHANGE_SEEN, 0.5)

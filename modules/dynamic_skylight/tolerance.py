"""DynamicSkyLight's sizes and thresholds for a tolerance of radiance.

| knob | what it is | source |
|---|---|---|
| `cube_size` | edge of the background's cube map where no consumer names one | front "cube_size" |
| `light_size` | edge of the small cube that lights ground and scene | front "light_size" |
| `sun_change` | share by which the sun may change a texel unseen | `sun_step` and its test |
| `altitude_change` | share by which air may thin over unseen moves of the eye | proportion |

The model itself is a formula: no order or sample of it depends on the tolerance. The fronts are
measured by `vrut_lite_lab.tolerance_fronts`.
"""

from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from vrut_lite.messages.tolerance import budget, cheapest, read_fronts

FRONTS = Path(__file__).parent / "data" / "tolerance_fronts.json"
# Budget of cube map and light at the default tolerance, about half a step of 8 bits at the
# display's white; and the share of each in a tight tolerance.
_USUAL, _CUBE_SHARE, _LIGHT_SHARE = 0.006, 0.5, 0.45


class HosekWilkieQuality(NamedTuple):
    """Sizes and thresholds; see the module's table."""

    cube_size: int
    light_size: int
    sun_change: float
    altitude_change: float


@lru_cache(maxsize=16)
def quality_for(tolerance: float) -> HosekWilkieQuality:
    """The cheapest sizes that keep a picture within a tolerance of radiance, a share above 0."""
    fronts = read_fronts(FRONTS).fronts
    return HosekWilkieQuality(
        cube_size=int(cheapest(fronts["cube_size"], budget(tolerance, _USUAL, _CUBE_SHARE))),
        light_size=int(cheapest(fronts["light_size"], budget(tolerance, _USUAL, _LIGHT_SHARE))),
        sun_change=budget(tolerance, 1e-3, 0.1),
        altitude_change=budget(tolerance, 0.01, 0.2),
    )

"""The sizes of light transport for a tolerance of radiance.

| knob | sizes | source |
|---|---|---|
| `texels` | about how many texels a scene gets, where none are named by size | front "texels" |
| `rays` | of each texel in a finished bake | front "rays" |
| `patch_texels` | edge of the patches that carry bounces, in texels | front "patch_texels" |
| `bounces_left` | share of the light that bounces left out may bring | proportion; "bounces" |
| `hour_change`, `sun_rad` | invisible moves of sky and sun | proportion |

At the default tolerance sizes are finer than it asks for: noise is seen as a pattern, and coarse
texels as missing shadows. The fronts are measured by `vrut_lite_lab.tolerance_fronts`.
"""

from collections.abc import Mapping
from functools import lru_cache
from math import radians
from pathlib import Path
from types import MappingProxyType
from typing import Literal, NamedTuple, get_args

from vrut_lite.messages.tolerance import budget, cheapest, read_fronts

FRONTS = Path(__file__).parent / "data" / "tolerance_fronts.json"
Rung = Literal["draft", "usual", "fine", "finest"]
RUNGS: tuple[Rung, ...] = get_args(Rung)
# At the default tolerance, and shares of a tight one; these errors add up by squares.
_TEXELS, _RAYS, _PATCHES = 0.055, 0.015, 0.045
_SHARE = 0.6
_BOUNCES_SHARE = 0.03


class Quality(NamedTuple):
    """Sizes and thresholds; see the module's table."""

    texels: int
    rays: int
    patch_texels: float
    bounces_left: float
    hour_change: float
    sun_rad: float


_OF_RUNG: Mapping[Rung, Quality] = MappingProxyType(
    {
        "draft": Quality(30_000, 128, 4.0, 0.01, 0.01, radians(0.2)),
        "usual": Quality(60_000, 256, 3.0, 0.003, 0.005, radians(0.1)),
        "fine": Quality(120_000, 512, 3.0, 0.001, 0.002, radians(0.05)),
        "finest": Quality(240_000, 1024, 2.0, 0.0005, 0.001, radians(0.02)),
    }
)


@lru_cache(maxsize=16)
def quality_for(tolerance: float, rung: Rung | None = None) -> Quality:
    """The sizes of a rung; without one the cheapest within a tolerance, a share above 0."""
    if rung is not None:
        return _OF_RUNG[rung]
    fronts = read_fronts(FRONTS).fronts
    return Quality(
        texels=int(cheapest(fronts["texels"], budget(tolerance, _TEXELS, _SHARE))),
        rays=int(cheapest(fronts["rays"], budget(tolerance, _RAYS, _SHARE))),
        patch_texels=float(cheapest(fronts["patch_texels"], budget(tolerance, _PATCHES, _SHARE))),
        bounces_left=_BOUNCES_SHARE * tolerance,
        hour_change=budget(tolerance, 0.005, 0.1),
        sun_rad=radians(budget(tolerance, 0.1, 2.0)),
    )

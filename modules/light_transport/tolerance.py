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

import math
from collections.abc import Mapping
from functools import lru_cache
from math import radians
from pathlib import Path
from types import MappingProxyType
from typing import Literal, NamedTuple, get_args

import numpy as np

from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.tolerance import budget, cheapest, read_fronts

FRONTS = Path(__file__).parent / "data" / "tolerance_fronts.json"
Rung = Literal["draft", "usual", "fine", "finest"]
RUNGS: tuple[Rung, ...] = get_args(Rung)
# At the default tolerance, and shares of a tight one; these errors add up by squares.
_TEXELS, _RAYS, _PATCHES = 0.055, 0.015, 0.045
_SHARE = 0.6
_BOUNCES_SHARE = 0.03


class TransportSizes(NamedTuple):
    """Sizes of a light map and its patches.

    Texels have the edge `texel_m`, or, where it is None, are about so many; patches are
    `patch_texels` of them wide. `bounces_left`: see `RayScene`.
    """

    texel_m: float | None
    texels: int
    patch_texels: float
    bounces_left: float


class TransportQuality(NamedTuple):
    """Sizes and thresholds; see the module's table."""

    texels: int
    rays: int
    patch_texels: float
    bounces_left: float
    hour_change: float
    sun_rad: float


_OF_RUNG: Mapping[Rung, TransportQuality] = MappingProxyType(
    {
        "draft": TransportQuality(30_000, 128, 4.0, 0.01, 0.01, radians(0.2)),
        "usual": TransportQuality(60_000, 256, 3.0, 0.003, 0.005, radians(0.1)),
        "fine": TransportQuality(120_000, 512, 3.0, 0.001, 0.002, radians(0.05)),
        "finest": TransportQuality(240_000, 1024, 2.0, 0.0005, 0.001, radians(0.02)),
    }
)


@lru_cache(maxsize=16)
def quality_for(tolerance: float, rung: Rung | None = None) -> TransportQuality:
    """The sizes of a rung; without one the cheapest within a tolerance, a share above 0."""
    if rung is not None:
        return _OF_RUNG[rung]
    fronts = read_fronts(FRONTS).fronts
    return TransportQuality(
        texels=int(cheapest(fronts["texels"], budget(tolerance, _TEXELS, _SHARE))),
        rays=int(cheapest(fronts["rays"], budget(tolerance, _RAYS, _SHARE))),
        patch_texels=float(cheapest(fronts["patch_texels"], budget(tolerance, _PATCHES, _SHARE))),
        bounces_left=_BOUNCES_SHARE * tolerance,
        hour_change=budget(tolerance, 0.005, 0.1),
        sun_rad=radians(budget(tolerance, 0.1, 2.0)),
    )


def looks_like(
    now: SkyLightChanged, before: SkyLightChanged, change: float, sun_rad: float
) -> bool:
    """Whether light on surfaces differs invisibly from that of another hour.

    Args:
        now: an hour, with `radiance`.
        before: another.
        change: share of the brightest irradiance by sky and key light that may change.
        sun_rad: largest invisible move of the key light.
    """
    if (_source(now), now.key_light.body) != (_source(before), before.key_light.body):
        return False
    moved = math.dist(now.key_light.direction, before.key_light.direction)
    return moved <= sun_rad and _largest_change(now, before) <= change


def _largest_change(now: SkyLightChanged, before: SkyLightChanged) -> float:
    """Largest change of any harmonic, the key light or the ground, over the larger irradiance."""
    one, other = _irradiances(now), _irradiances(before)
    brightest = max(np.abs(one).max(), np.abs(other).max())
    return float(np.abs(one - other).max() / brightest) if brightest > 0.0 else 0.0


def _source(hour: SkyLightChanged) -> str:
    return hour.lighting.source


def _irradiances(hour: SkyLightChanged) -> np.ndarray:
    ground = np.pi * np.asarray(hour.lighting.ground_radiance_rgb)
    key_light = np.asarray(hour.key_light.irradiance_rgb)
    return np.vstack([hour.ambient.irradiance_sh_rgb.values, ground, key_light])

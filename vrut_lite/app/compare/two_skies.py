"""Two skies of one hour from the second kernel: each module in turn holds the slot `sky`.

Both have the same optical depth of haze. Settings of equal names, such as albedo, have one value
for both.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.app.engine.preview_kernel import PreviewKernel
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.panorama import fisheye_directions, sample_sky
from vrut_lite.kernel.messages import ChooseSlot, Demand, SetClock
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import BackgroundChanged, LookAlong, SpectrumSeen
from vrut_lite.messages.sun import SunMoved
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector

CUBE_SIZE = 128
# Pixels of a fisheye are compared above an elevation of 5 degrees.
_LOWEST_UP = np.sin(np.radians(5.0))
_FISHEYE_SIZE = 64


class SkyWish(NamedTuple):
    """A request for skies: two modules of the slot `sky`, and the holder of `sun`.

    `settings` are by module and name; `shared` are those that both have.
    """

    modules: tuple[str, str]
    sun: str
    place: SetPlace
    clock: SetClock
    haze: SetHaze
    settings: dict[tuple[str, str], object]
    shared: dict[str, float]


class SkyLook(NamedTuple):
    """One module's sky: radiance (6, n, n, 3) without the disc, W m^-2 sr^-1."""

    module: str
    cube: Float32Array


class TwoSkies(NamedTuple):
    """Both skies, and the sun that makes them."""

    wish: SkyWish
    looks: tuple[SkyLook, SkyLook]
    sun: SunMoved


def look_at_skies(second: PreviewKernel, wish: SkyWish) -> TwoSkies:
    """Both skies of a request.

    Raises:
        UserError: a module has no such sky.
        ModuleFailed: a module failed.
    """
    second.faults.faults.clear()
    _demand_sky(second, CUBE_SIZE)
    try:
        sun = _set_up(second, wish)
        left, right = (_sky_of(second, module) for module in wish.modules)
    finally:
        # A search in another day's sun must not compute a sky for each sample.
        _demand_sky(second, 0)
    return TwoSkies(wish, (left, right), sun)


def spectra_along(
    second: PreviewKernel, wish: SkyWish, direction: Vector
) -> list[SpectrumSeen | None]:
    """The spectra of both skies in a world direction; None for a module without spectra."""
    _set_up(second, wish)
    spectra = []
    for module in wish.modules:
        _hold_sky(second, module)
        second.kernel.inject(LookAlong(direction=direction))
        second.kernel.pump_until_idle()
        seen = second.kernel.last(SpectrumSeen)
        spectra.append(seen if seen is not None and seen.source == module else None)
    return spectra


def _set_up(second: PreviewKernel, wish: SkyWish) -> SunMoved:
    second.kernel.inject(wish.haze)
    second.set_up(wish.place, wish.sun, wish.settings)
    sun = second.sun_at(wish.clock.instant)
    if sun is None:
        raise UserError("no module tells where the sun stands: there is no sky to compare")
    return sun


def _sky_of(second: PreviewKernel, module: str) -> SkyLook:
    _hold_sky(second, module)
    second.faults.raise_first()
    background = second.kernel.last(BackgroundChanged)
    if background is None or background.source != module:
        raise UserError(f"{module} shows no sky at this hour")
    assert isinstance(background.cube, Array)
    return SkyLook(module, decode_float16(background.cube.values, background.radiance_scale))


def _hold_sky(second: PreviewKernel, module: str) -> None:
    second.kernel.inject(ChooseSlot(slot="sky", module=module))
    second.kernel.pump_until_idle()


def _demand_sky(second: PreviewKernel, size: int) -> None:
    demand = Demand(consumer="comparison", message=BackgroundChanged.__name__, size=size)
    second.kernel.inject(demand)
    second.kernel.pump()


def meridian_luminance(
    cube: NDArray[np.float32], sun: SunMoved, angle_deg: FloatArray
) -> FloatArray:
    """Luminance (n,) in cd/m2 along the sun's meridian, at angles (n,) from the zenith.

    Positive angles lie on the sun's side.
    """
    x, _, z = sun.direction
    level = float(np.hypot(x, z))
    side = np.array([x, 0.0, z]) / level if level > 1e-9 else np.array([0.0, 0.0, -1.0])
    angle = np.radians(angle_deg)[:, None]
    direction = np.cos(angle) * np.array([0.0, 1.0, 0.0]) + np.sin(angle) * side
    return luminance_of(cube, direction)


def luminance_of(cube: NDArray[np.float32], direction: FloatArray) -> FloatArray:
    """Luminance (...,) in cd/m2 in world directions (..., 3)."""
    return np.asarray(luminance(sample_sky(cube, direction)) * LUMENS_PER_WATT)


def luminance_ratios(two: TwoSkies) -> tuple[float, float, float]:
    """The right sky's luminance over the left's: 5th percentile, median, 95th.

    Over the sky more than 5 degrees above the horizon, each pixel of a fisheye counted once.
    """
    directions, inside = fisheye_directions(_FISHEYE_SIZE)
    up = directions[inside & (directions[..., 1] > _LOWEST_UP)]
    left, right = (luminance_of(look.cube, up) for look in two.looks)
    low, middle, high = np.percentile(right / np.maximum(left, 1e-12), [5.0, 50.0, 95.0])
    return float(low), float(middle), float(high)

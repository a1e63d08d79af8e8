"""Two skies at one hour, asked of the modules that make them, on a kernel of its own.

The window's own kernel shows one sky, its slot's holder's. A second kernel, on which nobody
draws, is given the same place, hour and settings, and each module in turn holds its sky. What
both modules call by one name, turbidity and albedo say, is set to one value for both: models are
compared at equal air.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.daylight.daylight_kernel import FaultCollector
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.sky import BackgroundChanged, LookAlong, SpectrumSeen
from vrut_lite.daylight.sun import SunMoved
from vrut_lite.discovery import discover
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.panorama import fisheye_directions, sample_sky
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Demand, SetClock, SetSetting
from vrut_lite.numeric_types import FloatArray, Vector

CUBE_SIZE = 128
# Of a fisheye's pixels, those so far above the horizon are compared.
_LOWEST_UP = np.sin(np.radians(5.0))
_FISHEYE_SIZE = 64


class Settings(NamedTuple):
    """Settings of the twin: `own` by module and name, `shared` by name."""

    own: dict[tuple[str, str], object]
    shared: dict[str, float]


class SkyWish(NamedTuple):
    """Which skies are asked for: two modules of the slot `sky`, and who holds `sun`."""

    modules: tuple[str, str]
    sun: str
    place: SetPlace
    clock: SetClock
    settings: Settings


class SkyLook(NamedTuple):
    """One module's sky: radiance (6, n, n, 3) without the disc, W m^-2 sr^-1."""

    module: str
    cube: NDArray[np.float32]


class TwoSkies(NamedTuple):
    """Both skies, and the sun that makes them."""

    wish: SkyWish
    looks: tuple[SkyLook, SkyLook]
    sun: SunMoved


class TwinSkies:
    """The kernel that is asked; all calls from one thread."""

    def __init__(self) -> None:
        self._kernel = Kernel()
        for module in discover()[0]:
            if {"sun", "sky"} & set(module.manifest.provides) and not module.brings:
                self._kernel.add_module(module)
        self._faults = FaultCollector(self._kernel)
        demand = Demand(consumer="comparison", message=BackgroundChanged.__name__, size=CUBE_SIZE)
        self._kernel.inject(demand)
        self._kernel.pump()

    def look(self, wish: SkyWish) -> TwoSkies:
        """Both skies of a wish.

        Raises:
            UserError: a module has no such sky, or failed.
        """
        self._faults.faults.clear()
        if wish.sun in self._kernel.seats:
            self._kernel.inject(ChooseSlot(slot="sun", module=wish.sun))
        for message in (wish.place, wish.clock, *self._setting_inputs(wish.settings)):
            self._kernel.inject(message)
        left, right = (self._look(module) for module in wish.modules)
        sun = self._kernel.last(SunMoved)
        if sun is None:
            raise UserError("no module tells where the sun stands: there is no sky to compare")
        return TwoSkies(wish, (left, right), sun)

    def spectra(self, wish: SkyWish, direction: Vector) -> list[SpectrumSeen | None]:
        """What the modules of a wish that was looked at last tell of a world direction."""
        return [self._spectrum(module, direction) for module in wish.modules]

    def close(self) -> None:
        """Cancel what still runs."""
        self._kernel.close()

    def _setting_inputs(self, settings: Settings) -> list[SetSetting]:
        seats = self._kernel.seats
        values = {key: value for key, value in settings.own.items() if key[0] in seats}
        for module, seat in seats.items():
            for name, shared in settings.shared.items():
                if hasattr(seat.settings, name):
                    values[module, name] = shared
        return [
            SetSetting(module=module, name=name, value=value)
            for (module, name), value in values.items()
            if getattr(seats[module].settings, name) != value
        ]

    def _look(self, module: str) -> SkyLook:
        self._hold_sky(module)
        self._faults.raise_first()
        background = self._kernel.last(BackgroundChanged)
        if background is None or background.source != module:
            raise UserError(f"{module} shows no sky at this hour")
        assert isinstance(background.cube, Array)
        cube = decode_float16(background.cube.values, background.radiance_scale)
        return SkyLook(module, cube)

    def _spectrum(self, module: str, direction: Vector) -> SpectrumSeen | None:
        self._hold_sky(module)
        self._kernel.inject(LookAlong(direction=direction))
        self._kernel.pump_until_idle()
        seen = self._kernel.last(SpectrumSeen)
        return seen if seen is not None and seen.source == module else None

    def _hold_sky(self, module: str) -> None:
        self._kernel.inject(ChooseSlot(slot="sky", module=module))
        self._kernel.pump_until_idle()


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

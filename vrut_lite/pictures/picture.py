"""A drawn picture: its radiance and its display values."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.preview import png
from vrut_lite.messages.picture import NightLook
from vrut_lite.pictures.exposure import automatic_ev100, metered_ev100
from vrut_lite.pictures.luminance_histogram import luminances_of
from vrut_lite.pictures.value_picture import Values


@dataclass(frozen=True)
class Picture:
    """A drawn frame.

    radiance (h, w, 3) float32 is linear sRGB in W m^-2 sr^-1, display (h, w, 3) uint8 is
    sRGB-encoded, row 0 at the top; `ev100` is the exposure used. A picture in false colours has
    `values`, and `radiance` holds them in each channel, 0 without a value. `pixel_rad` is the angle
    that a pixel in the middle sees, 0 where unknown. `shown` is the radiance behind `display` where
    it is another, as without grain.
    """

    radiance: NDArray[np.float32]
    display: NDArray[np.uint8]
    ev100: float
    values: Values | None = None
    pixel_rad: float = 0.0
    shown: NDArray[np.float32] | None = None

    def _repr_png_(self) -> bytes:
        """The picture as PNG, for notebooks."""
        return png(self.display)

    def luminance_cd_m2(self, x: int, y: int) -> float:
        """Luminance of a pixel in cd m^-2; x counts from the left, y from the top.

        Raises:
            ValueError: there is no such pixel.
        """
        height, width = self.radiance.shape[:2]
        if not (0 <= x < width and 0 <= y < height):
            raise ValueError(f"the picture has {width} x {height} pixels, none at ({x}, {y})")
        return float(luminance(self.radiance[y, x])) * LUMENS_PER_WATT

    def metered_ev100(self, white: float, night_look: NightLook, enough: int) -> float:
        """EV100 by which `automatic_ev100` would expose it, by about `enough` of its pixels."""
        return automatic_ev100(self.radiance, white, night_look, enough)


class PictureOnCard(Picture):
    """A moving picture that a graphics card drew: its radiance is read when it is asked for.

    The first reading waits for the card. `read_radiance` raises a UserError where the card no
    longer has it; `counts` is the picture's `luminance_histogram`.
    """

    def __init__(
        self,
        read_radiance: Callable[[], NDArray[np.float32]],
        counts: NDArray[np.uint32],
        display: NDArray[np.uint8],
        ev100: float,
        pixel_rad: float,
    ):
        facts = {"display": display, "ev100": ev100, "pixel_rad": pixel_rad}
        own = {"counts": counts, "_read_radiance": read_radiance}
        for name, value in (facts | {"values": None, "shown": None} | own).items():
            object.__setattr__(self, name, value)

    counts: NDArray[np.uint32]
    _read_radiance: Callable[[], NDArray[np.float32]]

    @cached_property
    def radiance(self) -> NDArray[np.float32]:
        """Radiance (h, w, 3), as of any picture."""
        return self._read_radiance()

    def metered_ev100(self, white: float, night_look: NightLook, enough: int) -> float:
        """The same by the card's histogram, without its radiance."""
        return metered_ev100(luminances_of(self.counts, enough), white, night_look)

"""A drawn picture: its radiance and its display values."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.preview import png
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

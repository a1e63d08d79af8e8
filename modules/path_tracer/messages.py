"""Messages of the path tracer."""

from vrut_lite.array import Array
from vrut_lite.kernel.messages import Derived


class PathTracedPicture(Derived, frozen=True, kw_only=True):
    """The picture so far; consumers demand it by this name.

    radiance (height_px, width_px, 3) float32 is linear sRGB in W m^-2 sr^-1, row 0 at the top:
    the mean of `samples` paths a pixel, of `samples_wanted`. `pixel_rad` is the angle that a pixel
    in the middle sees.
    """

    radiance: Array
    width_px: int
    height_px: int
    samples: int
    samples_wanted: int
    pixel_rad: float = 0.0


class PictureOutdated(Derived, frozen=True, kw_only=True):
    """To the path tracer itself: restart the picture after all changes have been heard."""

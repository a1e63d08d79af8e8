"""Which pixels of a lat-long photograph show clear sky, and where in it the sun stands.

A photograph is linear RGB (h, 2 h, 3) of unknown unit. Its azimuths count clockwise from the
middle column; where north is, is not known.
"""

from typing import NamedTuple

import numpy as np
from scipy import ndimage

from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.numeric_types import BoolArray, FloatArray

# The level horizon is seldom the camera's own: so much above it is left out in any case.
HORIZON_MARGIN_DEG = 2.0
# Around the sun a photograph holds flare, blooming and the blocks of its compression.
GLARE_DEG = 10.0
# A disc in view is brighter than its surroundings by far more than this.
_DISC_CONTRAST = 10.0
# From this share of a channel's maximum up a value may be clipped.
_CLIPPED_SHARE = 0.7
# What stands before the sky is looked for below this elevation only.
_TALLEST_DEG = 32.0
# Natural logarithms: a step down at the edge of the land, and the roughness of clouds.
_EDGE, _ROUGH = 0.3, 0.06
# Wires and wisps differ less, but from what lies right beside them.
_FINE = 0.025
# Sky in gaps narrower than this, between clouds or wires, is not trusted to be clear.
_GAP_DEG = 6.0
# Away from the sun blue under this share of green is no sky: grass, leaves, lit walls.
_LEAST_BLUE = 0.7


class Sun(NamedTuple):
    """Where the sun stands, in degrees; `in_view` if its disc was found."""

    azimuth_deg: float
    elevation_deg: float
    in_view: bool

    def direction(self) -> FloatArray:
        """Unit vector (3,) in world axes."""
        angles = np.radians([self.azimuth_deg, self.elevation_deg])
        return world_from_enu(direction_from_angles(*angles))


class Masks(NamedTuple):
    """Pixels (h, 2 h) left out, by reason."""

    land: BoolArray
    cloud: BoolArray
    clipped: BoolArray
    glare: BoolArray

    @property
    def usable(self) -> BoolArray:
        """Clear sky that the photograph has measured."""
        return ~(self.land | self.cloud | self.clipped | self.glare)


def elevations_deg(height: int) -> FloatArray:
    """Elevation (h,) of each row of a lat-long picture."""
    return (0.5 - (np.arange(height) + 0.5) / height) * 180.0


def find_disc(photo: FloatArray) -> Sun | None:
    """The sun by its disc: the centre of the brightest pixels; None if nothing is that bright."""
    light = luminance(photo)
    height = light.shape[0]
    row, column = np.unravel_index(int(light.argmax()), light.shape)
    peak = light[row, column]
    around = np.degrees(_angle_from(height, _at_pixel(height, float(row), float(column))))
    # Much of the ring may be dark land: it is the sky in it that counts.
    ring = np.quantile(light[(around > 3.0) & (around < 6.0)], 0.9)
    if peak < _DISC_CONTRAST * ring:
        return None
    rows, columns = np.nonzero((light > 0.4 * peak) & (around < 3.0))
    # Columns are counted from the peak's, so that a sun at the picture's edge stays whole.
    across = (columns - column + height) % (2 * height) - height
    weight = light[rows, columns]
    return _at_pixel(
        height,
        float(np.average(rows, weights=weight)),
        float(column + np.average(across, weights=weight)),
    )


def find_azimuth_deg(photo: FloatArray, usable: BoolArray) -> float:
    """Azimuth of a sun that is not in view: the sky is a mirror image about it, and brighter.

    The logarithms of luminance from 5 to 60 deg are compared with their mirror image about
    each half column; of the two best (sun and opposite) the one whose side is brighter.
    """
    height = photo.shape[0]
    elevation = elevations_deg(height)
    band = (elevation > 5.0) & (elevation < 60.0)
    seen = usable[band]
    log = np.log(np.where(seen, luminance(photo)[band], 1.0))
    count = 2 * height
    costs = np.full(count, np.inf)
    for doubled in range(count):
        mirror = (doubled - np.arange(count)) % count
        both = seen & seen[:, mirror]
        if both.mean() > 0.2:
            costs[doubled] = np.abs(log - log[:, mirror])[both].mean()
    best = int(costs.argmin())
    centre = best / 2.0
    ahead = np.cos(2.0 * np.pi * (np.arange(count) - centre) / count)[None, :]
    if float((log * ahead)[seen].sum() - log[seen].mean() * (seen * ahead).sum()) < 0.0:
        centre += height
    return _at_pixel(height, 0.0, centre % count).azimuth_deg


def masks_of(photo: FloatArray, sun: Sun | None) -> Masks:
    """Pixels of land, cloud (with gaps), clipping or glare; without a disc no glare."""
    height = photo.shape[0]
    degree = height / 180.0
    brightest = photo.max(axis=(0, 1))
    # Values below zero are what compression makes of clipped neighbours.
    broken = (photo <= 0.0).any(axis=-1) | (photo >= _CLIPPED_SHARE * brightest).any(axis=-1)
    clipped = _grown(broken, 1.0 * degree)
    glare = np.zeros(photo.shape[:2], dtype=bool)
    if sun is not None:
        glare = np.degrees(_angle_from(height, sun)) < GLARE_DEG
    land = _land(photo, glare)
    other = land | clipped | glare
    closed = _closed(_cloud(photo, other) | other, 0.5 * _GAP_DEG * degree)
    return Masks(land, closed & ~other, clipped, glare)


def _land(photo: FloatArray, glare: BoolArray) -> BoolArray:
    """Everything below the skyline: the highest edge of its column and of its neighbours."""
    height = photo.shape[0]
    degree = height / 180.0
    elevation = elevations_deg(height)
    log = np.log(np.maximum(luminance(photo), 1e-6))
    # The edge is where light falls against the sky a few rows above, which no sky does so fast.
    reach = max(round(2.0 * degree), 2)
    above = np.vstack([np.repeat(log[:1], reach, axis=0), log[:-reach]])
    drop = above - log > _EDGE
    leafy = photo[..., 2] < _LEAST_BLUE * photo[..., 1]
    edge = (drop | leafy) & ~glare & (elevation < _TALLEST_DEG)[:, None]
    below = np.logical_or.accumulate(edge, axis=0)
    below = _grown(below, 1.5 * degree)
    return below | (elevation < HORIZON_MARGIN_DEG)[:, None]


def _cloud(photo: FloatArray, other: BoolArray) -> BoolArray:
    """Pixels that differ from the smooth sky around them in luminance or colour, also moon and
    masts."""
    degree = photo.shape[0] / 180.0
    safe = np.maximum(photo, 1e-6)
    # Land must not weigh in a median beside it: it takes the value of the sky above.
    light = _filled_from_above(np.log(luminance(safe)), other)
    colour = _filled_from_above(np.log(safe[..., 2] / safe[..., 0]), other)
    rough = _departure(light, 5.0 * degree) > _ROUGH
    rough |= _departure(colour, 5.0 * degree) > _ROUGH
    rough |= _departure(light, 2.0 * degree) > _FINE
    return _grown(rough & ~other, 1.5 * degree)


def _departure(quantity: FloatArray, reach_px: float) -> FloatArray:
    """Distance (h, w) of each pixel from the median of the square around it."""
    window = 2 * round(reach_px) + 1
    wrapped = np.pad(quantity, ((0, 0), (window, window)), mode="wrap")
    smooth = ndimage.median_filter(wrapped, window, mode="nearest")[:, window:-window]
    return np.abs(quantity - smooth)


def _filled_from_above(quantity: FloatArray, holes: BoolArray) -> FloatArray:
    rows = np.where(holes, 0, np.arange(holes.shape[0])[:, None])
    last = np.maximum.accumulate(rows, axis=0)
    return np.take_along_axis(quantity, last, axis=0)


def _grown(mask: BoolArray, radius_px: float) -> BoolArray:
    """The mask (h, w) and all within a radius of it, around the picture's edge as well."""
    pad = int(np.ceil(radius_px)) + 1
    wrapped = np.pad(mask, ((0, 0), (pad, pad)), mode="wrap")
    near: BoolArray = ndimage.distance_transform_edt(~wrapped) <= radius_px
    return near[:, pad:-pad] if mask.any() else mask


def _closed(mask: BoolArray, radius_px: float) -> BoolArray:
    """The mask with its gaps narrower than twice a radius."""
    return ~_grown(~_grown(mask, radius_px), radius_px)


def _at_pixel(height: int, row: float, column: float) -> Sun:
    azimuth = ((column + 0.5) / height - 1.0) * 180.0
    return Sun(azimuth, (0.5 - (row + 0.5) / height) * 180.0, True)


def _angle_from(height: int, sun: Sun) -> FloatArray:
    """Angle (h, 2 h) of each pixel from the sun, rad."""
    cosine = lat_long_directions(height) @ sun.direction()
    return np.arccos(np.clip(cosine, -1.0, 1.0))

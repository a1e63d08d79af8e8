"""Projections of the whole sky: direction and solid angle of each pixel, and splatting of light.

Three projections share one protocol. North, as `north_offset_rad` turns it (see `frames`), is in
the middle of a latitude-longitude picture and at the top of a fisheye; cubes are in world axes.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.cube_map import (
    FACE_NORMALS,
    FACE_S_AXES,
    FACE_T_AXES,
    texel_directions,
    texel_solid_angles,
)
from vrut_lite.geometry.frames import angles_from_direction, enu_from_world
from vrut_lite.geometry.panorama import fisheye_directions, lat_long_directions
from vrut_lite.numeric_types import FloatArray

_UP_FACES = (2, 3)


class Spread(NamedTuple):
    """Pixels that share light from N directions: flat indices (N, 4), shares (N, 4) of sum 1."""

    pixel: NDArray[np.intp]
    share: FloatArray


class SkyMap(Protocol):
    """A projection of the sky onto pixels, in world axes."""

    def directions(self) -> FloatArray:
        """World directions (..., 3) of the pixel centres."""

    def solid_angles(self) -> FloatArray:
        """Solid angles (...,) of the pixels, sr; 0 outside the picture."""

    def spread(self, direction: FloatArray) -> Spread:
        """Share light from directions (N, 3) among neighbouring pixels, keeping its centroid.

        Light from above the horizon stays above it.
        """


@dataclass(frozen=True)
class LatLongMap:
    """Latitude-longitude, (height, 2 height), north in the middle."""

    height: int
    north_offset_rad: float = 0.0

    def directions(self) -> FloatArray:
        """World directions (h, 2 h, 3)."""
        return lat_long_directions(self.height, self.north_offset_rad)

    def solid_angles(self) -> FloatArray:
        """Solid angles (h, 2 h): exact, by the sine of elevation at the rows' edges."""
        sine = np.cos(np.linspace(0.0, np.pi, self.height + 1))
        row = (sine[:-1] - sine[1:]) * np.pi / self.height
        return np.repeat(row[:, None], 2 * self.height, axis=1)

    def position(self, direction: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Row and column (...,) of directions (..., 3), whole numbers at pixels' middles."""
        azimuth, elevation = angles_from_direction(enu_from_world(direction, self.north_offset_rad))
        row = (0.5 - elevation / np.pi) * self.height - 0.5
        return row, np.mod(azimuth / np.pi + 1.0, 2.0) * self.height - 0.5

    def spread(self, direction: FloatArray) -> Spread:
        """See `SkyMap`."""
        row, column = self.position(direction)
        row = _kept_above(row, direction, self.height)
        rows, row_share = _neighbours(np.clip(row, 0.0, self.height - 1.0), self.height)
        left = np.floor(column)
        columns = np.mod(np.stack([left, left + 1], axis=-1).astype(int), 2 * self.height)
        column_share = np.stack([left + 1 - column, column - left], axis=-1)
        return _combined(rows * (2 * self.height), row_share, columns, column_share)


@dataclass(frozen=True)
class FisheyeMap:
    """Equidistant fisheye, (size, size), looking up, north at the top."""

    size: int
    north_offset_rad: float = 0.0

    def directions(self) -> FloatArray:
        """World directions (s, s, 3); outside the circle those of its rim."""
        return fisheye_directions(self.size, self.north_offset_rad)[0]

    def solid_angles(self) -> FloatArray:
        """Solid angles (s, s) at the pixels' middles, 0 outside the circle."""
        c = (2.0 * np.arange(self.size) + 1.0) / self.size - 1.0
        radius = np.hypot(*np.meshgrid(c, c))
        # sin(theta) d theta d phi with theta = pi / 2 * radius; numpy's sinc has pi in it.
        shape = 0.5 * np.pi * np.sinc(0.5 * radius)
        return np.where(radius <= 1.0, 0.5 * np.pi * shape * (2.0 / self.size) ** 2, 0.0)

    def position(self, direction: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Row and column (...,) of directions (..., 3), whole numbers at pixels' middles."""
        azimuth, elevation = angles_from_direction(enu_from_world(direction, self.north_offset_rad))
        # Half a pixel's diagonal away from the rim, so that the nearest pixel lies inside.
        radius = np.minimum(1.0 - elevation / (0.5 * np.pi), 1.0 - np.sqrt(2.0) / self.size)
        row = (1.0 - radius * np.cos(azimuth)) * 0.5 * self.size - 0.5
        return row, (1.0 - radius * np.sin(azimuth)) * 0.5 * self.size - 0.5

    def spread(self, direction: FloatArray) -> Spread:
        """See `SkyMap`."""
        row, column = self.position(direction)
        rows, row_share = _neighbours(row, self.size)
        index, share = _combined(rows * self.size, row_share, *_neighbours(column, self.size))
        inside = share * (self.solid_angles().ravel()[index] > 0.0)
        return Spread(index, inside / inside.sum(axis=1, keepdims=True))


@dataclass(frozen=True)
class CubeFaces:
    """A cube map's faces, (6, size, size), in OpenGL's order and in world axes."""

    size: int

    def directions(self) -> FloatArray:
        """World directions (6, s, s, 3)."""
        return texel_directions(self.size)

    def solid_angles(self) -> FloatArray:
        """Exact solid angles (6, s, s)."""
        return np.broadcast_to(texel_solid_angles(self.size), (6, self.size, self.size))

    def spread(self, direction: FloatArray) -> Spread:
        """See `SkyMap`; light stays on its own face."""
        along = direction @ FACE_NORMALS.T
        face, major = np.argmax(along, axis=1), np.max(along, axis=1)
        column, row = (
            (np.einsum("ni,ni->n", direction, axes[face]) / major + 1.0) * 0.5 * self.size - 0.5
            for axes in (FACE_S_AXES, FACE_T_AXES)
        )
        row = np.where(np.isin(face, _UP_FACES), row, _kept_above(row, direction, self.size))
        rows, row_share = _neighbours(np.clip(row, 0.0, self.size - 1.0), self.size)
        columns, column_share = _neighbours(np.clip(column, 0.0, self.size - 1.0), self.size)
        first = ((face * self.size)[:, None] + rows) * self.size
        return _combined(first, row_share, columns, column_share)


def _kept_above(row: FloatArray, direction: FloatArray, height: int) -> FloatArray:
    """Rows (N,), limited to the lowest row above the horizon for directions above it."""
    lowest = (height + 1) // 2 - 1
    return np.where(direction[:, 1] >= 0.0, np.minimum(row, float(lowest)), row)


def _neighbours(at: FloatArray, count: int) -> tuple[NDArray[np.intp], FloatArray]:
    """The two indices (N, 2) around positions (N,), below `count`, and their shares."""
    first = np.clip(np.floor(at), 0, max(count - 2, 0))
    share = np.stack([first + 1.0 - at, at - first], axis=-1)
    second = np.minimum(first + 1, count - 1)
    return np.stack([first, second], axis=-1).astype(np.intp), share


def _combined(
    first: NDArray[np.intp], first_share: FloatArray, columns: NDArray[np.intp], share: FloatArray
) -> Spread:
    """The four pixels of two rows, given by their first pixel's index, and two columns."""
    index = first[:, :, None] + columns[:, None, :]
    shares = first_share[:, :, None] * share[:, None, :]
    return Spread(index.reshape(-1, 4), shares.reshape(-1, 4))

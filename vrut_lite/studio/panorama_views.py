"""The perspective views of which an equirectangular picture is made, and how they fill it.

One eye sees six faces of a cube. Two eyes see by omnidirectional stereo (Peleg, Ben-Ezra and
Pritch 2001, "Omnistereo"): in each column the eye stands beside the middle, half the interpupillary
distance along the horizontal that is perpendicular to the column's azimuth. A column has two views,
one above and one below the horizon; narrow strips of columns share them.
"""

import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.cube_map import FACE_NORMALS, major_face
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.messages.camera import MoveCamera, look_at
from vrut_lite.numeric_types import FloatArray, vector

Eye = Literal["middle", "left", "right"]
# Distance between an adult's pupils in the mean of men and women, 63 to 64 mm (Dodgson 2004).
INTERPUPILLARY_M = 0.064
_SIDE: dict[Eye, float] = {"middle": 0.0, "left": -1.0, "right": 1.0}
# Strips of columns that share an eye's position, which moves by 0.8 mm from strip to strip: a
# quarter of a pixel of 2048 for what is 1 m away.
_STRIPS = 256
# Pixels of a view per pixel of the panorama along an edge, in the view's middle and at the horizon.
_SCALE = 2.0
# Pixels that a view sees beyond its part, for bilinear look-up and refraction.
_MARGIN_PX = 8
# Each pixel of a panorama is the mean of so many squared directions.
_DIRECTIONS = 2
_ROWS_AT_ONCE = 128
_PITCH_RAD = 0.25 * math.pi


class PanoramaView(NamedTuple):
    """A perspective view, and columns and rows (first, last + 1) of the pixels that it may fill.

    `face` is the cube's face that bounds them further, None for a strip.
    """

    camera: MoveCamera
    size_px: tuple[int, int]
    columns: tuple[int, int]
    rows: tuple[int, int]
    face: int | None


class Sphere(NamedTuple):
    """An equirectangular picture of one eye, (width / 2, width), true north in its middle."""

    width_px: int
    north_offset_rad: float

    @property
    def height_px(self) -> int:
        """Rows, from zenith to nadir."""
        return self.width_px // 2

    def views(self, middle_m: FloatArray, eye: Eye) -> list[PanoramaView]:
        """The views of an eye beside the middle (3,), world axes."""
        return self._faces(middle_m) if eye == "middle" else self._strips(middle_m, _SIDE[eye])

    def fill(
        self, target: NDArray[np.float32], view: PanoramaView, radiance: NDArray[np.float32]
    ) -> None:
        """Write the view's part of a picture (h, w, 3) from the view's radiance."""
        first, last = view.columns
        for top in range(view.rows[0], view.rows[1], _ROWS_AT_ONCE):
            rows = slice(top, min(top + _ROWS_AT_ONCE, view.rows[1]))
            middles = self._directions(rows, first, last, 0.5, 0.5)
            if view.face is None:
                own = np.ones(middles.shape[:2], bool)
            else:
                own = major_face(middles) == view.face
            if not own.any():
                continue
            total = np.zeros((int(own.sum()), 3))
            for i, j in np.ndindex(_DIRECTIONS, _DIRECTIONS):
                down, right = (i + 0.5) / _DIRECTIONS, (j + 0.5) / _DIRECTIONS
                directions = self._directions(rows, first, last, down, right)[own]
                total += _seen(radiance, view, directions)
            target[rows, first:last][own] = total / _DIRECTIONS**2

    def _directions(
        self, rows: slice, first: int, last: int, down: float, right: float
    ) -> FloatArray:
        """World directions (rows, columns, 3), of points so far down and right in their pixels."""
        azimuth = self._azimuth_rad(np.arange(first, last, dtype=np.float64) + right)
        elevation = (0.5 - (np.arange(rows.start, rows.stop) + down) / self.height_px) * np.pi
        enu = direction_from_angles(azimuth[None, :], elevation[:, None])
        return world_from_enu(enu, self.north_offset_rad)

    def _azimuth_rad(self, column: FloatArray) -> FloatArray:
        return (2.0 * column / self.width_px - 1.0) * np.pi

    @property
    def _edge_px(self) -> int:
        """Pixels across 90 degrees of a view."""
        return 2 * math.ceil(0.5 * _SCALE * self.width_px / math.pi)

    def _faces(self, middle_m: FloatArray) -> list[PanoramaView]:
        edge = self._edge_px
        whole, tangent = edge + 2 * _MARGIN_PX, 1.0 + 2.0 * _MARGIN_PX / edge
        return [
            PanoramaView(
                _camera(middle_m, forward, tangent),
                (whole, whole),
                (0, self.width_px),
                (0, self.height_px),
                face,
            )
            for face, forward in enumerate(FACE_NORMALS)
        ]

    def _strips(self, middle_m: FloatArray, side: float) -> list[PanoramaView]:
        borders = np.linspace(0, self.width_px, min(_STRIPS, self.width_px) + 1).round().astype(int)
        widest_rad = float(np.diff(borders).max()) / self.width_px * 2.0 * math.pi
        edge = self._edge_px
        tangent = 1.0 + 2.0 * _MARGIN_PX / edge
        # A strip is widest at zenith or nadir, 45 degrees off the view's middle.
        half = math.ceil(0.5 * edge * math.tan(0.5 * widest_rad) / math.cos(_PITCH_RAD))
        size = 2 * (half + _MARGIN_PX), edge + 2 * _MARGIN_PX
        horizon = self.height_px // 2
        found = []
        for first, last in zip(borders[:-1].tolist(), borders[1:].tolist(), strict=True):
            azimuth = self._azimuth_rad(np.array(0.5 * (first + last)))
            aside = world_from_enu(
                direction_from_angles(azimuth + 0.5 * np.pi, 0.0), self.north_offset_rad
            )
            eye_m = middle_m + 0.5 * side * INTERPUPILLARY_M * aside
            for pitch, rows in (
                (_PITCH_RAD, (0, horizon)),
                (-_PITCH_RAD, (horizon, self.height_px)),
            ):
                enu = direction_from_angles(azimuth, pitch)
                forward = world_from_enu(enu, self.north_offset_rad)
                camera = _camera(eye_m, forward, tangent)
                found.append(PanoramaView(camera, size, (first, last), rows, None))
        return found


def equal_areas(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """Rows (h, w, 3) of an equirectangular picture, each for the same share of the sphere."""
    height = len(picture)
    sines = 1.0 - (2.0 * np.arange(height) + 1.0) / height
    rows = np.minimum(((0.5 - np.arcsin(sines) / np.pi) * height).astype(int), height - 1)
    return picture[rows]


def _camera(eye_m: FloatArray, forward: FloatArray, tangent: float) -> MoveCamera:
    return MoveCamera(
        eye_m=vector(eye_m),
        target_m=vector(eye_m + forward),
        vertical_field_of_view_rad=2.0 * math.atan(tangent),
    )


def _seen(
    radiance: NDArray[np.float32], view: PanoramaView, directions: FloatArray
) -> NDArray[np.float64]:
    """Bilinear radiance (n, 3) of a view in world directions (n, 3)."""
    camera, (width, height) = view.camera, view.size_px
    forward = np.subtract(camera.target_m, camera.eye_m)
    local = directions @ look_at(np.zeros(3), forward)[:3, :3].T
    per_tangent = 0.5 * height / math.tan(0.5 * camera.vertical_field_of_view_rad)
    x = 0.5 * width - 0.5 - per_tangent * local[:, 0] / local[:, 2]
    y = 0.5 * height - 0.5 + per_tangent * local[:, 1] / local[:, 2]
    column = np.clip(np.floor(x).astype(int), 0, width - 2)
    row = np.clip(np.floor(y).astype(int), 0, height - 2)
    right, down = (x - column)[:, None], (y - row)[:, None]
    upper = radiance[row, column] * (1.0 - right) + radiance[row, column + 1] * right
    lower = radiance[row + 1, column] * (1.0 - right) + radiance[row + 1, column + 1] * right
    return np.asarray(upper * (1.0 - down) + lower * down, float)

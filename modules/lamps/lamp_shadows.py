"""Shadow maps of lamps: six cube faces each, side by side in one texture.

Lamps and scene are static: the maps are drawn once per scene. A tile spans a little more than its
face of the cube, so that the filter finds texels beyond the face's edge too.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.frame_part import Casters, PartGl
from vrut_lite.messages.lamps import SceneLamps
from vrut_lite.numeric_types import FloatArray

FACES = 6
EDGE_PX = 512
# Fraction of a tile's edge within the face; the filter reaches 1.5 texels beyond it.
FACE_SHARE = (EDGE_PX - 4) / EDGE_PX
# Near plane, in radii of the scene; nearer surfaces cast no shadow.
_NEAR_RADII = 1e-4
# Angle between a face's axis and the corners of the face.
_CORNER_RAD = float(np.arctan(np.sqrt(2.0)))


class DepthRange(NamedTuple):
    """Depth in the maps at a distance m along a face's axis: scale + offset / m."""

    scale: float
    offset: float


class LampShadows:
    """The maps of the lamps that are drawn; made and used on the GL thread only.

    The counters count faces, and skip those outside a spot's cone and maps that are current.
    """

    def __init__(self, gl: PartGl):
        self._gl = gl
        self._context, self._counters = gl.context, gl.counters
        self._texture: Any = None
        self._buffer: Any = None
        self._drawn: tuple[Any, ...] = ()
        self.depth = DepthRange(0.0, 0.0)

    def update(self, casters: Casters, lamps: SceneLamps, count: int) -> Any:
        """The texture for the first `count` lamps."""
        if self._drawn == (casters, lamps):
            self._counters.skip("lamp shadows: same scene")
            return self._texture
        self._make(count)
        near_m, far_m = _NEAR_RADII * casters.radius_m, _farthest_m(casters, lamps)
        self.depth = DepthRange(
            0.5 * (far_m + near_m) / (far_m - near_m) + 0.5, -far_m * near_m / (far_m - near_m)
        )
        self._buffer.viewport = (0, 0, *self._texture.size)
        self._buffer.use()
        self._buffer.clear()
        for lamp in range(count):
            place = lamps.position_m.values[lamp]
            for face in range(FACES):
                if not _reaches(lamps, lamp, face):
                    self._counters.skip("lamp shadow face: the spot shines elsewhere")
                    continue
                self._buffer.viewport = (face * EDGE_PX, lamp * EDGE_PX, EDGE_PX, EDGE_PX)
                self._buffer.use()
                casters.draw_depth(face_matrix(face, near_m, far_m), place)
                self._counters.did("lamp shadow face")
        self._drawn = (casters, lamps)
        return self._texture

    def release(self) -> None:
        """Free the GL objects."""
        if self._texture is not None:
            self._gl.leave_framebuffers()
            self._buffer.release()
            self._texture.release()
        self._texture = self._buffer = None
        self._drawn = ()

    def _make(self, count: int) -> None:
        size = (FACES * EDGE_PX, count * EDGE_PX)
        if self._texture is not None and self._texture.size == size:
            return
        self.release()
        self._texture = self._context.depth_texture(size)
        self._texture.compare_func = "<="
        self._texture.filter = (self._context.LINEAR, self._context.LINEAR)
        self._buffer = self._context.framebuffer(depth_attachment=self._texture)


def face_matrix(face: int, near_m: float, far_m: float) -> NDArray[np.float64]:
    """Clip matrix (4, 4) of positions relative to a lamp, world axes.

    Face 2 a looks along axis a, face 2 a + 1 against it; right and up are the next two axes.
    """
    axis, sign = face // 2, 1.0 - 2.0 * (face % 2)
    matrix = np.zeros((4, 4))
    matrix[0, (axis + 1) % 3] = matrix[1, (axis + 2) % 3] = FACE_SHARE
    matrix[2, axis] = sign * (far_m + near_m) / (far_m - near_m)
    matrix[2, 3] = -2.0 * far_m * near_m / (far_m - near_m)
    matrix[3, axis] = sign
    return matrix


def _reaches(lamps: SceneLamps, lamp: int, face: int) -> bool:
    """Whether a lamp's cone meets a face of the cube around it."""
    forward = np.zeros(3)
    forward[face // 2] = 1.0 - 2.0 * (face % 2)
    between = np.arccos(np.clip(lamps.axes.values[lamp, 0] @ forward, -1.0, 1.0))
    outer = np.arccos(np.clip(lamps.cone_cos.values[lamp, 1], -1.0, 1.0))
    return bool(between <= outer + _CORNER_RAD + 0.01)


def _farthest_m(casters: Casters, lamps: SceneLamps) -> float:
    """Largest distance of the scene from any lamp, by its bounding sphere."""
    away: FloatArray = np.linalg.norm(lamps.position_m.values - casters.centre_m, axis=1)
    return float(away.max() + casters.radius_m)

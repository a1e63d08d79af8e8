"""What a view needs of the sky: which cube faces it can show."""

import numpy as np

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.kernel.messages import MoveCamera
from vrut_lite.scene.camera import look_at

# Coarse directions stand for whole texels, so the view is widened by one texel's reach.
_PROBE_SIZE = 16
_MARGIN = 1.5 / _PROBE_SIZE


def visible_faces(camera: MoveCamera, aspect: float) -> tuple[tuple[int, ...], bool]:
    """Indices of the cube faces inside the view, and whether any sky above the horizon is.

    What hides the sky in the scene itself is not asked: a conservative answer.
    """
    view = look_at(camera.eye_m, camera.target_m)
    directions = texel_directions(_PROBE_SIZE) @ view[:3, :3].T
    forward = -directions[..., 2]
    tangent = np.tan(0.5 * camera.vertical_field_of_view_rad)
    inside = (
        (forward > 0.0)
        & (np.abs(directions[..., 0]) <= forward * tangent * aspect + _MARGIN)
        & (np.abs(directions[..., 1]) <= forward * tangent + _MARGIN)
    )
    above = texel_directions(_PROBE_SIZE)[..., 1] > 0.0
    faces = tuple(int(face) for face in np.flatnonzero(inside.any(axis=(1, 2))))
    return faces, bool((inside & above).any())

"""Projection of world directions into the picture."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.messages.camera import MoveCamera, look_at


def project_directions(
    directions: ArrayLike, camera: MoveCamera, aspect: float
) -> NDArray[np.float64]:
    """Points (n, 2) of unit directions (n, 3) in a picture, as fractions of width and height.

    x counts from the left, y from the top; points behind the eye are nan.
    """
    rotation = look_at(np.zeros(3), np.subtract(camera.target_m, camera.eye_m))[:3, :3]
    right, up, back = np.moveaxis(np.asarray(directions, dtype=float) @ rotation.T, -1, 0)
    tangent = np.tan(0.5 * camera.vertical_field_of_view_rad)
    depth = np.where(back < -1e-6, -back, np.nan)
    x = 0.5 + 0.5 * right / (depth * tangent * aspect)
    y = 0.5 - 0.5 * up / (depth * tangent)
    return np.stack([x, y], axis=-1)

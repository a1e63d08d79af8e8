"""Which meshes a view can show."""

import numpy as np

from vrut_lite.render.mesh_renderer import View
from vrut_lite.render.pyrender_scene import PlacedPrimitive


def in_view(placed: PlacedPrimitive, view: View) -> bool:
    """Whether the sphere around a mesh reaches into the view: a conservative answer."""
    clip = (view.projection @ view.rotation)[:, :3]
    # Left, right, bottom, top; the side planes also shut out what is behind the eye.
    planes = np.array([clip[3] + clip[0], clip[3] - clip[0], clip[3] + clip[1], clip[3] - clip[1]])
    planes /= np.linalg.norm(planes, axis=1, keepdims=True)
    distance_m = planes @ (placed.centre_m - view.eye_m)
    return bool(np.all(distance_m >= -placed.radius_m))

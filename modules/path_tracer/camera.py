"""The camera of the GL frame as a sensor of mitsuba, to the pixel."""

import math
from typing import Any

import numpy as np

from path_tracer.subject import Subject
from vrut_lite.messages.camera import look_at

# As near as the GL frame's, in radii of the scene.
_NEAR_M, _NEAR_RADII = 0.02, 1e-3


def sensor(mitsuba: Any, subject: Subject, farthest_units: float) -> dict[str, Any]:
    """A pinhole at the origin; a pixel's value is the mean over its square."""
    camera = subject.camera
    eye_m, target_m = np.asarray(camera.eye_m), np.asarray(camera.target_m)
    _, up, back = look_at(np.zeros(3), target_m - eye_m)[:3, :3]
    near_m = min(_NEAR_M, _NEAR_RADII * subject.radius_m)
    width_px, height_px = subject.state.size_px
    return {
        "type": "perspective",
        "fov": math.degrees(camera.vertical_field_of_view_rad),
        "fov_axis": "y",
        "near_clip": near_m * subject.units_per_m,
        "far_clip": 4.0 * farthest_units,
        "to_world": mitsuba.ScalarTransform4f().look_at([0.0, 0.0, 0.0], list(-back), list(up)),
        "film": {
            "type": "hdrfilm",
            "width": width_px,
            "height": height_px,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "independent"},
    }

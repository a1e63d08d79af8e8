"""What a denoiser is told of a picture besides its radiance: colours and normals first met."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from path_tracer.camera import sensor
from path_tracer.library import load_mitsuba
from path_tracer.settings import PathTracerSettings
from path_tracer.shapes import matter
from path_tracer.subject import Subject
from path_tracer.surfaces import model_of


class Guides(NamedTuple):
    """Means over a pixel: base colours (h, w, 3) in [0, 1] and world normals (h, w, 3)."""

    albedo: NDArray[np.float32]
    normal: NDArray[np.float32]


def guides(subject: Subject, settings: PathTracerSettings, samples: int) -> Guides:
    """The guides of a picture; 0 where nothing is met.

    Raises:
        UserError: mitsuba, or the variant that is set, is not there.
    """
    mitsuba = load_mitsuba(settings.variant)
    content: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "aov", "aovs": "albedo:albedo,normal:sh_normal"},
        "camera": sensor(mitsuba, subject, subject.reach_units()),
        # Without any light mitsuba shows nothing.
        "sky": {"type": "constant"},
        **matter(mitsuba, subject, model_of(settings, mitsuba)).shapes,
    }
    found = np.asarray(mitsuba.render(mitsuba.load_dict(content), spp=samples, seed=0))
    albedo, normal = found[..., :3], found[..., 3:6]
    return Guides(np.clip(albedo, 0.0, 1.0).astype(np.float32), normal.astype(np.float32))

"""Single-sided surfaces from behind: the eye looks through them in llvm, as in the frame."""

import numpy as np
import pytest
from light_messages import light_messages
from path_tracer.backend import PathTracedBackend
from path_tracer.library import safe_library
from path_tracer.settings import PathTracerSettings
from path_tracer_here import mitsuba_or_skip
from render.scene_stage import look, square, surface
from stateful_backend import StatefulBackend, opened

from vrut_lite.errors import UserError

mitsuba_or_skip()


def seen_from(path, height):
    """Mean radiance of the square from so high above it, under a sky of 1 and a sun of pi."""
    settings = PathTracerSettings(spp=32, variant="llvm", sun="sharp")
    backend = StatefulBackend(PathTracedBackend(settings), size_px=(4, 4))
    sun = {"sun_direction": (0.0, 1.0, 1e-6), "sun_irradiance": (0.0,) * 3}
    background, key_light, ambient = light_messages(np.ones((6, 8, 8, 3)), **sun)
    backend.change(scene=opened(path), background=background, key_light=key_light, ambient=ambient)
    return look(backend, (0.0, height, 1e-3), (0.0, 0.0, 0.0), 0.05).radiance.mean()


@pytest.mark.parametrize("instanced", [False, True])
@pytest.mark.parametrize("double_sided", [False, True])
def test_the_eye_looks_through_the_back_of_what_is_single_sided(tmp_path, double_sided, instanced):
    """Black from its front; from behind the sky shows unless the file says double-sided."""
    try:
        safe_library()
    except UserError as error:
        pytest.skip(str(error))
    black = {**surface(0.0, 1.0, 0.0), "doubleSided": double_sided}
    nodes = [{"mesh": 0}] + [{"mesh": 0, "translation": [5, 0, 0]}] * instanced
    path = square(tmp_path, black, nodes=nodes)
    assert seen_from(path, 3.0) < 0.1
    below = seen_from(path, -3.0)
    assert below < 0.1 if double_sided else below > 0.99

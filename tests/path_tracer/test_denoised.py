"""Finished pictures of the path tracer are shown without grain, and keep what was traced."""

import numpy as np
import pytest
from light_messages import light_messages
from path_tracer.backend import PathTracedBackend
from path_tracer.settings import PathTracerSettings
from path_tracer_here import mitsuba_or_skip
from scene_stage import square, surface
from stateful_backend import StatefulBackend, opened

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.camera import MoveCamera

mitsuba_or_skip()
pytest.importorskip("mitsuba_oidn", reason="the package mitsuba-oidn is not installed")


def test_a_picture_is_shown_without_grain_and_its_radiance_is_as_traced(tmp_path):
    """Of a plane under a sky that is bright on one side, by four paths a pixel: EXR and numbers are
    right in the mean, a denoised picture need not be."""
    sky = 0.1 + np.maximum(texel_directions(16)[..., :1], 0.0) ** 20 * np.full(3, 40.0)
    background, sun, ambient = light_messages(sky)
    pictures = []
    for denoise in (False, True):
        settings = PathTracerSettings(
            spp=4, max_bounces=1, surfaces="bare", variant="scalar", denoise=denoise
        )
        stage = StatefulBackend(PathTracedBackend(settings), size_px=(48, 48))
        stage.change(
            scene=opened(square(tmp_path, surface(0.0, 1.0, 0.5))),
            background=background,
            key_light=sun,
            ambient=ambient,
            moved_camera=MoveCamera(
                eye_m=(0, 3, 0), target_m=(0, 0, 0), vertical_field_of_view_rad=0.1
            ),
        )
        pictures.append(stage.draw())
    grainy, smooth = pictures
    np.testing.assert_array_equal(smooth.radiance, grainy.radiance)
    assert smooth.display.std() < 0.5 * grainy.display.std()
    assert smooth.display.mean() == pytest.approx(grainy.display.mean(), rel=0.1)

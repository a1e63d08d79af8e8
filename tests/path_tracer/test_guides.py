"""What a denoiser is told besides radiance, and which surfaces a variant stands for."""

import numpy as np
import pytest
from light_messages import light_messages
from path_tracer import library
from path_tracer.guides import guides
from path_tracer.settings import PathTracerSettings
from path_tracer.subject import Subject
from path_tracer.surfaces import model_of
from path_tracer_here import mitsuba_or_skip
from scene_stage import square, surface
from stateful_backend import StatefulBackend, opened

from vrut_lite.errors import UserError
from vrut_lite.messages.camera import MoveCamera

mitsuba = mitsuba_or_skip()


@pytest.mark.parametrize(("metallic", "albedo"), [(0.0, 0.3), (1.0, 0.6)])
def test_guides_are_the_colour_and_the_normal_first_met(tmp_path, metallic, albedo):
    """A level square fills the picture: its base colour, of paint as of metal, and straight up."""
    stage = StatefulBackend(None, size_px=(4, 4))
    background, sun, ambient = light_messages(np.ones((6, 4, 4, 3)))
    stage.change(
        scene=opened(square(tmp_path, surface(metallic, 0.4, albedo))),
        background=background,
        key_light=sun,
        ambient=ambient,
        moved_camera=MoveCamera(
            eye_m=(0, 3, 0), target_m=(0, 0, 0), vertical_field_of_view_rad=0.1
        ),
    )
    settings = PathTracerSettings(surfaces="layered", variant="scalar")
    found = guides(Subject(stage.state), settings, samples=1)
    np.testing.assert_allclose(found.albedo, albedo, rtol=1e-5)
    np.testing.assert_allclose(found.normal, np.broadcast_to([0, 1, 0], (4, 4, 3)), atol=1e-5)


def test_without_an_llvm_auto_is_scalar_with_quick_surfaces(monkeypatch):
    """The choice auto raises no error; the choice llvm does."""
    monkeypatch.delenv(library.LIBRARY_VARIABLE, raising=False)
    monkeypatch.setattr(library, "_PLACES", ())
    library.safe_library.cache_clear()
    found = library.load_mitsuba("auto")
    assert found.variant() == "scalar_rgb"
    assert model_of(PathTracerSettings(), found) == "gltf"
    assert model_of(PathTracerSettings(surfaces="layered"), found) == "layered"
    with pytest.raises(UserError, match="no LLVM 16 or newer was found"):
        library.load_mitsuba("llvm")
    library.safe_library.cache_clear()

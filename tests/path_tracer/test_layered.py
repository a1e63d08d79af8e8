"""The frame's own surface in mitsuba: a plane looks alike in both."""

import numpy as np
import pytest
from light_messages import light_messages
from long_parameters import mostly_long
from path_tracer.backend import PathTracedBackend
from path_tracer.settings import PathTracerSettings
from path_tracer_here import mitsuba_or_skip
from scene_stage import look, square, surface
from stateful_backend import StatefulBackend, opened

from vrut_lite.geometry.frames import direction_from_angles, world_from_enu

mitsuba_or_skip()
SIZE = (4, 4)
# Python is called for each path in scalar: few samples. Those of a sharp sun have no noise.
SKY_SAMPLES = 256
ROUGHNESS = [0.1, 0.3, 0.6, 1.0]


@pytest.fixture
def traced():
    def backend(samples):
        settings = PathTracerSettings(
            spp=samples, max_bounces=1, sun="sharp", surfaces="layered", variant="scalar"
        )
        return StatefulBackend(PathTracedBackend(settings), size_px=SIZE)

    return backend


@pytest.fixture
def frame(gl_owner):
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(gl_owner)
    yield StatefulBackend(backend, size_px=SIZE)
    backend.close()


def towards(azimuth_deg, elevation_deg):
    angles = np.radians([azimuth_deg, elevation_deg])
    return world_from_enu(direction_from_angles(*angles))


def seen(backend, path, elevation_deg, radiance=0.0, **sun):
    """Mean radiance of the square in the file, seen from the south so high above it."""
    backend.change(scene=opened(path))
    background, key_light, ambient = light_messages(np.full((6, 8, 8, 3), radiance), **sun)
    backend.change(background=background, key_light=key_light, ambient=ambient)
    eye = tuple(3.0 * towards(180.0, elevation_deg))
    return float(look(backend, eye, (0.0, 0.0, 0.0), 0.01).radiance.mean())


@pytest.mark.gl
@pytest.mark.parametrize(("metallic", "albedo"), [(0.0, 0.5), (0.0, 0.0), (1.0, 0.8)])
@pytest.mark.parametrize("roughness", mostly_long(ROUGHNESS, {0.3, 1.0}.__contains__))
def test_sunlight_on_coat_paint_and_metal_is_the_frames(
    frame, traced, tmp_path, metallic, albedo, roughness
):
    """The same formulas twice: 0.5 %, also where sun and view graze the surface."""
    path = square(tmp_path, surface(metallic, roughness, albedo))
    tracing = traced(1)
    for view_deg, azimuth_deg, sun_deg in ((50, 0, 60), (20, 0, 9), (8, 100, 9), (80, 0, 25)):
        sun = {"sun_direction": towards(azimuth_deg, sun_deg), "sun_irradiance": (9.0,) * 3}
        expected = seen(frame, path, view_deg, **sun)
        assert seen(tracing, path, view_deg, **sun) == pytest.approx(expected, rel=5e-3)


@pytest.mark.gl
@pytest.mark.parametrize(("metallic", "albedo"), [(0.0, 0.5), (1.0, 0.8)])
@pytest.mark.parametrize("roughness", mostly_long([0.3, 0.6], (0.3).__eq__))
def test_an_even_sky_is_reflected_as_by_the_frame(
    frame, traced, tmp_path, metallic, albedo, roughness
):
    """All bounces between facets in both, 2 %: noise, and the frame's table of 32 steps."""
    path = square(tmp_path, surface(metallic, roughness, albedo))
    tracing = traced(SKY_SAMPLES)
    for view_deg in (20, 80):
        expected = seen(frame, path, view_deg, radiance=1.0)
        assert seen(tracing, path, view_deg, radiance=1.0) == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("metallic", mostly_long([0.0, 1.0], (0.0).__eq__))
@pytest.mark.parametrize("roughness", mostly_long([0.3, 0.6], (0.3).__eq__))
def test_white_returns_all_of_an_even_sky_and_no_more(traced, tmp_path, metallic, roughness):
    """A furnace of 1 shows 1, from above and at grazing angles: 2 %, noise and the table."""
    path = square(tmp_path, surface(metallic, roughness, 1.0))
    tracing = traced(SKY_SAMPLES)
    for view_deg in (10, 80):
        assert seen(tracing, path, view_deg, radiance=1.0) == pytest.approx(1.0, rel=0.02)

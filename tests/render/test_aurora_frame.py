"""The aurora in the frame has the light that its numbers have."""

import numpy as np
import pytest
from aurora.curtains import AuroraShown, phases_at, radiance
from box_stage import uniform_sky
from scene_stage import light, look
from stateful_backend import opened


@pytest.mark.gl
@pytest.mark.parametrize("eye_m", [2.0, 9_000.0, 420_000.0])
def test_the_frame_shows_what_the_twin_computes(shared_gl_backend, box_file, eye_m):
    """From the ground, an aircraft and a station; to 4 % of the brightest, 1 % in the mean."""
    band = AuroraShown(
        poleward=(0.0, 0.0, -1.0), edge_km=40.0, width_km=300.0, lean=0.2, kilorayleigh=100.0,
        haze=0.1, phases=phases_at(3000.0), source="test",
    )  # fmt: skip
    backend = shared_gl_backend(size_px=(96, 64), scene=opened(box_file))
    light(backend, uniform_sky(0.0), sun_irradiance=(0.0,) * 3)
    backend.hear(band)
    target = (0.0, eye_m + (1.0 if eye_m < 1e5 else -0.3), -1.0)
    picture = look(backend, (0.0, eye_m, 0.0), target, 1.0).radiance
    rows, columns = np.mgrid[0:64, 0:96] + 0.5
    focal = 32.0 / np.tan(0.5)
    forward = np.array([0.0, target[1] - eye_m, -1.0])
    forward /= np.linalg.norm(forward)
    right = np.array([1.0, 0.0, 0.0])
    up = np.cross(right, forward)
    rays = (
        forward + ((columns - 48.0) / focal)[..., None] * right
        - ((rows - 32.0) / focal)[..., None] * up
    )  # fmt: skip
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    expected = radiance(band, rays, eye_m / 1000.0)
    assert expected.max() > 1e-6
    assert np.abs(picture - expected).max() < 0.04 * expected.max()
    assert picture.mean() == pytest.approx(expected.mean(), rel=0.01)

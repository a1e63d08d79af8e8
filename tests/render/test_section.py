"""A section plane cuts the picture, not the light."""

import numpy as np
import pytest
from scene_stage import light, look, square, surface
from stateful_backend import opened

from vrut_lite.messages.section import section_of


@pytest.mark.parametrize(
    ("keeps", "at_m", "along", "seen"),
    [
        ("below", 2.0, 1.0, (0.0, 1.0)),
        ("below", 2.0, -1.0, (0.0, np.inf)),
        ("above", 2.0, 1.0, (1.0, np.inf)),
        ("above", 2.0, -1.0, (np.inf, np.inf)),
        ("below", 0.5, 1.0, (np.inf, np.inf)),
        ("below", 2.0, 0.0, (0.0, np.inf)),
    ],
)
def test_a_ray_is_seen_where_it_is_on_the_kept_side(keeps, at_m, along, seen):
    """From x = 1 along x, against it, and across."""
    way = np.array([along, 0.0, 0.0]) if along else np.array([0.0, 1.0, 0.0])
    section = section_of("x", at_m, keeps)
    assert section.seen_part(np.array([1.0, 0.0, 0.0]), way) == seen
    assert section_of("off", at_m, keeps) is None


@pytest.fixture
def backend(gl_backend):
    return gl_backend(size_px=(48, 48))


@pytest.mark.gl
def test_half_of_a_square_is_cut_away(backend, tmp_path):
    """What x is more than 0 shows the sky behind; the rest stays."""
    backend.change(scene=opened(square(tmp_path, surface(0.0, 1.0))))
    light(backend, np.full((6, 16, 16, 3), 1.0))
    view = ((0, 1, 0), (0, 0, 0), 0.4)
    whole = look(backend, *view).radiance
    backend.change(section=section_of("x", 0.0, "below"))
    cut = look(backend, *view).radiance
    columns = np.flatnonzero(np.abs(cut - whole).max(axis=(0, 2)) > 1e-6)
    kept = np.setdiff1d(np.arange(whole.shape[1]), columns)
    assert columns.size == pytest.approx(whole.shape[1] / 2, abs=2)
    np.testing.assert_allclose(cut[:, kept], whole[:, kept], rtol=1e-5)
    backend.change(section=section_of("x", 0.0, "above"))
    other = np.flatnonzero(np.abs(look(backend, *view).radiance - whole).max(axis=(0, 2)) > 1e-6)
    assert np.intersect1d(other, columns).size <= 2
    backend.change(section=None)
    assert np.array_equal(look(backend, *view).radiance, whole)

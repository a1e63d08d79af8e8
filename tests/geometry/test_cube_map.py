"""Cube maps: orientation, solid angles, averaging and look-up."""

import numpy as np
import pytest

from vrut_lite.geometry.cube_map import (
    FACE_NORMALS,
    reduce_cube,
    sample_cube,
    texel_directions,
    texel_solid_angles,
)
from vrut_lite.geometry.panorama import (
    fisheye_directions,
    lat_long_directions,
    sample_sky,
    unfold_cube,
)


def gl_lookup(direction):
    """Face, s and t of a direction, straight from the table of the OpenGL specification (8.19)."""
    x, y, z = direction
    rows = [
        (x, -z, -y), (-x, z, -y), (y, x, z), (-y, x, -z), (z, x, -y), (-z, -x, -y),
    ]  # fmt: skip
    face = int(np.argmax([row[0] for row in rows]))
    major, s, t = rows[face]
    return face, (s / major + 1) / 2, (t / major + 1) / 2


def test_texels_look_where_opengl_samples_them():
    """OpenGL finds texel (face, i, j) of a map of size 5 in its direction; t is the row."""
    size = 5
    for (face, i, j), _ in np.ndenumerate(np.zeros((6, size, size))):
        found, s, t = gl_lookup(texel_directions(size)[face, i, j])
        assert (found, s, t) == (
            face,
            pytest.approx((j + 0.5) / size),
            pytest.approx((i + 0.5) / size),
        )


@pytest.mark.parametrize("size", [1, 2, 7, 64])
def test_solid_angles_cover_the_sphere(size):
    """Six faces make 4 pi, exactly: the corner function is a closed form."""
    assert 6 * texel_solid_angles(size).sum() == pytest.approx(4 * np.pi, rel=1e-13)


@pytest.mark.parametrize(("size", "small"), [(128, 64), (96, 32), (100, 64), (62, 60), (48, 64)])
def test_averaging_keeps_the_integral(size, small):
    """Energy is kept to rounding, also where the sizes do not divide."""
    cube = np.random.default_rng(1).random((6, size, size, 3))
    reduced = reduce_cube(cube, small)
    before = np.einsum("fijc,ij->c", cube, texel_solid_angles(size))
    after = np.einsum("fijc,ij->c", reduced, texel_solid_angles(reduced.shape[1]))
    np.testing.assert_allclose(after, before, rtol=1e-12)
    assert reduced.shape[1] >= min(size, small)


def test_look_up_finds_the_texel_itself():
    """In the direction of a texel's centre the look-up returns the texel itself."""
    cube = np.random.default_rng(2).random((6, 8, 8, 3))
    np.testing.assert_allclose(sample_cube(cube, texel_directions(8)), cube, rtol=1e-12)


def test_look_up_of_a_smooth_sky_is_smooth_across_faces():
    """A linear function of direction comes back within a texel's curvature, seams included."""
    cube = texel_directions(128).copy()
    d = np.random.default_rng(3).normal(size=(2000, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    assert np.abs(sample_cube(cube, d) - d).max() < 0.01


def test_a_panoramas_pixels_look_north_in_the_middle_and_up_at_the_top():
    """Latitude-longitude with north in the middle, east to its right."""
    d = lat_long_directions(64)
    np.testing.assert_allclose(d[32, 64], [0, 0, -1], atol=0.05)
    np.testing.assert_allclose(d[32, 96], [1, 0, 0], atol=0.05)
    np.testing.assert_allclose(d[0, 5], [0, 1, 0], atol=0.05)


def test_a_fisheye_has_north_at_the_top_and_east_at_the_left():
    """Looking up, as on a star chart."""
    d, inside = fisheye_directions(65)
    np.testing.assert_allclose(d[32, 32], [0, 1, 0], atol=0.05)
    np.testing.assert_allclose(d[0, 32], [0, 0, -1], atol=0.05)
    np.testing.assert_allclose(d[32, 0], [1, 0, 0], atol=0.05)
    assert not inside[0, 0]


def test_sampling_a_sky_never_mixes_it_with_the_ground():
    """With bright sky and dark ground a panorama holds only these two values."""
    up = texel_directions(32)[..., 1:2] > 0
    cube = np.where(up, 5.0, 1.0) * np.ones(3)
    assert set(np.unique(sample_sky(cube, lat_long_directions(101)).round(9))) == {1.0, 5.0}


def test_the_unfolded_cube_joins_at_its_edges():
    """Neighbouring faces of the cross join: no jump larger than a texel's step."""
    n = 64
    cross = unfold_cube(texel_directions(n))
    band = cross[n : 2 * n]
    assert np.abs(np.diff(band, axis=1)).max() < 2.5 / n
    column = cross[:, n : 2 * n]
    assert np.abs(np.diff(column, axis=0)).max() < 2.5 / n
    # West, north, east, south along the horizon.
    middles = band[n // 2, [n // 2, 3 * n // 2, 5 * n // 2, 7 * n // 2]]
    np.testing.assert_allclose(middles, FACE_NORMALS[[1, 5, 0, 4]], atol=0.03)

"""Axes of Q and U, and reflection, against closed forms."""

import numpy as np
import pytest

from vrut_lite.geometry.polarisation import (
    degree_and_angle,
    fresnel_polarisation,
    map_axis,
    polariser_axis,
    reflected,
    turned,
    vertical_axis,
)

RNG = np.random.default_rng(1)
GLASS = 0.04
BREWSTER = np.arctan(1.5)


def random_directions(count: int) -> np.ndarray:
    """Unit vectors (count, 3)."""
    d = RNG.normal(size=(count, 3))
    return d / np.linalg.norm(d, axis=-1, keepdims=True)


def test_axes_lie_across_the_ray_and_are_smooth_at_the_zenith() -> None:
    """Interpolation between texels needs neighbours with one axis, everywhere but in the nadir."""
    d = random_directions(100)
    for axis in (map_axis(d), vertical_axis(d)):
        assert np.sum(axis * d, axis=-1) == pytest.approx(0.0, abs=1e-9)
        assert np.linalg.norm(axis, axis=-1) == pytest.approx(1.0)
    assert vertical_axis(d)[:, 1].min() >= 0.0
    around = np.array([[0.001, 1.0, 0.0], [0.0, 1.0, 0.001], [-0.001, 1.0, -0.001]])
    around /= np.linalg.norm(around, axis=-1, keepdims=True)
    assert map_axis(around) == pytest.approx(np.broadcast_to([1.0, 0.0, 0.0], (3, 3)), abs=2e-3)


def test_an_angle_counts_counter_clockwise_as_the_observer_sees_it() -> None:
    """Light that vibrates half right of up, before an eye that looks north, has an angle of -45
    degrees, by whichever axis Q and U were given."""
    north, up = np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])
    along = np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0)
    q, u = turned([1.0], [0.0], north, along, up)
    _, angle = degree_and_angle(1.0, q, u)
    assert np.degrees(angle) == pytest.approx([-45.0])
    axis = map_axis(north)
    back = turned(*turned(q, u, north, up, axis), north, axis, up)
    assert np.concatenate(back) == pytest.approx(np.concatenate([q, u]), abs=1e-12)
    # A filter that is turned as far passes it.
    rotation = np.eye(3)
    assert polariser_axis(rotation, -45.0) == pytest.approx(along)


def test_fresnels_limits() -> None:
    """From straight above and at grazing angles nothing is polarised; at Brewster's angle all is
    across the plane of incidence. In between R of both is the textbook's, at 60 degrees for glass:
    0.1770 and 0.0018."""
    cosine = np.cos([0.0, BREWSTER, 0.5 * np.pi])
    difference, product = fresnel_polarisation(cosine, GLASS)
    assert difference == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert product == pytest.approx([1.0, 0.0, -1.0], abs=1e-7)
    ratio = (0.1770 - 0.0018) / (0.1770 + 0.0018)
    assert fresnel_polarisation(0.5, GLASS)[0] == pytest.approx(ratio, abs=2e-3)


def test_the_sky_in_the_plane_of_incidence_is_not_reflected_at_brewsters_angle() -> None:
    """Light that vibrates in that plane has Rp alone, which is 0 there; across it has twice the
    mean. What comes back is never polarised by more than all."""
    light = np.ones(1)
    for q, factor in ((-1.0, 0.0), (0.0, 1.0), (1.0, 2.0)):
        seen = reflected(light, [q], [0.0], np.cos(BREWSTER), GLASS)
        assert seen[0] == pytest.approx([factor], abs=1e-12)
    angle, degree = RNG.uniform(0.0, 2.0 * np.pi, (50, 1)), RNG.uniform(0.0, 1.0, (50, 1))
    q, u = degree * np.cos(angle), degree * np.sin(angle)
    i, q, u = reflected(np.ones((50, 1)), q, u, RNG.uniform(0.0, 1.0, 50), GLASS)
    assert np.all(np.hypot(q, u) <= i + 1e-12)


def test_a_mirror_straight_above_keeps_the_vibration() -> None:
    """Its plane in space stays; seen from the other side the angle has the other sign."""
    _, q, u = reflected([1.0], [0.3], [0.4], 1.0, GLASS)
    assert (q[0], u[0]) == pytest.approx((0.3, -0.4))

"""Rays: no digit is lost near the ground, the horizon and the top."""

from fractions import Fraction
from math import isqrt

import numpy as np
import pytest
from bruneton_sky.geometry import (
    altitude_along,
    distance_to_ground,
    distance_to_top,
    end_of_ray,
    horizon_mu,
    in_earth_shadow,
    make_ray,
    shadow_boundary,
    y_at_top,
)

RADIUS, TOP = 6_360_000.0, 60_000.0


def exact_root(value: Fraction) -> float:
    """Square root of a fraction to 50 digits."""
    scale = 10**50
    return float(Fraction(isqrt(int(value * scale * scale)), scale))


@pytest.mark.parametrize("height_m", [1e-3, 0.1, 1.7, 100.0, 59_999.999])
def test_horizon_is_exact_at_any_height(height_m: float) -> None:
    """The textbook formula loses every digit at a millimetre; exact arithmetic is the truth."""
    h, r = Fraction(height_m), Fraction(RADIUS)
    truth = -exact_root(h * (2 * r + h) / (r + h) ** 2)
    assert horizon_mu(RADIUS, height_m) == pytest.approx(truth, rel=1e-14)


@pytest.mark.parametrize("below_top_m", [1e-3, 1.0, 1000.0])
@pytest.mark.parametrize("mu", [1.0, 0.3, 1e-3, 0.0])
def test_distance_to_top_is_exact(below_top_m: float, mu: float) -> None:
    """A metre below the top the textbook form errs by half; exact arithmetic is the truth."""
    height = TOP - below_top_m
    r, m, top = Fraction(RADIUS) + Fraction(height), Fraction(mu), Fraction(RADIUS + TOP)
    truth = exact_root((r * m) ** 2 + top * top - r * r) - float(r * m)
    if mu < 0.1:
        assert distance_to_top(RADIUS, TOP, height, mu) == pytest.approx(truth, rel=1e-6)
    # The truth's own last subtraction costs it digits on steep rays.
    assert distance_to_top(RADIUS, TOP, height, mu) == pytest.approx(truth, abs=1e-8)


def test_ray_ends_where_its_distances_say() -> None:
    """y and distance describe the same end: ds/dy integrates to y sqrt(y^2 + 2 p)."""
    mu = np.array([1.0, 0.5, 1e-3, 0.0, -1e-3, -0.03, -0.2, -1.0])
    height = np.array([[0.1], [1700.0], [30_000.0]])
    ray = make_ray(RADIUS, height, mu)
    _, y = end_of_ray(ray, TOP)
    two_p = 2.0 * ray.perigee_radius_m
    length = y * np.sqrt(y * y + two_p) - ray.y * np.sqrt(ray.y**2 + two_p)
    hits = ray.hits_ground()
    to_top, to_ground = (
        distance_to_top(RADIUS, TOP, height, mu),
        distance_to_ground(RADIUS, height, mu),
    )
    assert length == pytest.approx(np.where(hits, to_ground, to_top), rel=1e-9, abs=1e-7)


def test_altitude_along_a_ray_reaches_its_end() -> None:
    """After the distance to the ground the altitude is 0, after that to the top 60 km."""
    height, down, up = 1.7, -0.01, 0.2
    ground = distance_to_ground(RADIUS, height, down)
    assert altitude_along(RADIUS, height, down, ground) == pytest.approx(0.0, abs=1e-8)
    top = distance_to_top(RADIUS, TOP, height, up)
    assert altitude_along(RADIUS, height, up, top) == pytest.approx(TOP, abs=1e-8)


def test_observer_on_the_ground_and_at_the_top() -> None:
    """Level rays at the ground do not hit it; rays up from the top have no length."""
    assert not make_ray(RADIUS, 0.0, 0.0).hits_ground()
    assert make_ray(RADIUS, 0.0, -1e-9).hits_ground()
    start = make_ray(RADIUS, TOP, np.array([1.0, 0.1, 0.0]))
    assert end_of_ray(start, TOP)[1] == pytest.approx(start.y, abs=1e-12)


def test_shadow_boundary_separates_light_from_dark() -> None:
    """A metre before and after the crossing, the test for shadow must change its answer."""
    mu, mu_s = 0.3, -0.1
    nu = mu * mu_s + np.sqrt((1 - mu**2) * (1 - mu_s**2))
    ray = make_ray(RADIUS, 500.0, mu)
    crossing = max(float(s) for s in shadow_boundary(ray, mu_s, nu))
    s = crossing + np.array([-1.0, 1.0])
    height = altitude_along(RADIUS, 500.0, mu, s)
    sun = ((RADIUS + 500.0) * mu_s + s * nu) / (RADIUS + height)
    assert in_earth_shadow(RADIUS, height, sun).tolist() == [True, False]


def test_no_shadow_boundary_by_day_or_straight_behind() -> None:
    """With the sun up nothing is dark; a ray straight from the sun stays in or out."""
    ray = make_ray(RADIUS, 100.0, np.array([0.1, 0.5]))
    assert all((s < 0).all() for s in shadow_boundary(ray, 0.5, np.array([0.9, 0.0])))
    antisolar = shadow_boundary(make_ray(RADIUS, 100.0, 0.2), -0.2, -1.0)
    assert all(float(s) < 0 or float(s) > 1e6 for s in antisolar)


@pytest.mark.parametrize("mu", [-1e-9, -2e-9, -1e-8, -1e-3])
def test_a_ray_along_the_top_is_as_long_as_it_should_be(mu: float) -> None:
    """From the top a ray sinks and comes back: to y = -y, where top - perigee would be zero.

    The perigee lies 1e-12 m below, which an altitude of 60 km has no digits for.
    """
    ray = make_ray(RADIUS, TOP, mu)
    assert float(y_at_top(ray, TOP)) == pytest.approx(-float(ray.y), rel=1e-12)

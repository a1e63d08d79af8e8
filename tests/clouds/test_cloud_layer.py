"""A `CloudLayer` has the requested coverage and analytic optical depths."""

import numpy as np
import pytest
from cloud_stage import slab
from clouds.model.cloud_density import (
    altitude_m,
    density,
    distance_up_m,
    optical_depth,
    sun_transmittance,
)
from clouds.module import make_layers
from clouds.settings import CloudSettings
from long_parameters import mostly_long

from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.atmosphere.sunlight import sunlight_at_altitude

EYE = np.zeros(3)


def cloud_layer(settings):
    """The only layer of these settings."""
    return make_layers(settings)[1][0]


UP = np.array([0.0, 1.0, 0.0])


@pytest.mark.parametrize("coverage", mostly_long([0.25, 0.5, 0.75], (0.25).__eq__))
@pytest.mark.parametrize("seed", mostly_long([1, 6], (1).__eq__))
def test_the_zenith_is_covered_as_asked(coverage, seed):
    """The covered share of random columns over a million square kilometres: within 3 % of the sky.

    Covered means an optical depth above a half. 2000 columns have a standard error of 1 %.
    """
    layer = cloud_layer(CloudSettings(coverage=coverage, seed=seed))
    level = np.random.default_rng(seed).uniform(-5e5, 5e5, (2000, 2))
    heights = layer.base_m + (np.arange(40) + 0.5) / 40 * layer.thickness_m
    # Each column has its own eye above it, because altitudes depend on the eye.
    eyes = np.stack([level[:, 0], np.zeros(2000), level[:, 1]], axis=-1)[:, None]
    points = eyes + heights[:, None] * UP
    depths = density(layer, points, eyes).mean(axis=1)
    depths *= layer.thickness_m * layer.extinction_per_m
    assert (depths > 0.5).mean() == pytest.approx(coverage, abs=0.03)


def test_cirrus_covers_seven_tenths_where_asked():
    """Frayed fibres leave room: within 3 %, where 5 % of a full column's depth counts."""
    layer = cloud_layer(CloudSettings(high_genus="Ci", high_coverage=0.7))
    level = np.random.default_rng(1).uniform(-5e5, 5e5, (2000, 1, 2))
    heights = layer.base_m + (np.arange(30) + 0.5) / 30 * layer.thickness_m
    eyes = np.stack([level[..., 0], np.zeros((2000, 1)), level[..., 1]], axis=-1)
    shares = density(layer, eyes + heights[:, None] * UP, eyes).mean(axis=1)
    assert (shares > 0.05).mean() == pytest.approx(0.7, abs=0.03)


def test_a_closed_layer_has_no_gaps():
    """Coverage 1 hides the sun everywhere: no column has an optical depth below 1."""
    layer = cloud_layer(CloudSettings(coverage=1.0))
    places = np.random.default_rng(0).uniform(-3e4, 3e4, (60, 2))
    shown = [sun_transmittance(layer, (x, 0.0, z), UP) for x, z in places]
    assert np.mean(np.array(shown) < np.exp(-1.0)) > 0.98


def test_a_slab_dims_by_its_optical_depth():
    """exp(-k d / mu): the slab's density is 1 but where it fades, 0.5 % below and 1 % above.

    The fades of `envelope` are integrated analytically; the planet's curvature adds 0.1 %.
    """
    layer = slab(extinction_per_m=1e-3, thickness_m=1000.0)
    top_fade = 0.03 - 5.0 / np.sqrt(0.75) * (2.0 / 3.0) * 0.03**1.5
    depth = 1e-3 * 1000.0 * (1.0 - 0.005 - top_fade)
    for mu in (1.0, 0.6):
        sun = np.array([np.sqrt(1.0 - mu * mu), mu, 0.0])
        assert -np.log(sun_transmittance(layer, EYE, sun)) == pytest.approx(depth / mu, rel=3e-3)
    assert sun_transmittance(layer, (0.0, 2e4, 0.0), UP) == 1.0


def test_depths_add_up():
    """Depths of two halves of a ray add up to the whole within 1 %: steps are fine enough."""
    layer = cloud_layer(CloudSettings(coverage=0.5))
    ray = np.array([0.8, 0.6, 0.0])
    start = ray * layer.base_m / 0.6
    whole = optical_depth(layer, start, ray, 2400.0, EYE, steps=4000)
    halves = [optical_depth(layer, start + k * 1200.0 * ray, ray, 1200.0, EYE) for k in (0, 1)]
    assert sum(halves) == pytest.approx(whole, rel=0.01, abs=0.01)


def test_altitude_is_that_over_the_sphere():
    """sqrt(x^2 + (R + y)^2 + z^2) - R, without cancellation: to a micrometre near the eye."""
    far = np.array([3e5, 2e3, -4e5])
    plain = np.linalg.norm(far + np.array([0.0, GROUND_RADIUS_M, 0.0])) - GROUND_RADIUS_M
    assert altitude_m(far, EYE) == pytest.approx(plain, abs=1e-6)
    assert altitude_m(np.array([0.0, 1e-3, 0.0]), EYE) == pytest.approx(1e-3, rel=1e-12)


@pytest.mark.parametrize("mu", [-0.02, 0.0, 0.3, 1.0])
def test_distance_up_ends_at_the_altitude(mu):
    """The point at this distance along the ray has the given altitude."""
    ray = np.array([np.sqrt(1.0 - mu * mu), mu, 0.0])
    metres = distance_up_m(10.0, 1500.0, mu)
    assert altitude_m(np.array([0.0, 10.0, 0.0]) + metres * ray, EYE) == pytest.approx(1500.0)


def test_sun_aloft_at_noon_and_after_sunset():
    """ASTM G-173's sun has 1 / 683 * 133.1 klx above the air; ozone and molecules take 10 to 15 %.

    A degree below the horizon the ground is dark, and a cloud at 3 km (dip 1.76 degrees) is red.
    """
    from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance

    noon = float(luminance(sunlight_at_altitude(0.0, 1.0))) * LUMENS_PER_WATT
    assert 0.85 * 133.1e3 < noon < 0.90 * 133.1e3
    below = np.sin(np.radians(-1.0))
    assert not sunlight_at_altitude(0.0, below).any()
    red, green, blue = sunlight_at_altitude(3000.0, below)
    assert red > 3.0 * green > 0.0
    assert blue < green
    sines = np.linspace(-0.1, 1.0, 400)
    light = luminance(sunlight_at_altitude(2000.0, sines))
    assert np.all(np.diff(light) >= 0.0), "a higher sun is never darker"

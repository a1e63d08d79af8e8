"""Light in plane clouds: the tables and the march beside discrete ordinates (PythonicDISORT)."""

import numpy as np
import pytest
from cloud_stage import slab
from clouds.model.cloud_light import ClearLight
from clouds.model.cloud_transport import (
    even_transmittance,
    layer_reflectance,
    layer_transmittance,
)
from clouds.model.cloud_view import clouds_seen
from discrete_ordinates import ordinates_of
from long_parameters import mostly_long

from vrut_lite.atmosphere.sunlight import sunlight_at_altitude

DEPTHS, ELEVATIONS_DEG = (0.3, 1.0, 3.0, 10.0, 30.0, 60.0), (9.0, 20.0, 35.0, 60.0)
CASES = [(depth, elevation) for depth in DEPTHS for elevation in ELEVATIONS_DEG]
NARROW_RAD = 1e-4
SHORT = [(1.0, 35.0), (30.0, 9.0)]


@pytest.mark.parametrize("case", mostly_long(CASES, SHORT.__contains__))
def test_fluxes_are_those_of_discrete_ordinates(case):
    """Reflectance and transmittance within 1 %."""
    depth, elevation = case
    sine = np.sin(np.radians(elevation))
    passed = ordinates_of(depth, sine).transmittance
    assert layer_transmittance(depth, sine) == pytest.approx(passed, rel=0.01)
    assert layer_reflectance(depth, sine) == pytest.approx(1.0 - passed, rel=0.01)


@pytest.mark.parametrize("case", mostly_long(CASES, SHORT.__contains__))
def test_radiance_is_that_of_discrete_ordinates(case):
    """From below and above, 17 degrees off the sun: within 10 %, 5 % rms, the mean within 4 %."""
    depth, elevation = case
    sine = float(np.sin(np.radians(elevation)))
    level = float(np.sqrt(1.0 - sine * sine))
    layer = slab(extinction_per_m=depth / 985.0)
    light = ClearLight((level, sine, 0.0), (1e-9,) * 3, np.zeros((25, 3)))
    truth = ordinates_of(depth, sine)
    mu = truth.mu[[6, 10, 14, 18, 21]]
    azimuth = np.array([0.3, 1.0, 2.2, 2.8])
    rows = np.searchsorted(truth.mu, mu)
    columns = np.round(azimuth / np.pi * 60).astype(int)
    around = columns / 60 * np.pi
    across = np.sqrt(1.0 - mu**2)[:, None]
    up = np.broadcast_to(mu[:, None], (5, 4))
    sun = float(sunlight_at_altitude(1500.0, sine)[1])
    for eye_m, sign, theirs in ((998.0, 1.0, truth.base), (2002.0, -1.0, truth.top)):
        ahead = np.stack([across * np.cos(around), sign * up, across * np.sin(around)], -1)
        seen = clouds_seen(layer, light, (0.0, eye_m, 0.0), ahead, NARROW_RAD).radiance[..., 1]
        error = seen / sun / theirs[np.ix_(rows, columns)] - 1.0
        apart = ahead @ np.array(light.sun_direction) < np.cos(0.3)
        assert abs(error[apart].mean()) < 0.04
        assert np.sqrt(np.mean(error[apart] ** 2)) < 0.05
        assert np.abs(error[apart]).max() < 0.1


def test_what_enters_a_layer_leaves_it():
    """Light seen below and above a layer of depth 10 sums to what the sun sends: within 1 %."""
    sun = np.array([0.6, 0.8, 0.0])
    layer = slab(extinction_per_m=10.0 / 985.0)
    light = ClearLight((0.6, 0.8, 0.0), (1e-9,) * 3, np.zeros((25, 3)))
    x, weight = np.polynomial.legendre.leggauss(12)
    mu, azimuth = 0.5 * (x + 1.0), (np.arange(24) + 0.5) / 24 * 2.0 * np.pi
    across = np.sqrt(1.0 - mu**2)[:, None]
    flat = np.stack([across * np.cos(azimuth), 0.0 * across + mu[:, None] * np.ones(24),
                     across * np.sin(azimuth)], -1)  # fmt: skip
    leaving = 0.0
    for eye_m, turn in ((998.0, 1.0), (2002.0, -1.0)):
        views = flat * np.array([1.0, turn, 1.0])
        seen = clouds_seen(layer, light, (0.0, eye_m, 0.0), views, NARROW_RAD).radiance[..., 1]
        leaving += np.pi * (weight * mu) @ seen.mean(axis=1)
    entering = float(sunlight_at_altitude(1500.0, 0.8)[1]) * sun[1]
    assert leaving == pytest.approx(entering, rel=0.01)


def test_layers_of_nothing_and_of_everything():
    """All passes where there is no cloud, nothing behind an endless one, and never more or less."""
    depth, sine = np.meshgrid(np.geomspace(1e-6, 1e6, 60), np.linspace(-0.1, 1.0, 30))
    for passed in (layer_transmittance(depth, sine), even_transmittance(depth)):
        assert passed[:, 0] == pytest.approx(1.0, abs=1e-4)
        assert passed[:, -1] == pytest.approx(0.0, abs=1e-4)
        assert (np.diff(passed, axis=1) < 0.0).all()
    assert layer_transmittance(0.0, 0.5) == 1.0

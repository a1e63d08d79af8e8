import numpy as np
import pytest
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.optical_path import optical_depth_to_top
from bruneton_sky.published.single_scattering import single_scattering
from bruneton_sky.raised_ground import raise_ground


@pytest.mark.parametrize("ground_m", [-430.0, 0.0, 1600.0, 14_000.0, 45_000.0])
def test_raising_the_ground_leaves_the_air_above_as_it_was(ground_m):
    """A point above the ground keeps its optical depth to the top."""
    earth = Atmosphere.earth()
    raised = raise_ground(earth, ground_m)
    mu = np.array([1.0, 0.5, 0.1, 0.0])
    for altitude_m in (max(ground_m, 0.0), max(ground_m, 0.0) + 3000.0):
        expected = optical_depth_to_top(earth, altitude_m, mu)
        actual = optical_depth_to_top(raised, altitude_m - ground_m, mu)
        np.testing.assert_allclose(actual, expected, rtol=1e-7)


def test_the_sky_above_a_plateau_is_the_sky_seen_from_its_altitude():
    """A view upward meets the same air and the same sun, so single scattering is the same."""
    earth = Atmosphere.earth()
    mu, nu = np.array([0.9, 0.4, 0.05]), np.array([0.8, 0.1, -0.3])
    expected = single_scattering(earth, 3500.0, mu, 0.6, nu, samples=24)
    actual = single_scattering(raise_ground(earth, 3500.0), 0.0, mu, 0.6, nu, samples=24)
    np.testing.assert_allclose(actual, expected, rtol=1e-6)


@pytest.mark.parametrize("ground_m", [60_000.0, 1e9, -7e6])
def test_a_ground_outside_the_air_is_refused(ground_m):
    """A ground above the air or below the planet's centre is refused in one sentence."""
    with pytest.raises(ValueError, match=r"a ground at .* lies outside the planet's air"):
        raise_ground(Atmosphere.earth(), ground_m)

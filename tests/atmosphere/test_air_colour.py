"""Transmittance of the channels for air that absorbs a single wavelength."""

import numpy as np
import pytest

from vrut_lite.atmosphere.air_colour import lost_and_depth, shares_of_white
from vrut_lite.geometry.colour import SKYLIGHT_NM, solar_irradiance

SHARES = shares_of_white(SKYLIGHT_NM, solar_irradiance(SKYLIGHT_NM))


@pytest.mark.parametrize("taken", np.eye(4)[:, None] * [[1e-9], [0.1], [0.9], [1.0]])
def test_a_single_absorbed_wavelength_brightens_no_channel(taken):
    """The colour matrix has negative weights, which must not brighten a channel."""
    assert (SHARES < 0.0).any()
    lost, depth = lost_and_depth(taken, SHARES)
    for part in (lost, depth):
        assert np.isfinite(part).all()
        assert (part >= 0.0).all()
    assert (lost <= 1.0).all()

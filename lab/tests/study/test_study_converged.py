"""The physics reference against paths of light, and changes of the atmosphere."""

import numpy as np
import pytest
from bruneton_sky import single_scattering
from long_parameters import mostly_long
from measured_error import error_mw

from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.models.changes import (
    CHANGES,
    with_ozone,
    with_sun_of_the_day,
    with_whiter_aerosol,
)
from vrut_lite_lab.study.models.converged import Converged, monte_carlo_sky
from vrut_lite_lab.study.models.elek import at_wavelengths
from vrut_lite_lab.study.models.in_parts import in_parts

AIR = STUDY.bruneton_atmosphere()
VIEW_RAD = np.radians([0.0, 30.0, 60.0, 78.0, 85.0])
AZIMUTH_RAD = np.radians([0.0, 10.0, 180.0, 90.0, 40.0])


@pytest.mark.long
@pytest.mark.parametrize("sun_deg", mostly_long([23.0, 57.0, 84.0], (57.0).__eq__))
def test_sky_of_all_orders_is_that_of_paths_of_light(sun_deg):
    """Five directions, each to 3.5 standard errors, which are below 1 %, and all in the mean.

    Wavelengths share their paths, and so their noise: they count as one. The 0.2 % is the
    solver's own."""
    air = at_wavelengths(AIR, WAVELENGTHS_NM[[0, 8, 16, 32]])
    seen = np.radians(sun_deg), VIEW_RAD, AZIMUTH_RAD
    chance = monte_carlo_sky(air, *seen, paths=8192)
    deviation = (Converged(air).sky_radiance(*seen) / chance.radiance - 1.0).mean(axis=1)
    noise = (chance.standard_error / chance.radiance).mean(axis=1)
    assert noise.max() < 0.01
    assert np.all(np.abs(deviation) < 3.5 * noise + 0.002)
    assert abs(deviation.mean()) < 3.5 * np.sqrt((noise**2).sum()) / noise.size + 0.002


def test_many_directions_are_few_at_a_time():
    """In order, each once, also where parts are not all as long; and none at all."""
    some = np.arange(5001.0), np.arange(5001.0)[:, None]
    found = in_parts(lambda a, b: a[:, None] + b, *some)
    np.testing.assert_array_equal(found, 2.0 * some[1])
    assert in_parts(lambda a: a[:, None], np.zeros(0)).shape == (0, 1)


def test_no_sun_below_the_horizon():
    """Nor on a plane that faces it."""
    assert not Converged().sun_irradiance(1.6).any()


def test_a_farther_sun_dims_all():
    """The square of 1.0133 au takes 2.6 %."""
    np.testing.assert_allclose(scattered_share(with_sun_of_the_day), 1.0133**-2, rtol=1e-12)


def test_ozone_takes_orange():
    """300 Dobson units: most of all at 600 nm, and next to nothing at 400 nm."""
    share = scattered_share(with_ozone)
    assert abs(WAVELENGTHS_NM[np.argmin(share)] - 600.0) < 20.0
    assert 0.93 < share.min() < 0.97
    assert share[3] > 0.995


def test_whiter_aerosol_scatters_more():
    """It scatters 0.975 over 0.8 in the aureole, which is aerosol's: at 800 nm almost all of it."""
    assert 1.19 < scattered_share(with_whiter_aerosol, nu=0.999)[38] < 0.975 / 0.8


def scattered_share(change, nu=0.9):
    """Light scattered once (40,) after a change, over that before it."""
    after, before = (single_scattering(air, 0.0, 0.8, 0.8, nu) for air in (change(AIR), AIR))
    return after / before


@pytest.mark.parametrize(
    ("name", "error"),
    [
        ("ozone", 12.2),
        ("sun-distance", 12.3),
        ("orders", 12.0),
        ("aerosol-albedo", 12.2),
        ("aerosol-phase", 16.3),
    ],
)
@pytest.mark.long
def test_what_changes_do_to_the_measured_error(measured_skies, name, error):
    """None of them lowers the 11.7 that the atmosphere of that day has."""
    assert error_mw(CHANGES[name].sky(), measured_skies) == pytest.approx(error, abs=0.1)

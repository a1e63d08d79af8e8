"""Each sky model against the published program's radiance, and against the measured sky."""

import numpy as np
import pytest
from long_parameters import mostly_long
from measured_error import error_mw

from vrut_lite_lab.study.framework.directions import directions
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.models.model import sky_irradiance
from vrut_lite_lab.study.models.registry import MODELS

pytestmark = pytest.mark.long

# The published program has its solar, Rayleigh and albedo tables in single precision (6e-8).
SINGLE = 1e-7
# What the published program calls its models.
PUBLISHED = {
    "preetham": "preetham",
    "oneil": "oneal",
    "hosek-wilkie": "hosek",
    "nishita93": "nishita93",
}
# mW m^-2 sr^-1 nm^-1 over the 15 times that are here; the published ones are over 17.
SLOW = ("converged", "haber", "haber-published", "nishita96", "measured-aerosol")
MEASURED_RMSE = {
    "preetham": 88.7,
    "oneil": 49.8,
    "hosek-wilkie": 41.6,
    "nishita93": 26.5,
    "single-scattering": 25.5,
}


def skies(model, zenith_deg, sun_azimuth_deg=100.0):
    """A model's radiance (suns, 81, 40)."""
    zenith, azimuth = directions()
    relative = azimuth - np.radians(sun_azimuth_deg)
    return np.stack([model.sky_radiance(sun, zenith, relative) for sun in np.radians(zenith_deg)])


@pytest.mark.parametrize("name", PUBLISHED)
def test_radiance_is_the_published_one(reference, name):
    """Three suns, down to 80 deg from the zenith; Preetham's is negative there in places."""
    ours = skies(MODELS[name](), reference["sun_zenith_deg"])
    published = reference[f"{PUBLISHED[name]}_radiance"]
    np.testing.assert_allclose(ours, published, rtol=SINGLE, atol=1e-12)


@pytest.mark.parametrize("name", PUBLISHED)
def test_sun_irradiance_is_the_published_one(reference, name):
    """Hosek-Wilkie's ends at 720 nm."""
    model = MODELS[name]()
    ours = [model.sun_irradiance(sun) for sun in np.radians(reference["sun_zenith_deg"])]
    published = reference[f"{PUBLISHED[name]}_sun_irradiance"]
    np.testing.assert_allclose(ours, published, rtol=SINGLE, atol=1e-12)


@pytest.mark.parametrize("name", PUBLISHED)
def test_sky_irradiance_is_the_published_one(reference, name):
    """Irradiance of a level plane by the published midpoint rule, sun at 30 deg."""
    ours = sky_irradiance(MODELS[name](), np.radians(30.0))
    published = reference[f"{PUBLISHED[name]}_sky_irradiance_30deg"]
    np.testing.assert_allclose(ours, published, rtol=SINGLE, atol=1e-12)


@pytest.mark.parametrize("name", MEASURED_RMSE)
def test_error_against_the_measured_sky(measured_skies, name):
    """The published errors are over 17 times; over our 15 each is within 0.5 of what is asked."""
    assert abs(error_mw(MODELS[name](), measured_skies) - MEASURED_RMSE[name]) < 0.5


@pytest.mark.parametrize("name", mostly_long(MODELS, lambda name: name not in SLOW))
def test_models_answer_everywhere(name):
    """Finite from the zenith to the horizon, sun high and low, and even in the azimuth."""
    model = MODELS[name]()
    assert model.name
    assert model.title
    zenith = np.linspace(0.0, np.pi / 2, 7)
    for sun_deg in (0.0, 45.0, 89.0):
        azimuths = np.repeat([0.7, -0.7], 7)
        both = model.sky_radiance(np.radians(sun_deg), np.tile(zenith, 2), azimuths)
        left, right = both[:7], both[7:]
        assert left.shape == (7, WAVELENGTHS_NM.size)
        assert np.isfinite(left).all()
        np.testing.assert_allclose(left, right, rtol=1e-12)
        sun = model.sun_irradiance(np.radians(sun_deg))
        assert sun.shape == WAVELENGTHS_NM.shape
        assert np.isfinite(sun).all()
        assert np.all(sun >= 0.0)

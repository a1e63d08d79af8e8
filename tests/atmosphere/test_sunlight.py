"""The sun aloft stands behind the sky's own haze."""

from datetime import datetime

import numpy as np
import pytest
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_at, spectral_atmosphere_of
from bruneton_sky.sun_light import haze_layers, sun_irradiance

from vrut_lite.atmosphere.haze_layer import HAZE_NM
from vrut_lite.atmosphere.sunlight import sunlight_at_altitude
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.geometry.colour import luminance, rgb_from_spectrum
from vrut_lite.kernel.messages import Demand, SetClock
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import KeyLightChanged

HAZES = [SetHaze(optical_depth_550=0.2), SetHaze(optical_depth_550=0.8, aerosol="desert")]


@pytest.mark.parametrize("haze", HAZES)
@pytest.mark.parametrize(("altitude_m", "within"), [(0.0, 0.02), (2000.0, 0.02), (9000.0, 0.04)])
def test_sunlight_aloft_is_that_of_the_layered_air(haze, altitude_m, within):
    """As by the solved sky's own atmosphere at 95 wavelengths, by both skies' layers of haze.

    High up its molecules thin out otherwise: those of the standard atmosphere.
    """
    settings = BrunetonSkySettings()
    air = spectral_atmosphere_of(settings, 0.0, haze)
    sines = np.sin(np.radians([5.0, 20.0, 60.0]))
    spectral = sun_irradiance(air, altitude_m, sines)
    truth = luminance(rgb_from_spectrum(spectral, air.wavelength_nm, 0.0))
    named = haze_layers(atmosphere_at(HAZE_NM, settings, 0.0, haze))
    for layers in (haze.layers, named):
        assert luminance(sunlight_at_altitude(altitude_m, sines, layers)) == pytest.approx(
            truth, rel=within
        )
    assert (luminance(sunlight_at_altitude(altitude_m, sines)) > truth).all()


@pytest.mark.parametrize("haze", HAZES)
def test_at_the_ground_it_is_the_key_light(haze):
    """The key light names the haze that it has passed: within 1 %."""
    kernel, _ = daylight_kernel()
    kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.4))
    kernel.inject(haze)
    kernel.inject(Demand(consumer="test", message=KeyLightChanged.__name__))
    kernel.inject(SetClock(instant=datetime.fromisoformat("2026-05-01T10:00+00:00")))
    kernel.pump_until_idle()
    key = kernel.last(KeyLightChanged)
    kernel.close()
    seen = sunlight_at_altitude(0.0, key.direction[1], key.haze)
    assert luminance(seen) == pytest.approx(float(luminance(key.irradiance_rgb)), rel=0.01)

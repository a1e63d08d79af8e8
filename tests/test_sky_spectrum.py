"""The spectra that skies post on demand agree with their cube maps."""

from datetime import UTC, datetime

import numpy as np
import pytest

from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.kernel.messages import ChooseSlot, Demand, SetClock
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import (
    BackgroundChanged,
    LookAlong,
    LookAround,
    SkyRadianceChanged,
    SkySpectraSeen,
    SpectrumSeen,
)
from vrut_lite.messages.sun import KeyLightChanged

# Four wavelengths of the solver against twelve, and the model's bands against its RGB fit.
TOLERANCE = 0.06
NM = tuple(np.linspace(380.0, 780.0, 41).tolist())


@pytest.fixture
def kernel():
    kernel, _ = daylight_kernel()
    yield kernel
    kernel.close()


def ask(kernel, module, hour, direction):
    for message in (
        Demand(consumer="test", message="BackgroundChanged", size=128),
        SetPlace(latitude_deg=50.0, longitude_deg=14.0),
        SetClock(instant=datetime(2026, 6, 21, hour, tzinfo=UTC)),
        ChooseSlot(slot="sky", module=module),
    ):
        kernel.inject(message)
    kernel.pump_until_idle()
    kernel.inject(LookAlong(direction=direction))
    kernel.pump_until_idle()
    return kernel.last(SpectrumSeen)


@pytest.mark.parametrize("module", ["dynamic_skylight", "bruneton_sky"])
def test_a_spectrum_has_the_colour_of_its_sky(kernel, module):
    """The spectrum, weighted by the CIE's curves, is the cube map's radiance there."""
    for direction in ((0.0, 1.0, 0.0), (-0.6, 0.8, 0.0), (0.0, 0.3, -0.954)):
        seen = ask(kernel, module, 16, direction)
        assert (seen.source, seen.direction) == (module, direction)
        colour = rgb_from_spectrum(np.array(seen.radiance), seen.wavelength_nm, 3.0)
        background = kernel.last(BackgroundChanged)
        cube = decode_float16(background.cube.values, background.radiance_scale)
        shown = sample_sky(cube, np.array(direction))
        assert colour == pytest.approx(shown, rel=TOLERANCE)


def test_only_the_skys_holder_answers(kernel):
    """Only the holder of the slot `sky` answers."""
    answers = []
    kernel.tap(lambda m, sender: answers.append(sender) if isinstance(m, SpectrumSeen) else None)
    ask(kernel, "bruneton_sky", 12, (0.0, 1.0, 0.0))
    assert answers == ["bruneton_sky"]


@pytest.mark.parametrize("module", ["dynamic_skylight", "bruneton_sky"])
def test_spectra_all_around_have_the_light_of_their_sky(kernel, module):
    """Sky on level ground, sun and ground, weighted by the CIE's curves, are those of pictures.

    Four wavelengths of the solver, and the model's RGB fit, differ from its spectra by 2.5 %.
    """
    for kind in ("SkyRadianceChanged", "KeyLightChanged"):
        kernel.inject(Demand(consumer="test", message=kind, size=64))
    ask(kernel, module, 16, (0.0, 1.0, 0.0))
    kernel.inject(LookAround(wavelength_nm=NM, size=8))
    kernel.pump_until_idle()
    seen, shown = kernel.last(SkySpectraSeen), kernel.last(SkyRadianceChanged)
    assert (seen.source, seen.wavelength_nm) == (module, NM)
    seen.check_arrays()
    assert not seen.cube.values[texel_directions(8)[..., 1] < 0.0].any()
    cube = decode_float16(shown.cube.values, shown.radiance_scale)
    level = rgb_from_spectrum(horizontal_irradiance(seen.cube.values), NM)
    assert level == pytest.approx(horizontal_irradiance(cube), rel=0.035)
    sun = rgb_from_spectrum(seen.sun_irradiance, NM)
    assert sun == pytest.approx(kernel.last(KeyLightChanged).irradiance_rgb, rel=0.01)
    ground = rgb_from_spectrum(seen.ground_radiance, NM)
    assert ground == pytest.approx(shown.ground_radiance_rgb, rel=0.025)


def test_weather_has_no_spectra(kernel):
    """Its sky has a luminance and a colour alone, and says so."""
    ask(kernel, "weather_sky", 12, (0.0, 1.0, 0.0))
    kernel.inject(LookAround(wavelength_nm=NM, size=4))
    kernel.pump_until_idle()
    seen = kernel.last(SkySpectraSeen)
    assert (seen.source, seen.wavelength_nm, seen.cube) == ("weather_sky", (), None)

"""The spectra that skies post on demand agree with their cube maps."""

from datetime import UTC, datetime

import numpy as np
import pytest

from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.kernel.messages import ChooseSlot, Demand, SetClock
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import BackgroundChanged, LookAlong, SpectrumSeen

# Four wavelengths of the solver against twelve, and the model's bands against its RGB fit.
TOLERANCE = 0.06


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

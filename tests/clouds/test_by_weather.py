"""Clouds of an hour of weather: their genus, cover and depth."""

import msgspec
import numpy as np
import pytest
from clouds.by_weather import coverage_of, genus_of, layers_under
from clouds.module import Clouds, make_layers
from clouds.settings import CloudSettings
from clouds.sky_under_clouds import light_under_clouds
from hypothesis import given, settings
from hypothesis import strategies as st
from light_messages import clear_sky_light, light_messages
from long_parameters import mostly_long

from vrut_lite.atmosphere.sunlight import sunlight_at_altitude
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, SetSetting
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.cloudiness import CloudinessChanged
from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.sky.sky_layer import Viewpoint

FOLLOWS = CloudSettings(follow_weather=True)


def hour(cover, share, direct=1.0, elevation_deg=50.0):
    return CloudinessChanged(
        cover=cover,
        global_share=share,
        direct_share=direct,
        sun_elevation_rad=float(np.radians(elevation_deg)),
        source="test",
    )


@given(cover=st.floats(0.0, 1.0), share=st.none() | st.floats(0.0, 2.0))
@settings(max_examples=60, deadline=None)
def test_every_hour_has_clouds_that_can_be_drawn(cover, share):
    """Any two numbers of a file give layers within the settings' bounds, none below a clear sky."""
    told = hour(cover, share)
    layers = layers_under(FOLLOWS, told)
    assert all(0.0 < layer.coverage <= 1.0 for layer in layers)
    assert bool(layers) == (coverage_of(cover, genus_of(told)) > 0.0)
    assert layers_under(CloudSettings(), told) == (), "clouds that do not follow stay away"


def test_more_cover_is_more_cloud():
    """Coverage rises with the cover that observers see, and at both ends they are the same."""
    for genus in ("Cu", "Sc", "St"):
        found = [coverage_of(cover, genus) for cover in np.linspace(0.0, 1.0, 101)]
        assert found == sorted(found)
        assert (found[0], found[-1]) == (0.0, 1.0)
    # Observers see heaps' sides: less of the zenith is covered.
    assert coverage_of(0.61, "Cu") == pytest.approx(0.35, abs=0.02)
    assert coverage_of(0.88, "Cu") == pytest.approx(0.70, abs=0.02)


def test_less_light_is_a_thicker_genus():
    """Closed skies by the light below them: rain, stratus, altostratus, cirrostratus."""
    genera = [genus_of(hour(1.0, share)) for share in (0.12, 0.35, 0.7, 0.95)]
    assert genera == ["Ns", "St", "As", "Cs"]
    assert [genus_of(hour(cover, 0.6)) for cover in (0.4, 0.8)] == ["Cu", "Sc"]


def test_what_is_said_stays():
    """A genus, a coverage and an extinction of one's own stand; the weather fills what is open."""
    own = CloudSettings(follow_weather=True, genus="Cu", coverage=0.2, high_genus="Ci")
    low, high = layers_under(own, hour(0.9, 0.4))
    assert (low.genus, low.coverage, high.genus) == ("Cu", 0.2, "Ci")
    assert low.passes is not None
    assert high.passes is None
    fixed = CloudSettings(follow_weather=True, extinction_per_m=0.03)
    (layer,) = layers_under(fixed, hour(1.0, 0.4))
    assert (layer.extinction_per_m, layer.passes) == (0.03, None)


HOURS = [(1.0, 0.3), (1.0, 0.15), (0.8, 0.6)]


@pytest.mark.parametrize("numbers", mostly_long(HOURS, HOURS[-1:].__contains__))
def test_the_light_below_is_the_files(numbers):
    """Level ground under the hour's clouds has the file's share of a clear sky's light.

    Within 0.06, in the mean of places: clouds' sides send light on that a plane column does not.
    """
    cover, share = numbers
    sine, directions = 0.8, texel_directions(16)[..., 1]
    by_sun, by_sky = sine * sunlight_at_altitude(0.0, sine), np.pi * np.array([12.0, 15.0, 21.0])
    cube = np.where(directions[..., None] > 0.0, by_sky, 0.15 * (by_sun + by_sky)) / np.pi
    sky = light_messages(cube, (0.6, sine, 0.0), by_sun / sine)
    clear = float(luminance(by_sun + by_sky))
    told = hour(cover, share, float(luminance(by_sun)) / clear, np.degrees(np.arcsin(sine)))
    (layer,) = make_layers(FOLLOWS, told)[1]
    shares = []
    for place_m in np.arange(6) * 31_000.0:
        moved = msgspec.structs.replace(layer, drift_m=(place_m, -place_m))
        view = Viewpoint((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), 8000.0)
        lit = light_under_clouds((moved,), clear_sky_light(*sky), view, 16, "test")
        below = evaluate_irradiance(lit.ambient.irradiance_sh_rgb.values, np.array([0.0, 1.0, 0.0]))
        below = below + sine * np.array(lit.key_light.irradiance_rgb)
        shares.append(float(luminance(below)) / clear)
    assert np.mean(shares) == pytest.approx(share, abs=0.06)


class Station(Module):
    """Tells a cloudiness where it is told a place: the altitude is the cover."""

    manifest = Manifest(name="station", title="Station", version="1")

    @handles(SetPlace)
    def place_set(self, message):
        self.link.post(hour(message.altitude_m / 1000.0, 0.5))


def test_the_next_hour_has_its_own_clouds():
    """A changed cloudiness makes new layers; a clear hour takes them away."""
    kernel = Kernel()
    kernel.add_module(Station)
    kernel.add_module(Clouds)
    kernel.inject(SetSetting(module="clouds", name="follow_weather", value=True))
    kernel.inject(Demand(consumer="test", message="CloudsChanged"))
    seen = []
    for cover in (0.5, 0.8, 0.8, 0.0):
        kernel.inject(SetPlace(latitude_deg=0.0, longitude_deg=0.0, altitude_m=1000.0 * cover))
        kernel.pump_until_idle()
        seen.append(kernel.last(CloudsChanged).layers)
    assert seen[0][0].coverage < seen[1][0].coverage
    assert seen[2] is seen[1]
    assert seen[3] == ()
    kernel.close()

"""Several layers of clouds: refused where they overlap, and each in the light that others leave."""

import msgspec
import numpy as np
import pytest
from cloud_stage import slab
from clouds.model.cloud_layers import clear_light, lights_on, mean_sun_share
from clouds.model.cloud_light import ClearLight
from clouds.model.cloud_transport import even_transmittance, ice_crystals
from clouds.sky_under_clouds import light_under_clouds
from light_messages import clear_sky_light, light_messages

from vrut_lite.errors import UserError
from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.messages.clouds import CloudForm, CloudsChanged
from vrut_lite.messages.sky import NO_LAMPS
from vrut_lite.sky.sky_layer import Viewpoint

SUN = (0.6, 0.8, 0.0)
LOW = slab(extinction_per_m=0.05)
HIGH = slab(base_m=6000.0, extinction_per_m=5e-4, particles="ice")
CLEAR = ClearLight(SUN, (90.0, 80.0, 70.0), irradiance_coefficients(np.full((6, 8, 8, 3), 4.0)))


@pytest.mark.parametrize(
    ("layers", "sentence"),
    [
        ((LOW, slab(base_m=1999.0)), "must not overlap: one ends at 2000 m"),
        ((HIGH, LOW), "must not overlap"),
        ((LOW, None), "must be of CloudLayer"),
        ((slab(particles="hail"),), "particles"),
        ((slab(form=CloudForm(stretch=0.0)),), "stretch"),
        (tuple(slab(base_m=2000.0 * n) for n in range(5)), "4 at most"),
    ],
)
def test_layers_that_cannot_be_are_refused(layers, sentence):
    """Low to high, apart, of particles that are known, and no more than a frame marches."""
    with pytest.raises(UserError, match=sentence):
        CloudsChanged(layers=layers, source="test").check()
    CloudsChanged(layers=(LOW, HIGH), source="test").check()


def test_the_sun_below_two_layers_is_the_product():
    """exp(-tau / mu) of each, in the mean over the covered and the open sky."""
    broken = slab(coverage=0.4, extinction_per_m=1e-3)
    through = np.exp(-0.985 / 0.8)
    assert mean_sun_share((broken,), 0.8) == pytest.approx(0.6 + 0.4 * through)
    assert mean_sun_share((broken, HIGH), 0.8) == pytest.approx(
        (0.6 + 0.4 * through) * np.exp(-0.5 * 0.985 / 0.8)
    )


def test_light_under_a_layer_adds_up_to_what_it_lets_through():
    """An empty layer leaves the light as it was; a thin one makes sky of what it takes."""
    empty = slab(base_m=6000.0, extinction_per_m=0.0)
    below, above = lights_on((LOW, empty), CLEAR)
    assert above is CLEAR
    np.testing.assert_allclose(below.by_sky, CLEAR.by_sky, rtol=1e-6)
    np.testing.assert_allclose(below.by_sun, CLEAR.by_sun, rtol=1e-6)
    under_ice = lights_on((LOW, HIGH), CLEAR)[0]
    assert np.all(under_ice.by_sun < 0.6 * CLEAR.by_sun)
    assert np.all(under_ice.by_sky > CLEAR.by_sky)
    assert 0.5 < under_ice.sun_passed < 0.6


def test_the_moon_lights_clouds_as_a_fainter_sun():
    """Clouds under a moon of a lux are not those of day: a hundred-thousandth of the sun aloft."""
    _, sun, _ = light_messages(np.zeros((6, 8, 8, 3)), SUN, (1e-3, 1e-3, 1e-3))
    moon = msgspec.structs.replace(sun, body="moon")
    assert clear_light(sun, CLEAR.irradiance_sh, NO_LAMPS).sun_passed == 1.0
    assert 5e-6 < clear_light(moon, CLEAR.irradiance_sh, NO_LAMPS).sun_passed < 2e-5


def test_lower_layers_hide_lamps_from_upper_ones():
    """The lower layer sees all of the lamps, the upper one what an even layer lets through."""
    low, high = slab(extinction_per_m=0.02), slab(base_m=4000.0)
    lamps = (0.4, 0.2, 0.1)
    under, over = lights_on((low, high), CLEAR._replace(lamps_rgb=lamps))
    assert under.lamps_rgb == lamps
    passed = float(even_transmittance(low.optical_depth))
    assert over.lamps_rgb == pytest.approx([passed * lamp for lamp in lamps])


def test_nearer_layers_hide_those_behind_them():
    """From the ground an opaque low layer hides ice aloft; from 12 km the ice is seen before it."""
    sky = light_messages(np.full((6, 16, 16, 3), 4.0), SUN, (90.0, 80.0, 70.0))
    clear = clear_sky_light(*sky)
    ground, aloft = (0.0, 0.0, 0.0), (0.0, 12_000.0, 0.0)

    def background(layers, eye_m):
        found = light_under_clouds(layers, clear, Viewpoint(eye_m, ground, 0.0), 16, "test")
        return found.background.cube.values.astype(float) * found.background.radiance_scale

    zenith, nadir = (2, 8, 8), (3, 8, 8)
    below = background((LOW, HIGH), ground)[zenith]
    # The low layer is darker under the ice, and nothing of the ice itself comes through.
    assert np.all(below < background((LOW,), ground)[zenith])
    assert np.all(below > 0.5 * background((LOW,), ground)[zenith])
    from_above = background((LOW, HIGH), aloft)[nadir]
    assert not np.allclose(from_above, background((LOW,), aloft)[nadir], rtol=0.02)


def test_ice_has_a_halo_at_22_degrees():
    """The least deviation by faces 60 degrees apart is 2 arcsin(n / 2) - 60: dark inside it."""
    table = ice_crystals()
    angles = np.radians(np.arange(18.0, 28.0, 0.1))
    phase = table(np.cos(angles))
    for channel, n in enumerate((1.3138, 1.3110, 1.3089)):
        least_deg = np.degrees(2.0 * np.arcsin(0.5 * n)) - 60.0
        steepest = np.degrees(angles[np.diff(phase[:, channel]).argmax()])
        assert steepest == pytest.approx(least_deg, abs=0.2)
    assert np.all(phase[45] > 1.5 * phase[:30].min(axis=0))
    # With diffraction and straight rays, 64 %: what is measured of cirrus is 0.75 to 0.82.
    assert 0.64 + 0.36 * table.mean_cosine()[1] == pytest.approx(0.8, abs=0.03)

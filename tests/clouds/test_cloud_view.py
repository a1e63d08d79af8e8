"""Clouds along rays on the CPU, against plain quadrature of the same layer."""

import numpy as np
import pytest
from cloud_stage import rough_layer, slab, slab_radiance
from clouds.model.cloud_density import distance_up_m, optical_depth, sun_transmittance
from clouds.model.cloud_field import cloud_field
from clouds.model.cloud_light import ClearLight
from clouds.model.cloud_light_volume import light_volume
from clouds.model.cloud_view import clouds_seen, sun_share, transmittances
from clouds.module import make_layers
from clouds.settings import CloudSettings
from long_parameters import mostly_long

SUN = (0.6, 0.8, 0.0)
DARK = ClearLight(SUN, (90.0, 80.0, 70.0), np.zeros((25, 3)))
GROUND = (0.0, 0.0, 0.0)
# So narrow that noise is read from its finest level.
NARROW_RAD = 1e-4


def towards(*directions):
    d = np.array(directions, dtype=float)
    return d / np.linalg.norm(d, axis=-1, keepdims=True)


@pytest.mark.parametrize("extinction_per_m", [2e-4, 1e-3, 5e-3])
def test_a_slab_shines_as_on_paper(extinction_per_m):
    """Discrete ordinates within 10 %, transmittance within 0.03: rays end before all is opaque."""
    layer = slab(extinction_per_m=extinction_per_m)
    views = towards((0.3, 1.0, 0.2), (-0.8, 0.9, 0.0), (0.0, 0.2, 1.0))
    seen = clouds_seen(layer, DARK, GROUND, views, NARROW_RAD)
    for number, view in enumerate(views):
        radiance, transmittance, distance_m = slab_radiance(layer, GROUND, view, np.array(SUN))
        np.testing.assert_allclose(seen.radiance[number], radiance, rtol=0.1)
        assert seen.transmittance[number] == pytest.approx(transmittance, abs=0.03)
        assert seen.distance_m[number] == pytest.approx(distance_m, rel=0.03)


def test_broken_clouds_stand_where_their_density_says():
    """Transmittance along 40 rays: that of a fine quadrature of the density, within 0.05 mostly."""
    layer = rough_layer(drift_m=(130.0, -70.0))
    random = np.random.default_rng(3)
    views = towards(*(random.normal(size=3) * [1.0, 0.0, 1.0] + [0.0, 1.5, 0.0] for _ in range(40)))
    eye = (400.0, 20.0, -900.0)
    seen = clouds_seen(layer, DARK, eye, views, NARROW_RAD).transmittance
    expected = []
    for view in views:
        near, far = (distance_up_m(eye[1], level, view[1]) for level in (1000.0, 2000.0))
        start = np.array(eye) + near * view
        expected.append(np.exp(-optical_depth(layer, start, view, far - near, eye, 2000)))
    error = np.abs(seen - expected)
    assert np.median(error) < 0.01
    assert np.quantile(error, 0.9) < 0.05


def test_light_from_any_side_passes_as_the_suns_does():
    """A page dims sun, moon and stars by one map; the scene's sunlight is the same number."""
    layer = rough_layer(drift_m=(130.0, -70.0))
    views = towards((0.3, 1.0, 0.2), (-0.8, 0.9, 0.0), (0.0, 0.2, 1.0), (0.5, 0.01, 0.0))
    eye = (400.0, 20.0, -900.0)
    found = transmittances(layer, eye, views)
    assert found == pytest.approx([sun_share(layer, tuple(view), eye, 0.0) for view in views])
    over_it = (400.0, 3000.0, -900.0)
    assert transmittances(layer, over_it, views[:1]) == pytest.approx([1.0])


def test_the_shadow_is_that_of_the_density():
    """Share of the sun at a place: the quadrature's, to 0.02; a wide square has the mean."""
    layer = rough_layer()
    places = [(x, 0.0, z) for x in (0.0, 300.0, 900.0) for z in (-500.0, 100.0)]
    for place in places:
        expected = sun_transmittance(layer, place, SUN)
        assert sun_share(layer, SUN, place, 0.0) == pytest.approx(expected, abs=0.02)
    mean = sun_share(layer, SUN, GROUND, 2e4)
    random = np.random.default_rng(1).uniform(-2e4, 2e4, (300, 2))
    single = [sun_share(layer, SUN, (x, 0.0, z), 0.0) for x, z in random]
    assert mean == pytest.approx(np.mean(single), abs=0.12)


def test_rays_below_the_layer_see_the_ground_and_from_above_the_tops():
    """From the ground nothing is seen downwards; from 5 km the layer hides the ground."""
    layer = slab(extinction_per_m=0.05)
    down = towards((0.1, -1.0, 0.0), (1.0, -0.2, 0.3))
    from_ground = clouds_seen(layer, DARK, GROUND, down, NARROW_RAD)
    assert np.all(from_ground.transmittance == 1.0)
    assert not from_ground.radiance.any()
    from_aloft = clouds_seen(layer, DARK, (0.0, 5000.0, 0.0), down, NARROW_RAD)
    assert np.all(from_aloft.transmittance == 0.0)
    assert from_aloft.radiance.min() > 1.0
    # From 3 km over the tops, straight down and slanting.
    assert from_aloft.distance_m[0] == pytest.approx(3000.0 / -down[0, 1], rel=0.03)


def test_light_beyond_the_grid_has_no_streaks():
    """The outermost columns, which stand for all beyond, are alike; those within are not."""
    made = light_volume(
        cloud_field(rough_layer(), (0.0, 0.0, 0.0)), np.array([0.6, 0.8, 0.0]), 0.58
    )
    for part in (made.depths, made.diffuse):
        assert np.ptp(part[:, 0], axis=1).max() == 0.0
        assert np.ptp(part[:, 40], axis=1).max() > 0.1


@pytest.mark.parametrize(
    "sun",
    mostly_long(
        [SUN, (1.0, 0.01, 0.0), (1.0, -0.02, 0.0), (0.0, 1.0, 0.0)], lambda sun: sun[1] < 0.1
    ),
)
@pytest.mark.parametrize("height_m", mostly_long([0.0, 1500.0, 3e4, 4e5], lambda m: m > 1e3))
def test_clouds_are_finite_and_not_negative_for_every_eye(sun, height_m):
    """Below, in and above the layer and from space, day and night: finite, not negative."""
    light = ClearLight(sun, (50.0,) * 3, np.concatenate([np.full((1, 3), 9.0), np.zeros((24, 3))]))
    views = towards(*np.random.default_rng(2).normal(size=(60, 3)))
    seen = clouds_seen(rough_layer(), light, (0.0, height_m, 0.0), views, 0.02)
    for values in seen:
        assert np.isfinite(values).all()
        assert values.min() >= 0.0
    assert seen.transmittance.max() <= 1.0


def test_a_wide_ray_is_the_mean_of_the_narrow_ones_in_it():
    """From space a ray takes in clouds and gaps: it passes what they pass in the mean, to 0.06.

    Read from one value of weather it was cloud or gap: grain. 24 rays, 1.7 km wide, 12 x 12 each.
    """
    layer = make_layers(CloudSettings(genus="Cu"))[1][0]
    space, wide_rad, across = (0.0, 4e5, 0.0), 4.2e-3, 12
    around = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)[:, None]
    step = (np.arange(across) + 0.5) / across - 0.5
    up, side = (part.ravel() * wide_rad for part in np.meshgrid(step, step))

    def passed(up, side, pixel_rad):
        height = up - 0.6
        azimuth = around + side / np.cos(0.6)
        level = np.cos(height)
        x, z = level * np.cos(azimuth), level * np.sin(azimuth)
        rays = np.stack([x, np.broadcast_to(np.sin(height), x.shape), z], axis=-1)
        return clouds_seen(layer, DARK, space, rays, pixel_rad).transmittance.mean(axis=1)

    wide = passed(np.zeros(1), np.zeros(1), wide_rad)
    narrow = passed(up, side, wide_rad / across)
    assert wide.mean() == pytest.approx(narrow.mean(), abs=0.06)
    assert np.abs(wide - narrow).mean() < 0.12
    assert np.ptp(wide) < 0.95, "none is cloud or gap alone"

"""Broken clouds beside Monte Carlo in the very density that is drawn."""

import numpy as np
import pytest
from cloud_stage import slab
from clouds.module import make_layers
from clouds.settings import CloudSettings
from i3rc_step_cloud import ABOVE, BELOW, MU_0, PERIOD_M, PIXELS, SUN, StepCloud, phase_function
from i3rc_step_cloud import density as step_density

from tools.cloud_accuracy import ordinates_of
from tools.cloud_monte_carlo import sun_radiance, without_peak
from vrut_lite.daylight.cloud_density import distance_up_m
from vrut_lite.daylight.cloud_density_kernels import optical_depths
from vrut_lite.daylight.cloud_field import cloud_field
from vrut_lite.daylight.cloud_light import ClearLight
from vrut_lite.daylight.cloud_view import clouds_seen
from vrut_lite.daylight.sun_aloft import sun_aloft

pytestmark = pytest.mark.long
PATHS, NARROW_RAD = 1000, 1e-4
# Pitch of the rays, the side that they look to, and the eye's height over ground or tops.
LOOKS = {
    "sunlit": ((8.0, 30.0), -1.0, 0.0),
    "towards": ((8.0, 30.0), 1.0, 0.0),
    "tops": ((-80.0, -30.0), -1.0, 3000.0),
    "bases": ((50.0, 85.0), 0.0, 0.0),
}
FIELDS = {
    "cumulus, low sun": (CloudSettings(genus="Cu", coverage=0.5), 25.0),
    "cumulus": (CloudSettings(genus="Cu", coverage=0.5), 50.0),
    "stratocumulus": (CloudSettings(genus="Sc", coverage=0.7), 35.0),
    "cumulonimbus": (CloudSettings(genus="Cb", coverage=0.3), 30.0),
}
# What is farther off than 20 %, as docs/clouds.md says.
WORSE = {
    ("cumulus", "bases"): (0.7, 1.2),
    ("cumulonimbus", "sunlit"): (0.7, 1.2),
    ("cumulonimbus", "tops"): (0.8, 1.4),
    ("cumulonimbus", "bases"): (1.0, 1.7),
}


def field_of(name):
    """A layer, and the direction of its sun."""
    settings, elevation_deg = FIELDS[name]
    sine = np.sin(np.radians(elevation_deg))
    return make_layers(settings)[1][0], (float(np.sqrt(1.0 - sine**2)), float(sine), 0.0)


def seen(layer, sun, eye, rays):
    """What the clouds send by a sun of irradiance 1 at the middle of the layer."""
    light = ClearLight(sun, (1e-9,) * 3, np.zeros((25, 3)))
    clouds = clouds_seen(layer, light, eye, rays, NARROW_RAD)
    middle = layer.base_m + 0.5 * layer.thickness_m
    return clouds, clouds.radiance[:, 1] / float(sun_aloft(middle, sun[1])[1])


def test_the_truth_is_that_of_discrete_ordinates():
    """In a plane layer of depth 10: each of three rays within four standard errors."""
    sun = np.array([np.cos(0.5), np.sin(0.5), 0.0])
    views = np.array([[0.0, 1.0, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.6, 0.8]])
    field = cloud_field(slab(extinction_per_m=10.0 / 985.0), (0.0, 0.0, 0.0))
    radiance, error = sun_radiance(field, sun, np.tile([0.0, -10.0, 0.0], (3, 1)), views, 20_000)
    truth = ordinates_of(10.0, float(sun[1]))
    expected = [truth.below(view[1], np.arctan2(view[2], view[0])) for view in views]
    assert (np.abs(radiance - expected) < 4.0 * error + 0.02 * radiance).all()


@pytest.mark.parametrize(("from_m", "up", "expected"), [(260.0, -1.0, ABOVE), (-10.0, 1.0, BELOW)])
def test_the_truth_is_that_of_i3rc(from_m, up, expected):
    """The step cloud: the mean within 4 %, the pixels within the noise of some 7 %."""
    parts = 4
    x = (np.arange(PIXELS * parts) + 0.5) / (PIXELS * parts) * PERIOD_M
    origins = np.stack([x, np.full(x.size, from_m), 0.0 * x], axis=-1)
    views = np.tile([0.0, up, 0.0], (x.size, 1))
    own = {"density": step_density, "phase": phase_function()}
    radiance, error = sun_radiance(StepCloud(), SUN, origins, views, 3000, **own)
    ours = np.pi / MU_0 * radiance.reshape(PIXELS, parts).mean(axis=1)
    noise = np.pi / MU_0 * np.sqrt((error.reshape(PIXELS, parts) ** 2).sum(axis=1)) / parts
    assert ours.mean() == pytest.approx(expected.mean(), rel=0.04)
    assert np.sqrt(np.mean(((ours - expected) / noise) ** 2)) < 1.4


@pytest.mark.parametrize("look", LOOKS)
@pytest.mark.parametrize("name", FIELDS)
def test_sides_tops_and_bases_beside_the_truth(name, look):
    """The mean of opaque clouds within 20 %; what is worse is in docs/clouds.md."""
    random = np.random.default_rng(5)
    layer, sun = field_of(name)
    pitch_deg, way, over_m = LOOKS[look]
    eye = (0.0, layer.top_m + over_m if look == "tops" else over_m, 0.0)
    pitch = np.radians(random.uniform(*pitch_deg, 90))
    azimuth = random.uniform(-0.9, 0.9, 90) if way else random.uniform(-np.pi, np.pi, 90)
    level = np.cos(pitch)
    along = (way or 1.0) * level * np.cos(azimuth)
    views = np.stack([along, np.sin(pitch), level * np.sin(azimuth)], axis=-1)
    clouds, ours = seen(layer, sun, eye, views)
    solid = clouds.transmittance < 0.3
    origins = np.tile([0.0, eye[1] - layer.base_m, 0.0], (int(solid.sum()), 1))
    field = cloud_field(layer, eye)
    truth, _ = sun_radiance(field, np.array(sun), origins, views[solid], PATHS)
    low, high = WORSE.get((name, look), (0.8, 1.2))
    assert low < ours[solid].mean() / truth.mean() < high


@pytest.mark.parametrize("name", ["cumulus, low sun", "cumulus", "stratocumulus"])
def test_ground_in_shadow_beside_the_truth(name):
    """Sun and clouds on level ground behind a depth of more than 2: the mean within 20 %."""
    layer, sun = field_of(name)
    random, towards, kept = np.random.default_rng(7), np.array(sun), without_peak()[1]
    rays, weights = rays_of_the_sky(towards)
    found = []
    for x, z in random.uniform(-9000.0, 9000.0, (14, 2)):
        eye = (float(x), 0.0, float(z))
        field = cloud_field(layer, eye)
        ends = [max(distance_up_m(0.0, at_m, sun[1]), 0.0) for at_m in (layer.base_m, layer.top_m)]
        depth = float(optical_depths(field, np.zeros((1, 2)), towards, *ends, 400)[0])
        if depth < 2.0:
            continue
        _, ours = seen(layer, sun, eye, rays)
        origins = np.tile([0.0, -layer.base_m, 0.0], (len(rays), 1))
        truth, _ = sun_radiance(field, towards, origins, rays, 24)
        direct = np.exp(-depth), np.exp(-kept * depth)
        found.append([weights @ ours + direct[0] * sun[1], weights @ truth + direct[1] * sun[1]])
    ours, truth = np.mean(found, axis=0)
    assert len(found) > 3
    assert ours == pytest.approx(truth, rel=0.2)


def rays_of_the_sky(sun, around_rad=0.21, wide=220, near=80):
    """Rays (n, 3) of the sky, denser around the sun, and their shares of level irradiance."""
    k = np.arange(wide) + 0.5
    level, turn = np.sqrt(k / wide), k * np.pi * (1.0 + np.sqrt(5.0))
    rays = np.stack([level * np.cos(turn), np.sqrt(1.0 - k / wide), level * np.sin(turn)], axis=-1)
    rays = rays[rays @ sun < np.cos(around_rad)]
    k = np.arange(near) + 0.5
    off, turn = around_rad * k / near, k * np.pi * (1.0 + np.sqrt(5.0))
    across = np.array([-sun[1], sun[0], 0.0])
    aside = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * np.cross(sun, across)
    ring = np.cos(off)[:, None] * sun + np.sin(off)[:, None] * aside
    shares = 2.0 * np.pi * np.sin(off) * (around_rad / near) * ring[:, 1]
    return np.concatenate([rays, ring]), np.concatenate([np.full(len(rays), np.pi / wide), shares])

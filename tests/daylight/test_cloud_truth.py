"""Broken clouds beside Monte Carlo in the very density that is drawn."""

import numpy as np
import pytest
from cloud_monte_carlo import sun_radiance
from cloud_stage import slab
from clouds.layer import cloud_layer
from clouds.settings import CloudSettings

from tools.cloud_accuracy import ordinates_of
from vrut_lite.daylight.cloud_field import cloud_field
from vrut_lite.daylight.cloud_light import ClearLight
from vrut_lite.daylight.cloud_view import clouds_seen
from vrut_lite.daylight.sun_aloft import sun_aloft

pytestmark = pytest.mark.long
PATHS = 600


def test_the_truth_is_that_of_discrete_ordinates():
    """In a plane layer of depth 10: each of three rays within four standard errors."""
    sun = np.array([np.cos(0.5), np.sin(0.5), 0.0])
    views = np.array([[0.0, 1.0, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.6, 0.8]])
    field = cloud_field(slab(extinction_per_m=10.0 / 985.0), (0.0, 0.0, 0.0))
    seen, error = sun_radiance(field, sun, np.tile([0.0, -10.0, 0.0], (3, 1)), views, 20_000)
    truth = ordinates_of(10.0, float(sun[1]))
    expected = [truth.below(view[1], np.arctan2(view[2], view[0])) for view in views]
    assert (np.abs(seen - expected) < 4.0 * error + 0.02 * seen).all()


@pytest.mark.parametrize(
    ("coverage", "elevation_deg", "height_m", "pitch_deg", "towards_sun", "bounds"),
    [
        (0.5, 25.0, 0.0, (8.0, 30.0), -1.0, (0.8, 1.2)),
        (0.5, 25.0, 0.0, (8.0, 30.0), 1.0, (0.8, 1.2)),
        (0.5, 25.0, 6000.0, (-80.0, -30.0), -1.0, (0.8, 1.25)),
    ],
)
def test_sides_and_tops_beside_the_truth(
    coverage, elevation_deg, height_m, pitch_deg, towards_sun, bounds
):
    """The mean of sunlit sides, of sides before the sun, of tops: as docs/clouds.md says."""
    random = np.random.default_rng(5)
    layer = cloud_layer(CloudSettings(coverage=coverage))
    sine = np.sin(np.radians(elevation_deg))
    sun = (float(np.sqrt(1.0 - sine**2)), float(sine), 0.0)
    pitch = np.radians(random.uniform(*pitch_deg, 120))
    azimuth = random.uniform(-0.9, 0.9, 120)
    level = np.cos(pitch)
    views = np.stack(
        [towards_sun * level * np.cos(azimuth), np.sin(pitch), level * np.sin(azimuth)], axis=-1
    )
    eye = (0.0, height_m, 0.0)
    light = ClearLight(sun, (1e-9,) * 3, np.zeros((25, 3)))
    ours = clouds_seen(layer, light, eye, views, 1e-4)
    solid = ours.transmittance < 0.3
    origins = np.tile([0.0, height_m - layer.base_m, 0.0], (int(solid.sum()), 1))
    truth, _ = sun_radiance(cloud_field(layer, eye), np.array(sun), origins, views[solid], PATHS)
    middle = layer.base_m + 0.5 * layer.thickness_m
    mean = ours.radiance[solid, 1].mean() / float(sun_aloft(middle, sine)[1])
    assert bounds[0] < mean / truth.mean() < bounds[1]

"""An hour at sensors: illuminance, and what of it the sun, the sky and surfaces send."""

from dataclasses import dataclass

import numpy as np

from light_transport.bake import Bake
from light_transport.daylight_numbers.glass import Glass
from light_transport.daylight_numbers.operator import Operator
from light_transport.daylight_numbers.sensor_rays import SKY, ends_of, tree_with_glass
from light_transport.daylight_numbers.sensors import Sensors
from light_transport.daylight_numbers.sky_cells import CELL_SR, cell_directions, cell_radiances
from light_transport.hour.illumination import Illumination
from light_transport.rays.sky_nodes import NODES
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.numeric_types import Float32Array, FloatArray

_OFF = 1e-5
_RAYS_AT_ONCE = 1 << 18


@dataclass(frozen=True, eq=False)
class HourAtSensors:
    """Illuminance (P,) in lux of an hour: `sun` straight, `sky` and open ground straight, and what
    `surfaces` of the scene send; `noise` is the standard error that rays leave in the last two."""

    sun: FloatArray
    sky: FloatArray
    surfaces: FloatArray
    noise: FloatArray

    @property
    def total(self) -> FloatArray:
        """Of all three."""
        return self.sun + self.sky + self.surfaces


def hour_at_sensors(
    bake: Bake, glass: Glass, operator: Operator, sensors: Sensors, hour: Illumination
) -> HourAtSensors:
    """The light of an hour."""
    radiances = np.vstack([cell_radiances(hour.sky), np.asarray(hour.ground_radiance_rgb)])
    radiosity = np.asarray(bake.column_light(hour)[NODES:-1, :3], float)
    nothing = np.zeros_like(radiosity), np.zeros_like(radiances)
    sky, _ = operator.irradiance(radiances, nothing[0])
    surfaces, _ = operator.irradiance(nothing[1], radiosity)
    _, noise = operator.irradiance(radiances, radiosity)
    towards = np.asarray(hour.key_direction, float)[None]
    sun = sun_shares(bake, glass, sensors, towards)[:, 0] * np.asarray(hour.key_irradiance_rgb)
    return HourAtSensors(*(_lux(part) for part in (sun, sky, surfaces, noise)))


def _lux(irradiance_rgb: FloatArray) -> FloatArray:
    return np.asarray(luminance(irradiance_rgb) * LUMENS_PER_WATT)


def sun_shares(bake: Bake, glass: Glass, sensors: Sensors, directions: FloatArray) -> Float32Array:
    """Share (P, H, 3) of light from unit vectors (H, 3) that gets to sensors, times its cosine."""
    tree = tree_with_glass(bake, glass)
    radius = bake.surfaces.radius_m
    places = (sensors.places_m - bake.surfaces.centre_m) / radius + _OFF * sensors.normals
    found = np.zeros((len(sensors), len(directions), 3), np.float32)
    cosine = sensors.normals @ np.asarray(directions, float).T
    above = (cosine > 0.0) & (np.asarray(directions)[:, 1] > 0.0)
    sensor, towards = np.nonzero(above)
    for first in range(0, len(sensor), _RAYS_AT_ONCE):
        some = slice(first, first + _RAYS_AT_ONCE)
        s, d = sensor[some], towards[some]
        target, share = ends_of(bake, tree, glass, places[s], np.asarray(directions)[d])
        got = share[:, 0] * (target[:, 0] == SKY)[:, None]
        found[s, d] = got * cosine[s, d, None]
    return found


def open_irradiance(hour: Illumination) -> FloatArray:
    """Irradiance (3,) of an hour's sky on open level ground, without the key light."""
    sine = cell_directions()[..., 1].mean(axis=1)
    return np.asarray((cell_radiances(hour.sky) * sine[:, None]).sum(axis=0) * CELL_SR)


def daylight_factor(
    bake: Bake, glass: Glass, operator: Operator, sensors: Sensors, hour: Illumination
) -> tuple[FloatArray, FloatArray]:
    """Daylight factor (P,) in percent under a sky without sun, and its standard error (P,)."""
    found = hour_at_sensors(bake, glass, operator, sensors, hour)
    outside = float(_lux(open_irradiance(hour)))
    return 100.0 * found.total / outside, 100.0 * found.noise / outside


def sky_view(operator: Operator) -> FloatArray:
    """Share (P,) of a sensor's hemisphere, weighted by the cosine, through which sky is seen.

    Glass counts by what it passes.
    """
    halves = [half.seen[0][:, :-1].sum(axis=1) for half in operator.halves]
    return np.asarray(sum(halves)).ravel() / (2.0 * np.pi)

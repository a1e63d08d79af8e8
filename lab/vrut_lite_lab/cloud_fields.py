"""Broken clouds beside a Monte Carlo in the very density that is drawn, for docs/clouds.md.

python -m vrut_lite_lab.cloud_fields

Both are means over the same disc of each ray. The Monte Carlo is run twice: the mean product of its
two errors is the mean square error without its own noise.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from clouds.model.cloud_density import distance_up_m
from clouds.model.cloud_density_kernels import optical_depths
from clouds.model.cloud_field import cloud_field
from clouds.model.cloud_light import ClearLight
from clouds.model.cloud_march_kernels import look_at_clouds
from clouds.model.cloud_view import lights_on
from clouds.module import make_layers
from clouds.settings import CloudSettings

from vrut_lite.atmosphere.sunlight import sunlight_at_altitude
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite_lab.cloud_monte_carlo import sun_radiance, without_peak

FIELDS = {
    "Cu, 25 degrees": (CloudSettings(genus="Cu", coverage=0.5), 25.0),
    "Cu, 50 degrees": (CloudSettings(genus="Cu", coverage=0.5), 50.0),
    "Sc, 35 degrees": (CloudSettings(genus="Sc", coverage=0.7), 35.0),
    "Cb, 30 degrees": (CloudSettings(genus="Cb", coverage=0.3), 30.0),
}
# Pitch of the rays, the side that they look to, and the eye's height over ground or tops.
LOOKS = {
    "sunlit": ((8.0, 30.0), -1.0, 0.0),
    "towards": ((8.0, 30.0), 1.0, 0.0),
    "tops": ((-80.0, -30.0), -1.0, 3000.0),
    "bases": ((50.0, 85.0), 0.0, 0.0),
}
# Radius of a disc: as much sky as a texel of the sum's cube, or a pixel of a frame 480 wide.
TEXEL_RAD, PIXEL_RAD = 0.0138, 0.0014
_NARROW_RAD = 1e-4
# Rays of a disc, eyes, rays of an eye, paths of a ray.
_WITHIN, _EYES, _RAYS, _PATHS = 16, 4, 48, 48
_GROUNDS, _SKY_PATHS = 14, 12
_DARKEST, _SHADED = 0.3, 2.0
# Nearer to the sun what passes straight on outshines what clouds scatter.
_FROM_SUN_RAD = np.radians(5.0)
# Of eyes from the middle, at most.
_LEAST_APART_M, _APART = 9000.0, 6.0
_GOLDEN_RAD = np.pi * (1.0 + np.sqrt(5.0))


class Beside(NamedTuple):
    """Light (n, 2) of what is looked at, by a sun of irradiance 1: scattered once, and the rest.

    `truth` (2, n, 2) is that of two seeds.
    """

    ours: FloatArray
    truth: FloatArray

    def errors(self) -> FloatArray:
        """Mean over the truth's, and root of the mean square error over it: (3, 2).

        Of light that is scattered once, of the rest over the mean of all, of all.
        """
        ours = np.concatenate([self.ours, self.ours.sum(axis=-1, keepdims=True)], axis=-1)
        truth = np.concatenate([self.truth, self.truth.sum(axis=-1, keepdims=True)], axis=-1)
        level = truth.mean(axis=(0, 1))
        squares = ((ours - truth[0]) * (ours - truth[1])).mean(axis=0)
        whole = level[-1]
        return np.stack([ours.mean(axis=0) / level, np.sqrt(np.maximum(squares, 0.0)) / whole], -1)


def field_of(name: str) -> tuple[CloudLayer, Vector]:
    """A layer, and the direction of its sun."""
    settings, elevation_deg = FIELDS[name]
    sine = np.sin(np.radians(elevation_deg))
    return make_layers(settings)[1][0], (float(np.sqrt(1.0 - sine**2)), float(sine), 0.0)


def seen(layer: CloudLayer, sun: Vector, eye: Vector, rays: FloatArray) -> tuple[FloatArray, ...]:
    """What clouds send along rays (n, 3) by a sun of irradiance 1 at the middle of the layer.

    (n, 2), scattered once and the rest; and their transmittance (n,).
    """
    light = ClearLight(sun, (1e-9,) * 3, np.zeros((25, 3)))
    lights = lights_on(layer, light, eye, _NARROW_RAD)
    without = lights.phase.copy()
    without[:2] = 0.0
    out = np.empty((2, len(rays), 5))
    field = cloud_field(layer, eye)
    look_at_clouds(field, lights, rays, _NARROW_RAD, out[0])
    look_at_clouds(field, lights._replace(phase=without), rays, _NARROW_RAD, out[1])
    middle_m = layer.base_m + 0.5 * layer.thickness_m
    whole, rest = out[..., 1] / float(sunlight_at_altitude(middle_m, sun[1])[1])
    return np.stack([whole - rest, rest], axis=-1), out[0, :, 3]


def beside(name: str, look: str, disc_rad: float) -> Beside:
    """Discs of one part of a field's clouds, seen from a few eyes."""
    layer, sun = field_of(name)
    parts = [_from(layer, sun, look, disc_rad, number) for number in range(_EYES)]
    ours, truth = zip(*parts, strict=True)
    return Beside(np.concatenate(ours), np.concatenate(truth, axis=1))


def _from(
    layer: CloudLayer, sun: Vector, look: str, disc_rad: float, number: int
) -> tuple[FloatArray, FloatArray]:
    random = np.random.default_rng(5 + number)
    pitch_deg, way, over_m = LOOKS[look]
    x, z = random.uniform(-1.0, 1.0, 2) * _apart_m(layer)
    eye = (float(x), layer.top_m + over_m if look == "tops" else over_m, float(z))
    pitch = np.radians(random.uniform(*pitch_deg, 3 * _RAYS))
    azimuth = (
        random.uniform(-0.9, 0.9, pitch.size) if way else random.uniform(-np.pi, np.pi, pitch.size)
    )
    along = (way or 1.0) * np.cos(pitch) * np.cos(azimuth)
    views = np.stack([along, np.sin(pitch), np.cos(pitch) * np.sin(azimuth)], axis=-1)
    rays = _discs(views, disc_rad)
    light, passed = seen(layer, sun, eye, rays.reshape(-1, 3))
    solid = passed.reshape(-1, _WITHIN).mean(axis=1) < _DARKEST
    kept = np.flatnonzero(solid & (views @ np.array(sun) < np.cos(_FROM_SUN_RAD)))[:_RAYS]
    ours = light.reshape(-1, _WITHIN, 2).mean(axis=1)[kept]
    return ours, _traced(layer, sun, eye, views[kept], disc_rad, _PATHS)


def _traced(
    layer: CloudLayer, sun: Vector, eye: Vector, views: FloatArray, disc_rad: float, paths: int
) -> FloatArray:
    origins = np.tile([0.0, eye[1] - layer.base_m, 0.0], (len(views), 1))
    field, truth = cloud_field(layer, eye), []
    for seed in (1, 2):
        traced = sun_radiance(field, sun, origins, views, paths, seed, disc_rad)
        truth.append(np.stack([traced.once, traced.radiance - traced.once], axis=-1))
    return np.stack(truth)


def _apart_m(layer: CloudLayer) -> float:
    return max(_APART * layer.thickness_m, _LEAST_APART_M)


def _discs(views: FloatArray, disc_rad: float) -> FloatArray:
    """Rays (n, _WITHIN, 3), even over the discs around directions (n, 3)."""
    k = np.arange(_WITHIN) + 0.5
    off, turn = disc_rad * np.sqrt(k / _WITHIN)[:, None], (k * _GOLDEN_RAD)[:, None]
    aside = np.cross(views, np.eye(3)[np.argmin(np.abs(views), axis=1)])
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    upright = np.cross(views, aside)[:, None]
    across = np.cos(turn) * aside[:, None] + np.sin(turn) * upright
    return np.asarray(np.cos(off) * views[:, None] + np.sin(off) * across)


def beside_on_ground(name: str) -> Beside:
    """Irradiance of level ground behind a depth of more than 2, with what is left of the sun."""
    layer, sun = field_of(name)
    towards, kept = np.array(sun), without_peak()[1]
    random = np.random.default_rng(7)
    rays, weights = rays_of_the_sky(towards)
    ours, truth = [], []
    for x, z in random.uniform(-1.0, 1.0, (_GROUNDS, 2)) * _apart_m(layer):
        eye = (float(x), 0.0, float(z))
        ends = [max(distance_up_m(0.0, at_m, sun[1]), 0.0) for at_m in (layer.base_m, layer.top_m)]
        field = cloud_field(layer, eye)
        depth = float(optical_depths(field, np.zeros((1, 2)), towards, *ends, 400)[0])
        if depth < _SHADED:
            continue
        light = weights @ seen(layer, sun, eye, rays)[0]
        traced = np.einsum("n,snc->sc", weights, _traced(layer, sun, eye, rays, 0.0, _SKY_PATHS))
        # What is not scattered, with what is scattered once.
        ours.append(light + np.array([sun[1] * np.exp(-depth), 0.0]))
        truth.append(traced + np.array([sun[1] * np.exp(-kept * depth), 0.0]))
    return Beside(np.array(ours), np.moveaxis(np.array(truth), 0, 1))


def rays_of_the_sky(
    sun: FloatArray, around_rad: float = 0.21, wide: int = 220, near: int = 80
) -> tuple[FloatArray, FloatArray]:
    """Rays (n, 3) of the sky, denser around the sun, and their shares (n,) of level irradiance."""
    k = np.arange(wide) + 0.5
    level, turn = np.sqrt(k / wide), k * _GOLDEN_RAD
    rays = np.stack([level * np.cos(turn), np.sqrt(1.0 - k / wide), level * np.sin(turn)], axis=-1)
    rays = rays[rays @ sun < np.cos(around_rad)]
    k = np.arange(near) + 0.5
    off, turn = around_rad * k / near, k * _GOLDEN_RAD
    across = np.array([-sun[1], sun[0], 0.0])
    aside = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * np.cross(sun, across)
    ring = np.cos(off)[:, None] * sun + np.sin(off)[:, None] * aside
    shares = 2.0 * np.pi * np.sin(off) * (around_rad / near) * ring[:, 1]
    return np.concatenate([rays, ring]), np.concatenate([np.full(len(rays), np.pi / wide), shares])


def lines() -> Iterator[str]:
    """Of each field and part: mean and rms, in %, of all, of light scattered once, of the rest."""
    for name in FIELDS:
        for look in LOOKS:
            for disc_rad in (PIXEL_RAD, TEXEL_RAD):
                yield f"{name}, {look}, {np.degrees(2 * disc_rad):.2f} degrees: " + _said(
                    beside(name, look, disc_rad)
                )
        yield f"{name}, shaded ground: " + _said(beside_on_ground(name))


def _said(found: Beside) -> str:
    once, rest, whole = (f"{mean:.0%}/{rms:.0%}".replace("%", "") for mean, rms in found.errors())
    return f"{whole} (once {once}, rest {rest}; {len(found.ours)})"


def main() -> None:
    """Print the table."""
    for line in lines():
        print(line, flush=True)


if __name__ == "__main__":
    main()

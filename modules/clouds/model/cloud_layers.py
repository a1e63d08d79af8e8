"""Several layers of clouds: how each dims the light of those below it.

In the mean over places: a layer lets a share of the sun through, and sends part of the rest down
from its base, evenly.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clouds.model.cloud_density import sun_transmittance
from clouds.model.cloud_light import ClearLight
from clouds.model.cloud_transport import even_transmittance, layer_transmittance
from vrut_lite.atmosphere.sunlight import sunlight_at_altitude
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.spherical_harmonics import basis, evaluate_irradiance
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import FloatArray, Vector

# Depth of droplets that hinders light as much as a depth of 1 of ice: their mean cosines, 0.75
# after delta-M and 0.48, and the share of droplets' extinction that diffuses, 0.58.
_ICE_DEPTH = (1.0 - 0.48) / (1.0 - 0.75) / 0.58
# Below this sine slant paths through a layer end at its mean gaps.
_LEAST_SINE = 0.05
_DOWN = np.array([0.0, -1.0, 0.0])


def clear_light(
    key_light: KeyLightChanged, irradiance_sh: NDArray, lamps_rgb: Vector
) -> ClearLight:
    """The light of a clear sky on clouds; the moon counts as a sun so much fainter."""
    passed, direction = 1.0, key_light.direction
    if key_light.body == "moon":
        sun = float(luminance(sunlight_at_altitude(0.0, direction[1], key_light.haze)))
        moon = float(luminance(key_light.irradiance_rgb))
        passed = min(moon / sun, 1.0) if sun > 0.0 else 0.0
    irradiance, haze = key_light.irradiance_rgb, key_light.haze
    return ClearLight(direction, irradiance, irradiance_sh, passed, haze, lamps_rgb)


def mean_sun_share(layers: Iterable[CloudLayer], sine: float) -> float:
    """Share of the sun that passes layers, in the mean; `sine` of its elevation."""
    share = 1.0
    for layer in layers:
        hidden = -np.expm1(-layer.optical_depth / max(sine, _LEAST_SINE))
        share *= 1.0 - layer.coverage * float(hidden)
    return share


def sun_transmittance_of(layers: Iterable[CloudLayer], point_m: ArrayLike, sun: ArrayLike) -> float:
    """Transmittance of all layers from a point (3,) towards the sun's direction (3,)."""
    share = 1.0
    for layer in layers:
        share *= sun_transmittance(layer, point_m, sun)
    return share


def lights_on(layers: tuple[CloudLayer, ...], clear: ClearLight) -> tuple[ClearLight, ...]:
    """The light on each layer, from low to high, under those above it."""
    lights = [clear]
    for layer in layers[:0:-1]:
        lights.append(_below(layer, lights[-1], clear))
    lights.reverse()
    return _over_lamps(layers, lights) if any(clear.lamps_rgb) else tuple(lights)


def _over_lamps(layers: tuple[CloudLayer, ...], lights: list[ClearLight]) -> tuple[ClearLight, ...]:
    """The lights with what of the lamps below lower layers let through."""
    seen, lamps = [], lights[0].lamps_rgb
    for layer, light in zip(layers, lights, strict=True):
        seen.append(light._replace(lamps_rgb=lamps))
        passed = 1.0 - layer.coverage * (1.0 - float(even_transmittance(layer.optical_depth)))
        lamps = lamps[0] * passed, lamps[1] * passed, lamps[2] * passed
    return tuple(seen)


def air_share(
    layer: CloudLayer, light: ClearLight, clear: ClearLight, eye_altitude_m: float
) -> FloatArray:
    """Share (3,) of a clear sky's light on the air between an eye and a layer lit by `light`.

    Above the layer it is the layer's own, below it what passes.
    """
    seen = _below(layer, light, clear) if eye_altitude_m < layer.base_m else light
    return np.minimum(seen.on_ground / clear.on_ground, 1.0)


def _below(layer: CloudLayer, light: ClearLight, clear: ClearLight) -> ClearLight:
    """The light under a layer, whose own is `light`."""
    sine = float(clear.sun_direction[1])
    share = mean_sun_share((layer,), sine)
    covered = layer.coverage
    depth = layer.optical_depth * (_ICE_DEPTH if layer.particles == "ice" else 1.0)
    passed = 1.0 - covered + covered * float(layer_transmittance(depth, sine))
    by_sun = max(sine, 0.0) * light.sun_passed * sunlight_at_altitude(layer.top_m, sine, light.haze)
    even = 1.0 - covered + covered * float(even_transmittance(depth))
    by_sky = light.by_sky * even + max(passed - share, 0.0) * by_sun
    dimmed = share * np.asarray(light.sun_irradiance)
    on_ground = dimmed * max(sine, 0.0) + by_sky
    # The ground reflects the same share of its light.
    from_ground = evaluate_irradiance(light.irradiance_sh, _DOWN) * on_ground / light.on_ground
    return ClearLight(
        clear.sun_direction,
        (float(dimmed[0]), float(dimmed[1]), float(dimmed[2])),
        _two_sided(by_sky, from_ground),
        light.sun_passed * share,
        light.haze,
        light.lamps_rgb,
    )


def _two_sided(upward: FloatArray, downward: FloatArray) -> FloatArray:
    """Harmonics (25, 3) whose irradiance on a plane that faces up and down is this (3,) each."""
    even, odd = basis(-_DOWN)[:2]
    harmonics = np.zeros((25, 3))
    harmonics[0] = 0.5 * (upward + downward) / even
    harmonics[1] = 0.5 * (upward - downward) / odd
    return harmonics

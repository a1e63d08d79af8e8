"""Light under clouds of each genus beside Kasten and Czeplak's relation and CIE's overcast sky.

    python -m vrut_lite_lab.cloud_cover

G / G0 = 1 - 0.75 (N / 8)^3.4 (Kasten and Czeplak 1980), N the octas that an observer sees over the
whole hemisphere. N is marched: the share of directions, evenly spread over the sky, in which less
than e^-0.5 of what is behind the clouds is seen. Light is luminous; pyranometers' is all-wave.
Luminance of closed layers by elevation h is beside (1 + 2 sin h) / 3 of the zenith's (CIE type 1,
Moon and Spencer 1942, from measurements).
"""

from collections.abc import Iterator
from datetime import datetime

import msgspec
import numpy as np
from clouds.genera import GENERA, Genus
from clouds.model.cloud_light import ClearLight
from clouds.model.cloud_view import clouds_seen
from clouds.module import make_layers
from clouds.settings import CloudSettings
from clouds.sky_under_clouds import light_under_clouds

from vrut_lite.daylight_kernel import daylight_kernel, demand_light
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.messages import Demand, SetClock
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.sky_layer import Viewpoint

NOON = datetime.fromisoformat("2026-05-01T10:00+00:00")
UP, EYE = np.array([0.0, 1.0, 0.0]), (0.0, 2.0, 0.0)
VIEW = Viewpoint(EYE, (0.0, 0.0, 0.0), 5000.0)
BANDS_DEG, _BAND_DEG = (10.0, 20.0, 30.0, 45.0, 60.0, 90.0), 5.0
COVERAGES = (0.35, 0.7, 1.0)
_PLACES, _APART_M, _SIZE, _RAYS = 12, 31_000.0, 16, 1200
_SEEN = np.exp(-0.5)
# A direction is cloud or none: a wider ray would be a share of both.
_NARROW_RAD = 1e-3


def clear_sky() -> SkyLightChanged:
    """A clear spring noon in Prague, the sun at 54 degrees."""
    kernel, _ = daylight_kernel()
    kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.4))
    kernel.inject(Demand(consumer="tool", message=SkyRadianceChanged.__name__))
    demand_light(kernel, "tool", _SIZE)
    kernel.inject(SetClock(instant=NOON))
    kernel.pump_until_idle()
    light = kernel.last(SkyLightChanged)
    kernel.close()
    assert light is not None
    return light


def octas(layer: CloudLayer, light: ClearLight) -> float:
    """Octas of the hemisphere over an observer that a layer covers."""
    index = np.arange(_RAYS) + 0.5
    mu, turn = index / _RAYS, index * np.pi * (1.0 + np.sqrt(5.0))
    level = np.sqrt(1.0 - mu * mu)
    rays = np.stack([level * np.cos(turn), mu, level * np.sin(turn)], axis=-1)
    seen = clouds_seen(layer, light, EYE, rays, _NARROW_RAD)
    return 8.0 * float((seen.transmittance < _SEEN).mean())


def rows(genus: Genus, clear: SkyLightChanged) -> Iterator[tuple[float, float, float]]:
    """Coverage, octas and G / G0, for each coverage and place."""
    sun = clear.key_light
    harmonics = clear.ambient.irradiance_sh_rgb.values
    light = ClearLight(sun.direction, sun.irradiance_rgb, harmonics)
    open_sky = float(luminance(light.on_ground))
    for coverage in COVERAGES:
        for moved in layers_of(genus, coverage):
            lit = light_under_clouds((moved,), clear, VIEW, _SIZE, "tool")
            by_sky = evaluate_irradiance(lit.ambient.irradiance_sh_rgb.values, UP)
            by_sun = np.asarray(lit.key_light.irradiance_rgb) * sun.direction[1]
            yield coverage, octas(moved, light), float(luminance(by_sky + by_sun)) / open_sky


def layers_of(genus: Genus, coverage: float) -> Iterator[CloudLayer]:
    """A genus over several places."""
    prefix = {"middle_": ("Ac", "As"), "high_": ("Ci", "Cs")}
    of_layer = next((p for p, genera in prefix.items() if genus in genera), "")
    named = {f"{of_layer}genus": genus, f"{of_layer}coverage": coverage}
    layer = make_layers(CloudSettings(**named))[1][0]  # type: ignore[arg-type]
    for place in range(_PLACES):
        yield msgspec.structs.replace(layer, drift_m=(place * _APART_M, -place * _APART_M))


def overcast(genus: Genus, clear: SkyLightChanged) -> FloatArray:
    """Luminance (len(BANDS_DEG),) of a closed layer in bands of elevation, over the zenith's."""
    bands = []
    for layer in layers_of(genus, 1.0):
        radiance = light_under_clouds((layer,), clear, VIEW, 2 * _SIZE, "tool").radiance
        assert radiance is not None
        cube = radiance.cube.values
        height = np.degrees(np.arcsin(texel_directions(cube.shape[1])[..., 1]))
        light = luminance(np.asarray(cube, dtype=float))
        bands.append([light[np.abs(height - band) < _BAND_DEG].mean() for band in BANDS_DEG])
    mean = np.mean(bands, axis=0)
    return np.asarray(mean / mean[-1])


def kasten_czeplak(eighths: float) -> float:
    """G / G0 of a number of octas."""
    return 1.0 - 0.75 * (eighths / 8.0) ** 3.4


if __name__ == "__main__":
    sky = clear_sky()
    print("genus  coverage  octas  G/G0  Kasten and Czeplak")
    for name in GENERA:
        found = np.array(list(rows(name, sky))).reshape(len(COVERAGES), _PLACES, 3)
        for coverage, cover, share in found.mean(axis=1):
            relation = kasten_czeplak(cover)
            print(f"{name:5} {coverage:8.2f} {cover:7.1f} {share:6.2f} {relation:6.2f}", flush=True)
    print("luminance at", *(f"{band:g}" for band in BANDS_DEG), "degrees over the zenith's")
    print("CIE 1", *(f"{(1.0 + 2.0 * np.sin(np.radians(h))) / 3.0:.2f}" for h in BANDS_DEG))
    closed: tuple[Genus, ...] = "Sc", "St", "Ns", "As"
    for name in closed:
        print(name, *(f"{share:.2f}" for share in overcast(name, sky)))

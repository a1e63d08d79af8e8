"""The light that a page sums, and its error against the scene's own."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta

import numpy as np
from light_transport.public import Illumination, SceneTransport

from share.cloud_maps import CloudMaps
from share.frozen_clouds import FrozenClouds
from share.light_basis import LightBasis
from share.light_maps import MapValues
from share.shared_scene import SharedScene, direction_of
from share.sky_table import SkyTable
from share.sun_places import SunPlaces
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.numeric_types import Float32Array, FloatArray
from vrut_lite.place_time import Place, local_text
from vrut_lite.quantities import figure


@dataclass(frozen=True, eq=False)
class HourError:
    """Error of the page's light map in one hour, in shares of the map's mean illuminance.

    `at` is local time. `mean_lux` is the mean of the scene's own light map; `rms`, `p99` and
    `worst` are of the differences.
    """

    at: str
    sun_deg: float
    mean_lux: float
    rms: float
    p99: float
    worst: float

    def line(self) -> str:
        """The error in one line."""
        return (
            f"{self.at}, sun {self.sun_deg:.1f} deg: mean {figure(self.mean_lux)} lx, error rms "
            f"{self.rms:.2%}, 99 of 100 texels below {self.p99:.2%}, worst {self.worst:.1%}"
        )


@dataclass(frozen=True, eq=False)
class PageLight:
    """Light of a page's map: the twin of `page/src/light.js`.

    `apparent_of` gives a sun's apparent elevation; `sun` (S + R, C, K, 3) are coefficients as of
    `LightMaps.by_sun`.
    """

    table: SkyTable
    places: SunPlaces
    apparent_of: Callable[[float], float]
    clouds: CloudMaps | None
    basis: LightBasis
    sun: Float32Array

    def light(self, bodies: list[tuple[float, float, FloatArray]], night: float) -> Float32Array:
        """Light (T, 3) by bodies and by a share of the night's.

        Each body has its geometric elevation, its azimuth from north, and its share (3,) of the
        sun's light.
        """
        basis, count = self.basis, len(self.places.heights)
        coefficients: FloatArray = (night * basis.glow + basis.lamps).astype(float)
        for elevation, azimuth, share in bodies:
            passed = self._passed(elevation, azimuth)
            found = np.zeros(coefficients.shape)
            for place, weight in self.places.weights(elevation, azimuth):
                found += weight * self.sun[place]
                if place < len(self.sun) - count:
                    found += weight * passed * self.sun[count + place]
            coefficients = coefficients + found * self.table.level(elevation) * share
        return basis.light(coefficients)

    def _passed(self, true_rad: float, north_rad: float) -> float:
        """Share of a body's rays that pass the clouds."""
        if self.clouds is None:
            return 1.0
        height = max(self.apparent_of(true_rad), 0.0)
        towards = direction_of(north_rad - self.places.north_offset_rad, height)
        return float(self.clouds.transmittance(np.array([towards]))[0])


def hour_error(
    opened: SharedScene,
    frozen: FrozenClouds | None,
    transport: SceneTransport,
    values: MapValues,
    page: PageLight,
    instant: datetime,
    place: Place,
) -> HourError:
    """The error of an hour: the page's map against that of the scene's own sky."""
    hour: Illumination = opened.hour(instant, frozen)
    light = transport.light(hour)
    true = luminance(values.taken(light.texels, light.probes)[:, :3])
    bodies, night = opened.bodies()
    made = luminance(page.light(bodies, night))
    mean = max(float(true.mean()), 1e-30)
    off = np.abs(made - true) / mean
    return HourError(
        at=local_text(instant, place),
        sun_deg=math.degrees(bodies[0][0]),
        mean_lux=mean * LUMENS_PER_WATT,
        rms=float(np.sqrt(np.mean(off * off))),
        p99=float(np.quantile(off, 0.99)),
        worst=float(off.max()),
    )


def hours_of(start: datetime, count: int) -> list[datetime]:
    """Even hours of the day of an instant, off the grid of the sun's places."""
    midnight = start.replace(hour=0, minute=0, second=0, microsecond=0)
    return [midnight + timedelta(minutes=7 + 1440.0 * k / count) for k in range(count)]

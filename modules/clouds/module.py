"""Clouds on the bus: settings become a layer, and the wind carries it with the clock.

Without coverage, or where nobody asks for clouds, nothing is made and nothing compiled.
"""

import math

import msgspec
import numpy as np

from clouds.settings import CloudSettings
from vrut_lite.daylight.clouds import CloudLayer, CloudsChanged
from vrut_lite.daylight.place import SetPlace
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.kernel.messages import ClockMoved, Demand, JobResult
from vrut_lite.kernel.module import Link, Manifest, Module, handles

NAME = "clouds"
JOB = "layer"
# Less drift than this is less than the noise can show.
LEAST_DRIFT_M = 0.5
_WIND = ("wind_speed_m_s", "wind_azimuth_deg")


class Clouds(Module):
    """Says what clouds there are.

    The ledger counts "clouds" said and "layer" made, and skips as "no coverage", "unwanted",
    "unchanged" and "layer outdated" (another was asked for while it was made).
    """

    manifest = Manifest(name=NAME, title="Clouds", version="0.1.0")
    settings_type = CloudSettings
    settings: CloudSettings

    def __init__(self, link: Link, settings: CloudSettings):
        super().__init__(link, settings)
        self._asked: CloudSettings | None = None
        self._layer: CloudLayer | None = None
        self._told: CloudLayer | None = None

    @handles(ClockMoved)
    @handles(SetPlace)
    @handles(Demand)
    def inputs_changed(self, _message: ClockMoved | SetPlace | Demand) -> None:
        """The wind blew, the wind turned, or someone asks."""
        self._update()

    @handles(JobResult)
    def layer_made(self, result: JobResult) -> None:
        """Say the layer, unless other clouds were asked for meanwhile.

        Raises:
            RuntimeError: it could not be made.
        """
        if result.error:
            self._asked = None
            raise RuntimeError(f"the clouds could not be made: {result.error}")
        made_for, layer = result.value
        if made_for != self._asked:
            self.ledger.skip("layer outdated")
            return
        self._layer = layer
        self.ledger.did("layer")
        self._update()

    def settings_changed(self, name: str) -> None:
        """Make other clouds, move them, or have none."""
        self._update()

    def _update(self) -> None:
        if self.settings.coverage == 0.0:
            self.ledger.skip("clouds: no coverage")
            self._forget()
        elif self.link.wanted(CloudsChanged) is None:
            self.ledger.skip("clouds: unwanted")
        elif self._asked != _without_wind(self.settings):
            self._asked = _without_wind(self.settings)
            self._layer = None
            self.link.start_job(JOB, make_layer, self._asked)
        elif self._layer is not None:
            drift_m = self._drift_m()
            self._say(msgspec.structs.replace(self._layer, drift_m=drift_m))

    def _forget(self) -> None:
        """No clouds any more: say so, once, to those who were told of some."""
        if self._asked is not None:
            self.link.cancel_job(JOB)
            self._asked = self._layer = None
        if self._told is not None:
            self._say(None)

    def _say(self, layer: CloudLayer | None) -> None:
        if layer is not None and _alike(layer, self._told):
            self.ledger.skip("clouds: unchanged")
            return
        self.link.post(CloudsChanged(layer=layer, source=NAME))
        self._told = layer
        self.ledger.did("clouds")

    def _drift_m(self) -> tuple[float, float]:
        clock, place = self.link.last(ClockMoved), self.link.last(SetPlace)
        if clock is None:
            return (0.0, 0.0)
        return drift_m(
            self.settings,
            clock.instant.timestamp(),
            0.0 if place is None else place.north_offset_rad,
        )


def make_layer(settings: CloudSettings) -> tuple[CloudSettings, CloudLayer]:
    """What the background job does; the settings tell whose layer it is."""
    # The noise is compiled: only those who have clouds import numba.
    from clouds.layer import cloud_layer

    return settings, cloud_layer(settings)


def drift_m(
    settings: CloudSettings, seconds: float, north_offset_rad: float = 0.0
) -> tuple[float, float]:
    """How far the wind has carried clouds since a time 0, along world x and z.

    It is a function of the clock alone, so that a time shows the same clouds however it was
    come to. In double precision it is exact to 0.1 mm for seconds since 1970.
    """
    towards = math.radians(settings.wind_azimuth_deg) + math.pi
    east_north_up = direction_from_angles(towards, 0.0)
    x, _, z = settings.wind_speed_m_s * seconds * world_from_enu(east_north_up, north_offset_rad)
    return (float(x), float(z))


def _without_wind(settings: CloudSettings) -> CloudSettings:
    return msgspec.structs.replace(settings, **dict.fromkeys(_WIND, 0.0))


def _alike(layer: CloudLayer, told: CloudLayer | None) -> bool:
    """Whether nobody would see a difference; a layer's noises are made anew with it."""
    if told is None or layer.shape is not told.shape:
        return False
    moved_m = float(np.hypot(*np.subtract(layer.drift_m, told.drift_m)))
    moved_back = msgspec.structs.replace(layer, drift_m=told.drift_m)
    return moved_m < LEAST_DRIFT_M and moved_back == told

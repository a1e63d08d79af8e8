"""The module `clouds`: makes a layer from its settings and moves it with the clock.

Without coverage or without demand nothing is made and nothing compiled.
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
    """Posts `CloudsChanged`.

    The ledger counts "clouds" posted and "layer" made, and skips as "no coverage", "unwanted",
    "unchanged" and "layer outdated" (the settings changed while it was made).
    """

    manifest = Manifest(name=NAME, title="Clouds", version="0.1.0")
    settings_type = CloudSettings
    settings: CloudSettings

    def __init__(self, link: Link, settings: CloudSettings):
        super().__init__(link, settings)
        self._asked: CloudSettings | None = None
        self._layer: CloudLayer | None = None
        self._posted: CloudLayer | None = None

    @handles(ClockMoved)
    @handles(SetPlace)
    @handles(Demand)
    def inputs_changed(self, _message: ClockMoved | SetPlace | Demand) -> None:
        """The clock moves the clouds; a place turns them; a demand may be the first."""
        self._update()

    @handles(JobResult)
    def layer_made(self, result: JobResult) -> None:
        """Post the new layer, unless the settings have changed meanwhile.

        Raises:
            RuntimeError: the job failed.
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
        """Make a new layer, move it, or remove it."""
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
            self._post(msgspec.structs.replace(self._layer, drift_m=drift_m))

    def _forget(self) -> None:
        """Drop the layer; post this once if a layer was posted before."""
        if self._asked is not None:
            self.link.cancel_job(JOB)
            self._asked = self._layer = None
        if self._posted is not None:
            self._post(None)

    def _post(self, layer: CloudLayer | None) -> None:
        if layer is not None and _looks_like(layer, self._posted):
            self.ledger.skip("clouds: unchanged")
            return
        self.link.post(CloudsChanged(layer=layer, source=NAME))
        self._posted = layer
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
    """The background job; it returns its settings too, to identify the layer."""
    # Imported here because it imports numba, which is needed only if there are clouds.
    from clouds.layer import cloud_layer

    return settings, cloud_layer(settings)


def drift_m(
    settings: CloudSettings, seconds: float, north_offset_rad: float = 0.0
) -> tuple[float, float]:
    """Drift of the clouds by the wind since time 0, along world x and z, in m.

    It is a function of the clock alone, so that a time always shows the same clouds. In double
    precision it is exact to 0.1 mm for seconds since 1970.
    """
    towards = math.radians(settings.wind_azimuth_deg) + math.pi
    east_north_up = direction_from_angles(towards, 0.0)
    x, _, z = settings.wind_speed_m_s * seconds * world_from_enu(east_north_up, north_offset_rad)
    return (float(x), float(z))


def _without_wind(settings: CloudSettings) -> CloudSettings:
    return msgspec.structs.replace(settings, **dict.fromkeys(_WIND, 0.0))


def _looks_like(layer: CloudLayer, posted: CloudLayer | None) -> bool:
    """Whether a layer shows what was posted last; each new layer has its own noise arrays."""
    if posted is None or layer.shape is not posted.shape:
        return False
    moved_m = float(np.hypot(*np.subtract(layer.drift_m, posted.drift_m)))
    moved_back = msgspec.structs.replace(layer, drift_m=posted.drift_m)
    return moved_m < LEAST_DRIFT_M and moved_back == posted

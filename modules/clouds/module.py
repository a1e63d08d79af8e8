"""The module `clouds`: makes layers from its settings and moves them with the clock.

Without coverage or without demand nothing is made and nothing compiled. Where the settings follow
the weather, an hour's clouds are by `CloudinessChanged`.
"""

import math

import msgspec
import numpy as np

from clouds.by_weather import layers_under
from clouds.layer import cloud_layer
from clouds.settings import CloudSettings, Layer
from vrut_lite import __version__
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.kernel.messages import ClockMoved, Demand, JobResult
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.messages.cloudiness import CloudinessChanged
from vrut_lite.messages.clouds import CloudLayer, CloudsChanged
from vrut_lite.messages.place import SetPlace

NAME = "clouds"
JOB = "layers"
# Less drift than this is less than the noise can show.
LEAST_DRIFT_M = 0.5
_WIND = tuple(
    prefix + name
    for prefix in ("", "middle_", "high_")
    for name in ("wind_speed_m_s", "wind_azimuth_deg")
)


class Clouds(Module):
    """Posts `CloudsChanged`.

    The counters count "clouds" posted and "layers" made, and skips as "no coverage", "unwanted",
    "unchanged" and "layers outdated" (the settings changed while it was made).
    """

    manifest = Manifest(name=NAME, title="Clouds", version=__version__)
    settings_type = CloudSettings
    settings: CloudSettings

    def __init__(self, link: Link, settings: CloudSettings):
        super().__init__(link, settings)
        self._asked: tuple[CloudSettings, CloudinessChanged | None] | None = None
        self._layers: tuple[CloudLayer, ...] = ()
        self._posted: tuple[CloudLayer, ...] = ()

    @handles(ClockMoved)
    @handles(SetPlace)
    @handles(Demand)
    @handles(CloudinessChanged)
    def inputs_changed(self, _message: ClockMoved | SetPlace | Demand | CloudinessChanged) -> None:
        """Clock, place and weather move, turn and change the clouds; a demand may be the first."""
        self._update()

    @handles(JobResult)
    def layers_made(self, result: JobResult) -> None:
        """Post the new layers, unless the settings have changed meanwhile.

        Raises:
            RuntimeError: the job failed.
        """
        if result.error:
            self._asked = None
            raise RuntimeError(f"the clouds could not be made: {result.error}")
        made_for, layers = result.value
        if made_for != self._asked:
            self.counters.skip("layers outdated")
            return
        self._layers = layers
        self.counters.did("layers")
        self._update()

    def settings_changed(self, name: str) -> None:
        """Make new layers, move them, or remove them."""
        self._update()

    def _update(self) -> None:
        asked = _without_wind(self.settings), self._cloudiness
        if not self._wanted_layers:
            self.counters.skip("clouds: no coverage")
            self._forget()
        elif self.link.wanted(CloudsChanged) is None:
            self.counters.skip("clouds: unwanted")
        elif self._asked != asked:
            self._asked = asked
            self._layers = ()
            self.link.start_job(JOB, make_layers, *asked, role="awaited")
        elif self._layers:
            self._post(self._blown())

    @property
    def _cloudiness(self) -> CloudinessChanged | None:
        """The weather's, where the settings follow it."""
        return self.link.last(CloudinessChanged) if self.settings.follow_weather else None

    @property
    def _wanted_layers(self) -> tuple[Layer, ...]:
        return layers_under(self.settings, self._cloudiness)

    def _forget(self) -> None:
        """Drop the layers; post this once if there were any."""
        if self._asked is not None:
            self.link.cancel_job(JOB)
            self._asked, self._layers = None, ()
        if self._posted:
            self._post(())

    def _post(self, layers: tuple[CloudLayer, ...]) -> None:
        if layers and _look_like(layers, self._posted):
            self.counters.skip("clouds: unchanged")
            return
        self.link.post(CloudsChanged(layers=layers, source=NAME))
        self._posted = layers
        self.counters.did("clouds")

    def _blown(self) -> tuple[CloudLayer, ...]:
        """The layers where the wind has carried them."""
        clock, place = self.link.last(ClockMoved), self.link.last(SetPlace)
        seconds = 0.0 if clock is None else clock.instant.timestamp()
        north_offset_rad = 0.0 if place is None else place.north_offset_rad
        return tuple(
            msgspec.structs.replace(made, drift_m=drift_m(layer, seconds, north_offset_rad))
            for made, layer in zip(self._layers, self._wanted_layers, strict=True)
        )


def make_layers(
    settings: CloudSettings, cloudiness: CloudinessChanged | None = None
) -> tuple[tuple[CloudSettings, CloudinessChanged | None], tuple[CloudLayer, ...]]:
    """The background job; it returns its arguments too, to identify the layers."""
    layers = layers_under(settings, cloudiness)
    return (settings, cloudiness), tuple(cloud_layer(layer, settings.seed) for layer in layers)


def drift_m(layer: Layer, seconds: float, north_offset_rad: float = 0.0) -> tuple[float, float]:
    """Drift of a layer by its wind since time 0, along world x and z, in m.

    It is a function of the clock alone, so that a time always shows the same clouds. In double
    precision it is exact to 0.1 mm for seconds since 1970.
    """
    towards = math.radians(layer.wind_azimuth_deg) + math.pi
    east_north_up = direction_from_angles(towards, 0.0)
    x, _, z = layer.wind_speed_m_s * seconds * world_from_enu(east_north_up, north_offset_rad)
    return (float(x), float(z))


def _without_wind(settings: CloudSettings) -> CloudSettings:
    return msgspec.structs.replace(settings, **dict.fromkeys(_WIND, 0.0))


def _look_like(layers: tuple[CloudLayer, ...], posted: tuple[CloudLayer, ...]) -> bool:
    """Whether layers look like those posted last; their noise arrays may be other objects."""
    if len(layers) != len(posted):
        return False
    for now, was in zip(layers, posted, strict=True):
        moved_m = float(np.hypot(*np.subtract(now.drift_m, was.drift_m)))
        same = now.weather is was.weather
        if not (same and moved_m < LEAST_DRIFT_M):
            return False
        if msgspec.structs.replace(now, drift_m=was.drift_m) != was:
            return False
    return True

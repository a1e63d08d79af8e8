"""The module `aurora`: northern and southern lights by place, hour and Kp."""

from typing import Annotated

import msgspec
import numpy as np

from aurora.curtains import SLOT, AuroraShown, radiance
from aurora.oval import aurora_over
from vrut_lite import __version__
from vrut_lite.array import Array
from vrut_lite.kernel.messages import ClockMoved, Demand, JobResult, SlotChanged
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.kernel.settings import setting
from vrut_lite.messages.haze import SetHaze, haze_of
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky_light import SkyGlowAdded, SkyLightChanged
from vrut_lite.messages.sun import SunMoved
from vrut_lite.sky.night_glow import map_directions

NAME, GLOW = "aurora", "glow"
# The sky of a higher sun outshines it; an oval farther away lies below the horizon.
_OUTSHONE_RAD, _FARTHEST_KM = np.radians(-3.0), 2300.0
# Rows and columns of the glow's map, and how long one serves.
_SHAPE, _SERVES_S = (30, 60), 120.0


class AuroraSettings(msgspec.Struct, frozen=True):
    """Whether there is an aurora, and how strong."""

    on: Annotated[
        bool, setting("Whether northern and southern lights are shown", label="Aurora shown")
    ] = False
    kp: Annotated[
        float, setting("The planetary index Kp of geomagnetic storms", 0, 9, label="Kp index")
    ] = 4.0


class Aurora(Module):
    """Posts `AuroraShown` for its frame part and `SkyGlowAdded` for its light."""

    manifest = Manifest(name=NAME, title="Aurora", version=__version__, provides=(SLOT,))
    speaks = (AuroraShown,)
    settings_type = AuroraSettings
    settings: AuroraSettings

    def __init__(self, link: Link, settings: AuroraSettings):
        super().__init__(link, settings)
        self._shown: AuroraShown | None = None
        self._glow_sources: tuple[object, ...] = ()

    @handles(ClockMoved, SetPlace, SetHaze, SunMoved, SlotChanged, Demand)
    def inputs_changed(self, _message: object) -> None:
        """Another hour, place or air."""
        self._update()

    def settings_changed(self, name: str) -> None:
        """Another strength."""
        self._update()

    def _update(self) -> None:
        last = self.link.last
        clock, place, sun = last(ClockMoved), last(SetPlace), last(SunMoved)
        if clock is None or place is None or sun is None:
            return
        is_on = self.settings.on and self.link.holds(SLOT)
        if not is_on or sun.elevation_rad > _OUTSHONE_RAD:
            self._end("aurora: outshone by the sun" if is_on else "aurora: off")
            return
        haze = haze_of(self.link).optical_depth_550
        shown = aurora_over(place, clock.instant, self.settings.kp, haze, NAME)
        if shown.edge_km > _FARTHEST_KM or shown.edge_km + shown.width_km < -_FARTHEST_KM:
            self._end("aurora: below the horizon")
            return
        # Compared with what this instance posted: the scene drops that when the module is disabled.
        if shown != self._shown:
            self._shown = shown
            self.link.post(shown)
            self.counters.did("aurora")
        sources = place, self.settings, haze, clock.instant.timestamp() // _SERVES_S
        if self.link.wanted(SkyLightChanged) and sources != self._glow_sources:
            self._glow_sources = sources
            self.link.start_job(GLOW, glow_map, shown, role="awaited")

    @handles(JobResult)
    def glow_made(self, result: JobResult) -> None:
        """Light the scene by it."""
        shown = self._shown
        if not result.error and shown is not None and shown.kilorayleigh > 0.0:
            self.link.post(SkyGlowAdded(glow_rgb=result.value, of_slot=SLOT, source=NAME))
            self.counters.did("glow")

    def _end(self, reason: str) -> None:
        self.counters.skip(reason)
        last = self._shown
        if last is not None and last.kilorayleigh > 0.0:
            self._glow_sources = ()
            self._shown = msgspec.structs.replace(last, kilorayleigh=0.0)
            self.link.post(self._shown)
            self.link.post(SkyGlowAdded(glow_rgb=None, of_slot=SLOT, source=NAME))


def glow_map(shown: AuroraShown) -> Array:
    """Radiance (rows, columns, 3) from the ground, laid out as `SkyGlowAdded` says."""
    return Array(radiance(shown, map_directions(*_SHAPE), 0.0).astype(np.float32))

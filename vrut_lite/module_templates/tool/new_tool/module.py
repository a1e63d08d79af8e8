"""The module: posts the light of level ground, at most once in so many minutes."""

from datetime import datetime, timedelta
from typing import Annotated

import msgspec
from vrut_lite.kernel.messages import ClockMoved
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.kernel.settings import setting
from vrut_lite.messages.sky_light import SkyLightChanged

from new_tool.log import LuxLogged, level_ground_lx


class NewToolSettings(msgspec.Struct, frozen=True):
    """Options of the command line and rows of the panel; each field has a default."""

    log_minutes: Annotated[float, setting("Least time between values", 0, 1440, unit="min")] = 10.0


class NewTool(Module):
    """Posts `LuxLogged`; a tool, so that commands offer its settings by --set alone."""

    manifest = Manifest(
        name="new_tool",
        title="New tool",
        version="0.1.0",
        auxiliary=True,
    )
    speaks = (LuxLogged,)
    settings_type = NewToolSettings
    settings: NewToolSettings

    def __init__(self, link: Link, settings: NewToolSettings):
        super().__init__(link, settings)
        self._logged: datetime | None = None
        # Nobody computes light that no one demands.
        link.demand(SkyLightChanged)

    @handles(SkyLightChanged)
    def light_changed(self, light: SkyLightChanged) -> None:
        """Log it, if enough time of the scene's clock has passed, forwards or back."""
        clock = self.link.last(ClockMoved)
        if clock is None:
            return
        least = timedelta(minutes=self.settings.log_minutes)
        if self._logged is not None and abs(clock.instant - self._logged) < least:
            self.counters.skip("log: too soon")
            return
        self._logged = clock.instant
        total_lx, sky_lx = level_ground_lx(light)
        self.link.post(LuxLogged(instant=clock.instant, total_lx=total_lx, sky_lx=sky_lx))
        self.counters.did("log")

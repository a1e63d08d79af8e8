"""A scene and its light by messages, without a window: what the command asks of the host.

Inputs are injected as everywhere, so that the same journal replays them.
"""

from datetime import datetime

from light_transport.hour.hour import Hour
from light_transport.jobs import hour_of
from light_transport.unseen_hours import HourMessages
from vrut_lite.commands.headless_scene import add_headless_scene
from vrut_lite.commands.open_kernel import open_kernel, require_sky, require_sun
from vrut_lite.daylight.daylight_kernel import FaultCollector, demand_light
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.daylight.sky import SkyRadianceChanged
from vrut_lite.daylight.sky_light import SkyLightChanged
from vrut_lite.daylight.sun import SunMoved
from vrut_lite.errors import ModuleFailed
from vrut_lite.kernel.messages import Demand, SetClock
from vrut_lite.project import Project, daylight_inputs, setting_inputs, view_inputs

_CUBE = 128
_CONSUMER = "daylight"


class OpenedScene:
    """A kernel that has opened a project's scene; hours are asked of it one by one."""

    def __init__(self, project: Project):
        """Open the scene.

        Raises:
            UserError: the project has an invalid value, or its scene cannot be read.
        """
        self._kernel = open_kernel()
        self._faults = FaultCollector(self._kernel)
        try:
            add_headless_scene(self._kernel)
            demand_light(self._kernel, _CONSUMER)
            kind = SkyRadianceChanged.__name__
            self._kernel.inject(Demand(consumer=_CONSUMER, message=kind, size=_CUBE))
            for message in (
                *setting_inputs(project, self._kernel),
                *daylight_inputs(project),
                *view_inputs(project),
            ):
                self._kernel.inject(message)
            self._settle()
        except BaseException:
            self.close()
            raise

    @property
    def scene(self) -> SceneOpened:
        """What was opened."""
        found = self._kernel.last(SceneOpened)
        if found is None:
            raise ModuleFailed("no scene is open")
        return found

    @property
    def sun(self) -> SunMoved:
        """Where the sun stands."""
        return require_sun(self._kernel)

    @property
    def source(self) -> str:
        """Who makes the sky."""
        return require_sky(self._kernel).source

    def go_to(self, instant: datetime) -> None:
        """Another hour."""
        self._kernel.inject(SetClock(instant=instant))
        self._settle()

    def hour(self) -> Hour:
        """The light of the present hour, layers such as clouds included."""
        require_sky(self._kernel)
        summed = self._kernel.last(SkyLightChanged)
        radiance = summed.radiance if summed is not None else None
        if summed is not None and radiance is not None:
            return hour_of(HourMessages(radiance, summed.key_light, summed.ambient))
        parts = [self._kernel.last(kind) for kind in HourMessages.__annotations__.values()]
        if any(part is None for part in parts):
            raise ModuleFailed("the sky's module says no light: see `vrut-lite modules`")
        return hour_of(HourMessages(*parts))  # type: ignore[arg-type]

    def close(self) -> None:
        """End background jobs."""
        self._kernel.close()

    def _settle(self) -> None:
        self._kernel.pump_until_idle()
        self._faults.raise_first()

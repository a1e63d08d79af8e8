"""A scene and its light by messages, without a window: what the command asks of the host.

Inputs are injected as everywhere, so that the same journal replays them.
"""

from datetime import datetime

import msgspec
from light_transport.public import Illumination, hour_of

from vrut_lite.errors import ModuleFailed
from vrut_lite.headless import (
    FaultCollector,
    Project,
    SceneManager,
    daylight_inputs,
    open_kernel,
    require_sun,
    setting_inputs,
    view_inputs,
)
from vrut_lite.kernel.messages import Demand, EnableModule, SetClock
from vrut_lite.messages.night import NightLightChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.weather import SetWeather

_CUBE, _COARSE_CUBE = 128, 32
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
            # Nobody looks: a small background, no light map and no air.
            self._kernel.add_module(SceneManager, cube_size=_COARSE_CUBE, lights_surfaces=False)
            self._demand(_CUBE)
            project = msgspec.structs.replace(project, air=False)
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
        """The opened scene."""
        found = self._kernel.last(SceneOpened)
        if found is None:
            raise ModuleFailed("no scene is open")
        return found

    @property
    def sun(self) -> SunMoved:
        """Where the sun stands."""
        return require_sun(self._kernel)

    @property
    def lit_by_sun(self) -> bool:
        """Whether the key light is the sun."""
        light = self._kernel.last(KeyLightChanged)
        return light is not None and light.body == "sun"

    @property
    def place(self) -> SetPlace:
        """Where the scene stands."""
        found = self._kernel.last(SetPlace)
        assert found is not None
        return found

    @property
    def standard_offset_h(self) -> float:
        """Hours by which standard time goes before UTC: the weather file's, or that of the zone by
        longitude."""
        weather = self._kernel.last(SetWeather)
        if weather is not None and weather.path:
            return weather.utc_offset_h
        return float(round(self.place.longitude_deg / 15.0))

    @property
    def source(self) -> str:
        """The title of the module that makes the sky, and its name."""
        name = self._light.background.source
        return f"{self._kernel.check_module(name).manifest.title}, {name}"

    @property
    def _light(self) -> SkyLightChanged:
        require_sun(self._kernel)
        found = self._kernel.last(SkyLightChanged)
        if found is None or found.radiance is None:
            raise ModuleFailed("no module makes a sky: see `vrut-lite modules`")
        return found

    def go_to(self, instant: datetime) -> None:
        """Another hour."""
        self._kernel.inject(SetClock(instant=instant))
        self._settle()

    def hour(self) -> Illumination:
        """The light of the present hour, layers such as clouds included."""
        return hour_of(self._light)

    def close(self) -> None:
        """End background jobs."""
        self._kernel.close()

    def coarser(self) -> None:
        """Ask for light that is fine enough for the cells of the ray table, for many hours.

        Stars and moon are not made any more.
        """
        self._demand(_COARSE_CUBE)
        night = self._kernel.last(NightLightChanged)
        for module in ("scene", "" if night is None else night.source):
            if module:
                self._kernel.inject(EnableModule(module=module, enabled=False))

    def _demand(self, size: int) -> None:
        for kind in (SkyRadianceChanged, SkyLightChanged):
            self._kernel.inject(Demand(consumer=_CONSUMER, message=kind.__name__, size=size))

    def _settle(self) -> None:
        self._kernel.pump_until_idle()
        self._faults.raise_first()

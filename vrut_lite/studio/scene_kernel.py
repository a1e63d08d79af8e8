"""A scene and its light by messages, without a window: what commands of modules compute from.

Inputs are injected as everywhere, so that the same journal replays them.
"""

from datetime import datetime

import msgspec

from vrut_lite.daylight_kernel import FaultCollector
from vrut_lite.errors import ModuleFailed
from vrut_lite.kernel.messages import Demand, SetClock
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.project import Project, daylight_inputs, setting_inputs, view_inputs
from vrut_lite.scene.manager import SceneManager
from vrut_lite.studio.open_kernel import open_kernel, require_sun


class SceneKernel:
    """A kernel that has opened a project's scene, without a light map and without air.

    Attributes:
        kernel: the kernel, all of whose inputs are handled.
    """

    def __init__(self, project: Project, consumer: str, cube_px: int, background_px: int):
        """Open the scene.

        Args:
            project: what to open.
            consumer: who asks for the sky.
            cube_px: edge of the sky's cube maps.
            background_px: edge of the scene's cube maps.

        Raises:
            UserError: the project has an invalid value, or its scene cannot be read.
        """
        self.kernel = open_kernel()
        self._faults = FaultCollector(self.kernel)
        self._consumer = consumer
        try:
            self.kernel.add_module(SceneManager, cube_size=background_px, lights_surfaces=False)
            self.demand(cube_px)
            project = msgspec.structs.replace(project, air=False)
            for message in (
                *setting_inputs(project, self.kernel),
                *daylight_inputs(project),
                *view_inputs(project),
            ):
                self.kernel.inject(message)
            self.settle()
        except BaseException:
            self.close()
            raise

    @property
    def scene(self) -> SceneOpened:
        """The opened scene."""
        found = self.kernel.last(SceneOpened)
        if found is None:
            raise ModuleFailed("no scene is open")
        return found

    @property
    def place(self) -> SetPlace:
        """Where the scene stands."""
        found = self.kernel.last(SetPlace)
        assert found is not None
        return found

    @property
    def light(self) -> SkyLightChanged:
        """All light of the present sky.

        Raises:
            ModuleFailed: no module holds the sun, or none makes a sky.
        """
        require_sun(self.kernel)
        found = self.kernel.last(SkyLightChanged)
        if found is None or found.radiance is None:
            raise ModuleFailed("no module makes a sky: see `vrut-lite modules`")
        return found

    def go_to(self, instant: datetime) -> None:
        """Another hour."""
        self.kernel.inject(SetClock(instant=instant))
        self.settle()

    def demand(self, cube_px: int) -> None:
        """Ask for the sky in cube maps of this edge."""
        for kind in (SkyRadianceChanged, SkyLightChanged):
            self.kernel.inject(Demand(consumer=self._consumer, message=kind.__name__, size=cube_px))

    def settle(self) -> None:
        """Handle all inputs; what modules raised is raised here."""
        self.kernel.pump_until_idle()
        self._faults.raise_first()

    def close(self) -> None:
        """End background jobs."""
        self.kernel.close()

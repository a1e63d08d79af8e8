"""A scene and its light by messages, without a window: what the command asks of the host.

Inputs are injected as everywhere, so that the same journal replays them.
"""

import msgspec
from light_transport.public import Illumination, hour_of

from vrut_lite.errors import ModuleFailed
from vrut_lite.headless import Project, SceneKernel, require_sun
from vrut_lite.kernel.messages import EnableModule
from vrut_lite.messages.night import NightLightChanged
from vrut_lite.messages.sky import LookAround, SkyRadianceChanged, SkySpectraSeen
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.weather import SetWeather

_CUBE, _COARSE_CUBE = 128, 32
_CONSUMER = "daylight"


class OpenedScene(SceneKernel):
    """A scene whose light is asked hour by hour."""

    def __init__(self, project: Project):
        """Open the scene.

        Raises:
            UserError: the project has an invalid value, or its scene cannot be read.
        """
        # Nobody looks: a small background.
        super().__init__(project, _CONSUMER, cube_px=_CUBE, background_px=_COARSE_CUBE)

    @property
    def sun(self) -> SunMoved:
        """Where the sun stands."""
        return require_sun(self.kernel)

    @property
    def lit_by_sun(self) -> bool:
        """Whether the key light is the sun."""
        light = self.kernel.last(KeyLightChanged)
        return light is not None and light.body == "sun"

    @property
    def standard_offset_h(self) -> float:
        """Hours by which standard time goes before UTC: the weather file's, or that of the zone by
        longitude."""
        weather = self.kernel.last(SetWeather)
        if weather is not None and weather.path:
            return weather.utc_offset_h
        return float(round(self.place.longitude_deg / 15.0))

    @property
    def source(self) -> str:
        """The title of the module that makes the sky, and its name."""
        name = self.light.background.source
        return f"{self.kernel.check_module(name).manifest.title}, {name}"

    def hour(self) -> Illumination:
        """The light of the present hour, layers such as clouds included."""
        return hour_of(self.light)

    def clear_hour(self) -> Illumination:
        """The light of the present hour's sky without layers."""
        light = self.light
        kinds = ((SkyRadianceChanged, "radiance"), (KeyLightChanged, "key_light"))
        parts = {name: last for kind, name in kinds if (last := self.kernel.last(kind)) is not None}
        return hour_of(msgspec.structs.replace(light, layers=(), **parts))

    def spectra(self, wavelength_nm: tuple[float, ...], size: int) -> SkySpectraSeen:
        """Spectra of the present hour's sky, sun and ground."""
        self.kernel.inject(LookAround(wavelength_nm=wavelength_nm, size=size))
        self.settle()
        found = self.kernel.last(SkySpectraSeen)
        if found is None:
            raise ModuleFailed("the sky tells no spectra: see `vrut-lite modules`")
        return found

    def coarser(self) -> None:
        """Ask for light that is fine enough for the cells of the ray table, for many hours.

        Stars and moon are not made any more.
        """
        self.demand(_COARSE_CUBE)
        night = self.kernel.last(NightLightChanged)
        for module in ("scene", "" if night is None else night.source):
            if module:
                self.kernel.inject(EnableModule(module=module, enabled=False))

"""Every message type of daylight, for journals and tools that find types by name."""

from vrut_lite.kernel.messages import Derived, Input, Message
from vrut_lite.messages.air import AirChanged
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.cloudiness import CloudinessChanged
from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.messages.ground import SetGround
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.moon_path import MoonPathChanged
from vrut_lite.messages.night import MoonDiscChanged, NightLightChanged, StarsChanged
from vrut_lite.messages.picture import PictureClicked, Resize, SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.scene import LoadScene, SceneNeeds, SceneOpened
from vrut_lite.messages.section import SectionChanged
from vrut_lite.messages.sky import (
    AmbientChanged,
    BackgroundChanged,
    LookAlong,
    LookAround,
    SkyPolarisationChanged,
    SkyRadianceChanged,
    SkySpectraSeen,
    SpectrumSeen,
)
from vrut_lite.messages.sky_light import SkyGlowAdded, SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.messages.tolerance import SetTolerance
from vrut_lite.messages.view_light import StillAsked, ViewLightChanged
from vrut_lite.messages.weather import SetWeather

INPUTS: tuple[type[Input], ...] = (
    SetPlace,
    LoadScene,
    MoveCamera,
    Resize,
    SetExposure,
    LookAlong,
    LookAround,
    SetTolerance,
    SetHaze,
    SetGround,
    SetWeather,
    PictureClicked,
    RendererTried,
)
DERIVED: tuple[type[Derived], ...] = (
    SceneOpened,
    SceneNeeds,
    SectionChanged,
    SunMoved,
    BackgroundChanged,
    KeyLightChanged,
    SpectrumSeen,
    SkySpectraSeen,
    AirChanged,
    CloudinessChanged,
    CloudsChanged,
    AmbientChanged,
    SkyRadianceChanged,
    SkyPolarisationChanged,
    SkyGlowAdded,
    SkyLightChanged,
    GpuJob,
    LightMapLaid,
    SurfaceLightChanged,
    StillAsked,
    NightLightChanged,
    StarsChanged,
    MoonDiscChanged,
    MoonPathChanged,
    ViewLightChanged,
)
DAYLIGHT_MESSAGES: tuple[type[Message], ...] = INPUTS + DERIVED

"""Every message type of daylight, for journals and tools that find types by name."""

from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.cloudiness import CloudinessChanged
from vrut_lite.daylight.clouds import CloudsChanged
from vrut_lite.daylight.gpu_job import GpuJob
from vrut_lite.daylight.haze import SetHaze
from vrut_lite.daylight.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.daylight.moon_path import MoonPathChanged
from vrut_lite.daylight.night import MoonDiscChanged, NightLightChanged, StarsChanged
from vrut_lite.daylight.picture import PictureClicked, Resize, SetExposure
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.scene import LoadScene, SceneNeeds, SceneOpened
from vrut_lite.daylight.section import SectionChanged
from vrut_lite.daylight.sky import (
    AmbientChanged,
    BackgroundChanged,
    LookAlong,
    SkyRadianceChanged,
    SpectrumSeen,
)
from vrut_lite.daylight.sky_light import SkyGlowAdded, SkyLightChanged
from vrut_lite.daylight.sun import KeyLightChanged, SunMoved
from vrut_lite.daylight.tolerance import SetTolerance
from vrut_lite.daylight.view_light import StillAsked, ViewLightChanged
from vrut_lite.daylight.weather import SetWeather
from vrut_lite.kernel.messages import Derived, Input, Message

INPUTS: tuple[type[Input], ...] = (
    SetPlace,
    LoadScene,
    MoveCamera,
    Resize,
    SetExposure,
    LookAlong,
    SetTolerance,
    SetHaze,
    SetWeather,
    PictureClicked,
)
DERIVED: tuple[type[Derived], ...] = (
    SceneOpened,
    SceneNeeds,
    SectionChanged,
    SunMoved,
    BackgroundChanged,
    KeyLightChanged,
    SpectrumSeen,
    AirChanged,
    CloudinessChanged,
    CloudsChanged,
    AmbientChanged,
    SkyRadianceChanged,
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

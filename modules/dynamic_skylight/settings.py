"""The settings of DynamicSkyLight; time and place belong to the host."""

from typing import Annotated, ClassVar, Literal

import msgspec

from dynamic_skylight.sun.position import Method
from dynamic_skylight.sun_light import SunColour
from vrut_lite.atmosphere.aerosol import LEAST_TURBIDITY, MOST_TURBIDITY
from vrut_lite.kernel.settings import setting
from vrut_lite.sky.device_choice import DeviceSetting
from vrut_lite.sky.effective_defaults import Preset

SkyLevel = Literal["equal-haze", "published"]


class DynamicSkyLightSettings(msgspec.Struct, frozen=True):
    """The settings of the module."""

    # Snow and sand reflect much (Oke 1987, table 1.1).
    presets: ClassVar[dict[str, Preset]] = {
        "Clear": Preset("a blue sky after a front: depth 0.10", {"turbidity": 2.0}),
        "Hazy": Preset("a white summer sky, pale hills: depth 0.50", {"turbidity": 6.0}),
        "Desert": Preset(
            "bright sand below haze of depth 0.40; Clear sky (atmosphere) has the dust",
            {"turbidity": 5.0, "albedo": 0.35},
        ),
        "Alpine": Preset("clean air above snow: depth 0.07", {"turbidity": 1.7, "albedo": 0.6}),
        "As published": Preset(
            "the model, its haze and its sun as its authors give them",
            {"sky_level": "published", "sun_colour": "disc"},
        ),
    }
    turbidity: Annotated[
        float | None,
        setting(
            "Haze of this sky alone, on Preetham's scale: 2 is clear, 6 is hazy; unless set, the "
            "place's haze",
            LEAST_TURBIDITY,
            MOST_TURBIDITY,
            source="Preetham, Shirley and Smits 1999, appendix A.1",
        ),
    ] = None
    albedo: Annotated[
        float | None,
        setting(
            "Share of light that a grey ground of this sky alone reflects; unless set, the "
            "place's ground",
            0.0,
            1.0,
            source="Hosek and Wilkie 2012, equations 8 and 9",
        ),
    ] = None
    sky_level: Annotated[
        SkyLevel,
        setting(
            "equal-haze: turbidity and level at which this sky is most like the solved sky of the "
            "same optical depth, for continental haze up to a depth of 0.5, beyond which it cannot "
            "follow; published: the model as its authors give it, at Preetham's turbidity, 1.1 to "
            "2 times too bright",
            source="Hosek and Wilkie 2012; vrut_lite_lab.hosek_wilkie_fit",
            label="Level of the sky",
        ),
    ] = "equal-haze"
    sun_colour: Annotated[
        SunColour,
        setting(
            "Where the sun's light comes from: through the same air as the sky's haze, the "
            "model's own disc (25 % weaker), the disc in the colour of the sky's formula at the "
            "sun, or the disc in white",
            source="Hosek and Wilkie 2013, the solar radiance function",
        ),
    ] = "air"
    sun_method: Annotated[
        Method,
        setting(
            "Sun position by ephemeris or by the thesis's short series",
            source="VSOP87; Preetham et al. 1999 after Hvezda 2020, corrected",
            label="Sun's position",
            choice_labels={"ephemeris": "By ephemeris", "preetham": "By Preetham's short series"},
        ),
    ] = "ephemeris"
    cube_device: Annotated[
        DeviceSetting,
        setting(
            "What computes the sky's cube map: auto, by a trial of the renderer; the CPU; or the "
            "GPU where there is one, by day",
            label="Computed on",
        ),
    ] = "auto"

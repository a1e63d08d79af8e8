"""Settings of light transport."""

from typing import Annotated

import msgspec

from light_transport.tolerance import Rung
from vrut_lite.kernel.settings import setting
from vrut_lite.sky.device_choice import DeviceSetting


class LightTransportSettings(msgspec.Struct, frozen=True):
    """The settings of the module; None follows the tolerance."""

    on: Annotated[
        bool,
        setting(
            "Whether things hide the sky and send light to each other; off, all are lit by the "
            "open sky",
            label="Surfaces light each other",
        ),
    ] = True
    texel_m: Annotated[
        float | None,
        setting(
            "Edge of the light map's texels; unless set, as many texels as the tolerance asks for",
            1e-4,
            1e4,
            unit="m",
            label="Edge of texels",
        ),
    ] = None
    quality: Annotated[
        Rung | None,
        setting("Texels, rays, patches and bounces together; unless set, each by the tolerance"),
    ] = None
    device: Annotated[
        DeviceSetting,
        setting(
            "Where the light of an hour is computed: on the graphics card if it is quick enough, "
            "or always on one of both",
            label="Computed by",
        ),
    ] = "auto"

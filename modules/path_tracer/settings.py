"""Settings of the path tracer."""

from typing import Annotated, Literal

import msgspec

from vrut_lite.kernel.settings import setting

# What stands for what is no metal: see `PathTracerSettings.surfaces`.
SurfaceModel = Literal["layered", "gltf", "bare", "principled"]


class PathTracerSettings(msgspec.Struct, frozen=True):
    """The settings of the module; a change begins the picture anew."""

    spp: Annotated[int, setting("Samples per pixel of a finished picture", 1, 65536)] = 64
    max_bounces: Annotated[
        int | None,
        setting("How many surfaces light may meet, 1 for direct light alone; none: any", 1, 1000),
    ] = None
    sun: Annotated[
        Literal["disc", "sharp"],
        setting(
            "The sun as its disc, darkened to the limb, or as a direction, with the "
            "sharp shadows of the GL frame and no disc to be seen"
        ),
    ] = "disc"
    surfaces: Annotated[
        SurfaceModel,
        setting(
            "What is no metal: Lambert's surface under a coat, as glTF has it, bare "
            "of its coat, or a principled BSDF",
            source="glTF 2.0, appendix B; Burley 2012",
        ),
    ] = "gltf"
    variant: Annotated[
        Literal["scalar", "llvm"], setting("Of mitsuba: scalar_rgb, or llvm_ad_rgb where it runs")
    ] = "scalar"

"""Settings of the path tracer."""

from typing import Annotated, Literal

import msgspec

from vrut_lite.kernel.settings import setting

# Model of a material's surface: see `PathTracerSettings.surfaces`.
SurfaceModel = Literal["layered", "gltf", "bare", "principled"]


class PathTracerSettings(msgspec.Struct, frozen=True):
    """The settings of the module; a change restarts the picture."""

    spp: Annotated[
        int, setting("Samples per pixel of a finished picture", 1, 65536, label="Samples a pixel")
    ] = 64
    max_bounces: Annotated[
        int | None,
        setting(
            "How many surfaces light may meet, 1 for direct light alone; unless set, any",
            1,
            1000,
            choice_labels={"none": "any"},
        ),
    ] = None
    sun: Annotated[
        Literal["disc", "sharp"],
        setting(
            "The sun as its disc, darkened to the limb, or as a direction, with the "
            "sharp shadows of the GL frame and no disc to be seen"
        ),
    ] = "disc"
    surfaces: Annotated[
        Literal["auto", "layered", "gltf", "bare", "principled"],
        setting(
            "The GL frame's own surfaces, layered, which take sixty times as long in scalar; or by "
            "mitsuba's plugins Lambert's surface under a coat of even strength, gltf, or bare of "
            "its coat, or a principled BSDF; auto: layered in llvm, gltf in scalar",
            source="Kelemen and Szirmay-Kalos 2001; Turquin 2019; glTF 2.0, appendix B; "
            "Burley 2012",
            choice_labels={"gltf": "glTF"},
        ),
    ] = "auto"
    denoise: Annotated[
        bool,
        setting(
            "Whether a finished picture is shown without grain, by Open Image Denoise where "
            "mitsuba-oidn is installed; EXR keeps what was traced",
            source="Afra 2024",
        ),
    ] = True
    variant: Annotated[
        Literal["auto", "scalar", "llvm"],
        setting(
            "Of mitsuba: scalar_rgb, or llvm_ad_rgb; auto: llvm where it runs",
            label="Variant of Mitsuba",
        ),
    ] = "auto"

"""Settings of the scene: how its picture is drawn, cut and animated."""

from typing import Annotated, Literal

import msgspec

from vrut_lite.kernel.settings import setting
from vrut_lite.messages.section import Axis, Side
from vrut_lite.scene.scene_state import Shown

# The scene manager as a module.
SCENE = "scene"
Animated = Literal["rest", "time", "clock"]


class SceneSettings(msgspec.Struct, frozen=True):
    """Settings of the scene manager.

    Each is also a field of a project, with `--set scene.NAME` on the command line, a row in the
    Scene panel, and undone: all of this follows from its entry here.
    """

    air: Annotated[bool, setting("Whether the scene is seen through the air.")] = True
    light_shafts: Annotated[bool, setting("Whether the scene's shadows are seen in the air.")] = (
        False
    )
    animation: Annotated[
        Animated,
        setting(
            "The scene's own animations: at rest, at animation_time_s, or by the clock, a second "
            "of the day one of the animation."
        ),
    ] = "rest"
    animation_time_s: Annotated[
        float,
        setting("Time of the animations, which begin anew after their end.", 0, 3600, unit="s"),
    ] = 0.0
    section: Annotated[
        Axis,
        setting("Across which axis the picture is cut, as a model is; light and shadows are not"),
    ] = "off"
    section_at: Annotated[
        float, setting("Where it is cut, as a share of the scene's extent on that axis", 0, 1)
    ] = 0.5
    shows: Annotated[
        Shown,
        setting(
            "The picture, or in false colours what surfaces have: illuminance in lux, the edge of "
            "the light map's texels, the noise that its rays leave"
        ),
    ] = "picture"
    polariser_deg: Annotated[
        float | None,
        setting(
            "Angle of a polariser before the camera: light passes that vibrates so far "
            "counter-clockwise from the picture's vertical. Unpolarised light keeps its radiance, "
            "of which a real filter passes half. None: no polariser",
            unit="deg",
            label="Polariser",
            choice_labels={"none": "none"},
        ),
    ] = None
    section_keeps: Annotated[
        Side, setting("Which side of the cut is seen, by the axis's values")
    ] = "below"

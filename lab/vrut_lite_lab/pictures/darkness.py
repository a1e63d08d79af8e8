"""Light of zero, as messages: for pictures of one light without the others."""

from dataclasses import replace
from typing import Any

import msgspec
import numpy as np

from vrut_lite.array import Array
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.scene.scene_state import SceneState

NAME = "darkness"


def no_background() -> BackgroundChanged:
    """A black sky over black ground."""
    return BackgroundChanged(
        cube=Array(np.zeros((6, 2, 2, 3), np.float16)),
        radiance_scale=1.0,
        ground_radiance_rgb=(0.0, 0.0, 0.0),
        source=NAME,
    )


def no_sun() -> KeyLightChanged:
    """A sun in the zenith that gives no light."""
    even = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return KeyLightChanged(
        direction=(0.0, 1.0, 0.0),
        irradiance_rgb=(0.0, 0.0, 0.0),
        angular_radius_rad=0.00465,
        limb_darkening_rgb=(even, even, even),
        source=NAME,
    )


def no_ambient() -> AmbientChanged:
    """No light from anywhere."""
    return AmbientChanged(irradiance_sh_rgb=Array(np.zeros((25, 3), np.float32)), source=NAME)


def relit(state: SceneState, **parts: Any) -> SceneState:
    """The state with another `background`, `key_light` or `ambient`; its ground keeps its albedo.

    Another background lights the scene too.
    """
    light = state.sky_light
    assert light is not None
    radiance = None if "background" in parts else light.radiance
    return replace(
        state, sky_light=msgspec.structs.replace(light, radiance=radiance, **parts), **parts
    )

"""Light as messages, for tests that need no sky model."""

import numpy as np

from vrut_lite.array import Array
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged, SkyRadianceChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.geometry import spherical_harmonics


def light_messages(cube, sun_direction=(0.0, 1.0, 0.0), sun_irradiance=(0.0, 0.0, 0.0)):
    """Background, sun light and ambient of a cube map (6, n, n, 3), with a uniform sun disc."""
    direction = np.asarray(sun_direction, float) / np.linalg.norm(sun_direction)
    ground = cube[3, cube.shape[1] // 2, cube.shape[1] // 2]
    harmonics = spherical_harmonics.irradiance_coefficients(cube).astype(np.float32)
    return (
        BackgroundChanged(
            cube=Array(cube.astype(np.float16)),
            radiance_scale=1.0,
            ground_radiance_rgb=tuple(map(float, ground)),
            source="test",
        ),
        KeyLightChanged(
            direction=tuple(map(float, direction)),
            irradiance_rgb=tuple(map(float, sun_irradiance)),
            angular_radius_rad=0.00465,
            limb_darkening_rgb=((1.0,),) * 3,
            source="test",
        ),
        AmbientChanged(irradiance_sh_rgb=Array(harmonics), source="test"),
    )


def radiance_of(background):
    """The same sky as it lights the scene."""
    return SkyRadianceChanged(
        cube=background.cube,
        radiance_scale=background.radiance_scale,
        ground_radiance_rgb=background.ground_radiance_rgb,
        source=background.source,
    )

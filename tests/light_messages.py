"""Light as messages, for tests that need no sky model."""

import numpy as np
from air_phases import lobe

from vrut_lite.array import Array
from vrut_lite.geometry import spherical_harmonics
from vrut_lite.messages.air import AirChanged, AirVolume, SecondLight
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged, SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged


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


def clear_sky_light(background, key_light, ambient):
    """The complete light of a clear sky, with its radiance on the ground."""
    return SkyLightChanged(
        background=background,
        key_light=key_light,
        ambient=ambient,
        radiance=radiance_of(background),
        source="test",
    )


def second_light(light, direction=(0.6, 0.0, 0.8)):
    """Light (half) of a second body in air, by default of one on the horizon."""
    return SecondLight(light=Array(light), radiance_scale=0.5, direction=direction)


def small_air(light, **changes):
    """Air of two columns, two rows above the level and two below it, with this light (half)."""
    volume = {
        "light": Array(light),
        "columns": 2,
        "extinction": Array(np.full((*light.shape[1:3], 3), 1e-5, np.float32)),
        "radiance_scale": 0.25,
        "aerosol_phase": lobe(0.8, 0.1, 1.0, angles=64),
        "rows_above": 2,
        "rows_below": 2,
        "reach_m": 1e5,
        "observer_altitude_m": 2.0,
        "ground_radius_m": 6.36e6,
        "top_altitude_m": 6e4,
        "sun_direction": (0.0, 1.0, 0.0),
    }
    return AirChanged(volume=AirVolume(**(volume | changes)), source="sample")

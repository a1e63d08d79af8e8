"""A year's light made of known hours."""

import numpy as np
from daylight_numbers.year.year_light import YearLight
from light_transport.rays.sky_nodes import GROUND_NODE, node_radiances


def year_like(hours, lights):
    """A year's light of hours with these lights."""
    sky = [
        node_radiances(light.sky, light.ground_radiance_rgb)[: GROUND_NODE + 1] for light in lights
    ]
    return YearLight(
        np.asarray(hours),
        np.array(sky, np.float32),
        np.array([light.key_direction for light in lights]),
        np.array([light.key_irradiance_rgb for light in lights]),
        np.array(lights[0].ground_albedo_rgb),
        "test",
    )

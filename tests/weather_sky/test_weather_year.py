"""A year on a plane against the same hours one at a time."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from weather_sky.conditions import Conditions
from weather_sky.light import WeatherLight
from weather_sky.year import irradiance_of_year

from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles
from vrut_lite.geometry.frames import enu_from_world, world_from_enu
from vrut_lite.messages.haze import DEFAULT_HAZE
from vrut_lite.sky.suns import suns_of_year
from vrut_lite.weather.weather_file import read_weather


@pytest.mark.parametrize("normal", [(0.36, -0.48, 0.8)])
def test_a_year_is_its_hours(year_file, normal):
    """A slope, some hours of the year: what the pictures' own sky gives, 0.5 %."""
    weather = read_weather(year_file)
    sun, sky = irradiance_of_year(weather, normal)
    assert sun.shape == sky.shape == (8760, 3)
    suns = suns_of_year(weather)
    first = datetime(2023, 1, 1, tzinfo=UTC) - timedelta(hours=1)
    for row in range(6, 8760, 509):
        hour = weather.hour_at(first + timedelta(hours=row))
        light = WeatherLight(
            Conditions(
                "perez",
                hour.direct_normal_w_m2,
                hour.diffuse_horizontal_w_m2,
                hour.dew_point_c,
                row // 24 + 1,
                float(suns.apparent_elevation_rad[row]),
                float(suns.disc_fraction[row]),
            ),
            tuple(world_from_enu(suns.east_north_up[row], 0.0)),
            0.0,
            DEFAULT_HAZE,
        )
        directions = texel_directions(64)
        facing = np.maximum(enu_from_world(directions, 0.0) @ np.array(normal), 0.0)
        cube = light.background(64).cube
        expected = np.einsum("fijc,fij->c", cube, facing * texel_solid_angles(64))
        np.testing.assert_allclose(sky[row], expected, rtol=5e-3)
        cosine = max(float(suns.east_north_up[row] @ np.array(normal)), 0.0)
        np.testing.assert_allclose(sun[row], light.sun().irradiance_rgb * cosine, rtol=5e-3)

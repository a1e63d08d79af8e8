"""Which hours light a scene alike to the eye, and which sizes a tolerance asks for."""

import math
from itertools import pairwise

import numpy as np
import pytest
from light_messages import light_messages
from light_transport.messages import no_light_map
from light_transport.tolerance import RUNGS, looks_like, quality_for

from vrut_lite.array import Array
from vrut_lite.messages.sky import SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged

USUAL = quality_for(0.1)


def hour(radiance=1.0, sun_deg=40.0, irradiance=3.0, source="test"):
    angle = math.radians(sun_deg)
    cube = np.full((6, 8, 8, 3), radiance)
    background, key_light, ambient = light_messages(
        cube, (math.cos(angle), math.sin(angle), 0.0), (irradiance,) * 3
    )
    sky = SkyRadianceChanged(
        cube=Array(cube.astype(np.float16)),
        radiance_scale=1.0,
        ground_radiance_rgb=background.ground_radiance_rgb,
        source=source,
    )
    return SkyLightChanged(
        background=background, key_light=key_light, ambient=ambient, radiance=sky, source=source
    )


@pytest.mark.parametrize(
    ("now", "alike"),
    [
        (hour(), True),
        (hour(radiance=1.001), True),
        (hour(sun_deg=40.05), True),
        (hour(irradiance=3.01), True),
        (hour(radiance=1.02), False),
        (hour(sun_deg=40.3), False),
        (hour(irradiance=3.2), False),
        (hour(source="another sky"), False),
    ],
)
def test_small_moves_are_unseen(now, alike):
    """Half a percent of the brightest irradiance, and a tenth of a degree; another sky is seen."""
    assert looks_like(now, hour(), USUAL.hour_change, USUAL.sun_rad) is alike


def test_nothing_is_darker_than_night():
    """Two hours without any light are alike, and differ from those with some."""
    night = hour(radiance=0.0, irradiance=0.0)
    assert looks_like(night, hour(radiance=0.0, irradiance=0.0), 0.0, 0.0)
    assert not looks_like(hour(), night, USUAL.hour_change, USUAL.sun_rad)


def test_tighter_tolerances_ask_for_more():
    """No size grows with the error that is allowed, and every rung is finer than the one before."""
    for qualities in (
        [quality_for(tolerance) for tolerance in (1.0, 0.3, 0.1, 0.03, 0.01, 0.001)],
        [quality_for(0.1, rung) for rung in RUNGS],
    ):
        for coarse, fine in pairwise(qualities):
            assert fine.texels >= coarse.texels
            assert fine.rays >= coarse.rays
            assert fine.patch_texels <= coarse.patch_texels
            assert fine.bounces_left <= coarse.bounces_left
            assert fine.hour_change <= coarse.hour_change
            assert fine.sun_rad <= coarse.sun_rad


def test_a_layout_of_no_scene_is_a_valid_message():
    """The empty layout that removes a light map passes the checks of a layout."""
    nothing = no_light_map()
    nothing.check()
    nothing.check_arrays()
    assert nothing.content_key == ""

"""End to end: the gnomon's shadow in the picture gives the sun's azimuth."""

import math
from pathlib import Path

import numpy as np
import pytest
from long_parameters import mostly_long

from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.sun import SunMoved
from vrut_lite.project import Project, daylight_inputs, view_inputs

pytestmark = pytest.mark.gl
SUNDIAL = Path(__file__).parents[1] / "scenes" / "sundial.glb"
HOURS = ("07:30", "10:00", "13:10", "15:45", "18:45")
CAMERA_HEIGHT_M, HALF_VIEW_M, SIZE_PX = 40.0, 4.0, 240


@pytest.fixture(scope="module")
def host():
    from vrut_lite.host import Host

    with Host() as host:
        yield host


def shadow_azimuth_rad(radiance):
    """Azimuth, from the gnomon's foot, of the pixels that are much darker than the dial."""
    c = (np.arange(SIZE_PX) + 0.5) / SIZE_PX * 2.0 - 1.0
    east, north = np.meshgrid(c * HALF_VIEW_M, -c * HALF_VIEW_M)
    distance = np.hypot(east, north)
    brightness = luminance(radiance)
    # Excludes the gnomon, which covers its foot; the dial is plain out to 5 m.
    dark = (brightness < 0.6 * np.median(brightness)) & (distance > 0.2) & (distance < 3.9)
    assert dark.sum() > 30, "no shadow in the picture"
    return math.atan2((east / distance)[dark].mean(), (north / distance)[dark].mean())


@pytest.mark.parametrize("north_offset_deg", [0.0, 35.0])
@pytest.mark.parametrize("hour", mostly_long(HOURS, "18:45".__eq__))
def test_the_shadow_points_away_from_the_sun(host, hour, north_offset_deg):
    """A vertical gnomon's shadow lies at the sun's azimuth plus 180 degrees, within 1 degree.

    Prague at five hours of a summer's day, elevations from 21 to 63 degrees. The picture is
    taken from straight above, north of the world at its top; with a north offset the scene is
    turned, and the shadow by as much.
    """
    project = Project(
        scene=str(SUNDIAL),
        place="50.0755,14.4378,200",
        at=f"2026-06-21T{hour}",
        size=(SIZE_PX, SIZE_PX),
        north_offset_deg=north_offset_deg,
    )
    above = MoveCamera(
        eye_m=(0.0, CAMERA_HEIGHT_M, 0.0),
        target_m=(0.0, 0.0, 0.0),
        vertical_field_of_view_rad=2 * math.atan(HALF_VIEW_M / CAMERA_HEIGHT_M),
    )
    host.inject(*daylight_inputs(project), *view_inputs(project), above)
    measured_deg = math.degrees(shadow_azimuth_rad(host.draw().radiance))
    sun = host.kernel.last(SunMoved)
    expected_deg = math.degrees(sun.azimuth_rad) + 180.0 - north_offset_deg
    error_deg = (measured_deg - expected_deg + 180.0) % 360.0 - 180.0
    assert abs(error_deg) < 1.0

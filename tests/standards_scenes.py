"""Scenes of a few quads in which standards are tried by hand."""

import numpy as np
import pandas as pd
import pvlib
from boxes import quads
from daylight_numbers.glazing.glass import no_glass
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.rooms import SIDES
from daylight_numbers.work import DaylightWork
from light_transport.transport import SceneTransport

from vrut_lite.messages.weather import SetWeather

EAST, SOUTH = SIDES.index("+x (east)"), SIDES.index("+z (south)")
OUT = {EAST: np.array([1.0, 0.0, 0.0]), SOUTH: np.array([0.0, 0.0, 1.0])}


def work_in(*corners, places=((0.0, 0.8, 0.0),)):
    """Quads and level sensors, made ready."""
    surfaces, layout = quads(*corners)
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(64)
    glass = no_glass(len(surfaces.part))
    sensors = free_sensors(places, np.tile([0, 1.0, 0], (len(places), 1)), "room")
    return DaylightWork(transport, glass, sensors, operator_of(transport, glass, sensors, 0.1))


def wall(x, height, half=2000.0):
    """An upright quad at x, seen from -x."""
    return [[x, 0, -half], [x, 0, half], [x, height, half], [x, height, -half]]


def weather(latitude_deg=51.5):
    """A year in which the sun always shines."""
    each = (500.0,) * 8760
    return SetWeather(
        path="sunny.epw", name="sunny", latitude_deg=latitude_deg, longitude_deg=0.0,
        altitude_m=0.0, utc_offset_h=0.0, direct_normal_w_m2=each,
        diffuse_horizontal_w_m2=(100.0,) * 8760, dew_point_c=(10.0,) * 8760,
    )  # fmt: skip


def pvlib_hours(place, offset_h, day, counts):
    """Hours of one day, minute by minute, in which a test of pvlib's sun holds."""
    zone = f"Etc/GMT{-offset_h:+d}"
    times = pd.date_range(f"{day}T00:00:30", periods=1440, freq="min", tz=zone)
    sun = pvlib.solarposition.get_solarposition(times, place.latitude_deg, place.longitude_deg)
    solar = times.hour + (times.minute + 0.5) / 60 + sun["equation_of_time"].to_numpy() / 60
    solar = solar + place.longitude_deg / 15 - offset_h
    height, turn = sun["apparent_elevation"].to_numpy(), np.radians(sun["azimuth"].to_numpy())
    return float(counts(height, turn, np.asarray(solar)).sum() / 60)


def profile_deg(height_deg, azimuth_rad):
    """Angle in the plane across an endless east-west edge, from the south: 90 overhead."""
    ahead = -np.cos(azimuth_rad)
    return np.degrees(np.arctan2(np.tan(np.radians(height_deg)), ahead))

"""Rotations between the axes of J2000, of the ecliptic, of the moon and of a place."""

from datetime import UTC, datetime
from functools import lru_cache
from typing import NamedTuple

import astronomy
import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.atmosphere.refraction import apparent_elevation
from vrut_lite.geometry.frames import world_from_enu
from vrut_lite.numeric_types import FloatArray

_J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
AU_KM = 149_597_870.7
_LIGHT_AU_PER_DAY = 173.144_632_684_6


class Watch(NamedTuple):
    """An instant and a place; `world` (3, 3) turns J2000's equatorial axes to world axes.

    Precession and nutation are in it (IAU 2006 and 2000B, as astronomy-engine has them); UTC is
    taken for UT1: 0.9 s, which is 0.004 deg, at most.
    """

    time: astronomy.Time
    observer: astronomy.Observer
    world: FloatArray


def watch(
    instant: datetime,
    latitude_deg: float,
    longitude_deg: float,
    altitude_m: float = 0.0,
    north_offset_rad: float = 0.0,
) -> Watch:
    """The axes of an aware instant and a place."""
    time = astronomy.Time((instant - _J2000).total_seconds() / 86_400.0)
    observer = astronomy.Observer(latitude_deg, longitude_deg, altitude_m)
    found = np.array(astronomy.Rotation_EQJ_HOR(time, observer).rot).T
    # Its rows are north, west and up.
    east_north_up = np.stack([-found[1], found[0], found[2]])
    world = world_from_enu(east_north_up.T, north_offset_rad).T
    return Watch(time, observer, world)


def unit(right_ascension_deg: ArrayLike, declination_deg: ArrayLike) -> FloatArray:
    """Unit vectors (..., 3) of equatorial or other spherical coordinates."""
    longitude, latitude = np.radians(right_ascension_deg), np.radians(declination_deg)
    return np.stack(
        [
            np.cos(latitude) * np.cos(longitude),
            np.cos(latitude) * np.sin(longitude),
            np.sin(latitude),
        ],
        axis=-1,
    )


def aberrated(direction: FloatArray, at: Watch) -> FloatArray:
    """Directions (n, 3), J2000, as the moving observer sees them: up to 20.5 arc seconds."""
    earth = astronomy.BaryState(astronomy.Body.Earth, at.time)
    beta = np.array([earth.vx, earth.vy, earth.vz]) / _LIGHT_AU_PER_DAY
    moved = direction + beta
    return np.asarray(moved / np.linalg.norm(moved, axis=-1, keepdims=True))


def refracted(direction: FloatArray, eye_height_m: float = 0.0) -> FloatArray:
    """World directions (..., 3) raised by refraction."""
    sine = np.clip(direction[..., 1], -1.0, 1.0)
    raised = apparent_elevation(np.arcsin(sine), eye_height_m)
    level = np.sqrt(np.maximum(1.0 - sine * sine, 1e-30))
    stretch = np.cos(raised) / level
    return np.stack(
        [direction[..., 0] * stretch, np.sin(raised), direction[..., 2] * stretch], axis=-1
    )


def body_km(body: astronomy.Body, at: Watch) -> FloatArray:
    """Vector (3,) from the observer to a body, J2000, light time and aberration included, km."""
    where = at.observer.latitude, at.observer.longitude, at.observer.height
    return np.array(_body_km(body, at.time.ut, *where))


@lru_cache(maxsize=16)
def _body_km(body: astronomy.Body, days: float, *where: float) -> tuple[float, float, float]:
    """The same, for all who ask in one hour."""
    time, observer = astronomy.Time(days), astronomy.Observer(*where)
    seen = astronomy.Equator(body, time, observer, False, True).vec
    return seen.x * AU_KM, seen.y * AU_KM, seen.z * AU_KM


def ecliptic_of_j2000() -> FloatArray:
    """Matrix (3, 3) from J2000's equatorial to its ecliptic axes."""
    return np.array(astronomy.Rotation_EQJ_ECL().rot).T


def moon_axes(time: astronomy.Time) -> FloatArray:
    """Matrix (3, 3) from J2000's to the moon's own axes: x to the mean Earth, z to its north."""
    axis = astronomy.RotationAxis(astronomy.Body.Moon, time)
    ra, spin = np.radians([axis.ra * 15.0, axis.spin])
    node = np.array([-np.sin(ra), np.cos(ra), 0.0])
    north = unit(axis.ra * 15.0, axis.dec)
    across = np.cross(north, node)
    prime = np.cos(spin) * node + np.sin(spin) * across
    return np.stack([prime, np.cross(north, prime), north])


def sun_elevation_rad(at: Watch) -> float:
    """The sun's true elevation."""
    sun = at.world @ body_km(astronomy.Body.Sun, at)
    return float(np.arcsin(sun[1] / np.linalg.norm(sun)))

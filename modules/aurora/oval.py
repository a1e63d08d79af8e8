"""The auroral oval: curtains over a place at an hour, by the planetary index Kp.

The equatorward edge at magnetic midnight is that of NOAA's table (66.5 deg at Kp 0, 48.1 deg at
Kp 9); the oval is a circle shifted by 4.3 deg towards midnight (after Holzworth and Meng, 1975).
The magnetic field is a dipole with the pole of IGRF-13 for 2020.
"""

from datetime import datetime

import numpy as np

from aurora.curtains import AuroraShown, phases_at
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.messages.place import SetPlace
from vrut_lite.numeric_types import FloatArray

_POLE_LATITUDE_DEG, _POLE_LONGITUDE_DEG = 80.65, -72.68
_MIDNIGHT_EDGE_DEG, _EDGE_PER_KP_DEG, _SHIFT_DEG = 66.5, 2.04, 4.3
_WIDTH_DEG, _WIDTH_PER_KP_DEG, _KM_PER_DEG = 2.5, 0.6, 111.2
# Zenith brightness of the green line at Kp 0 (class I, the faintest that eyes see) to class IV.
_FAINTEST_KR, _DECADES_PER_KP, _NOON_SHARE = 1.0, 0.26, 0.25


def aurora_over(
    place: SetPlace, instant: datetime, kp: float, haze: float, source: str
) -> AuroraShown:
    """Curtains over a place at an instant, for Kp from 0 to 9, in haze of this optical depth."""
    latitude, longitude = place.latitude_deg, place.longitude_deg
    pole, here = _unit(_POLE_LATITUDE_DEG, _POLE_LONGITUDE_DEG), _unit(latitude, longitude)
    below_sun = _unit(0.0, 180.0 - 360.0 * (instant.timestamp() / 86400.0 % 1.0))
    magnetic = float(np.arcsin(np.clip(here @ pole, -1.0, 1.0)))
    # 1 at magnetic midnight, -1 at noon.
    night = -float(np.cos(_longitude(here, pole) - _longitude(below_sun, pole)))
    edge_deg = _MIDNIGHT_EDGE_DEG - _EDGE_PER_KP_DEG * kp + _SHIFT_DEG * (1.0 - night)
    brightness = _FAINTEST_KR * 10.0 ** (_DECADES_PER_KP * kp)
    nearer = pole if magnetic >= 0.0 else -pole
    north, east = _unit(latitude + 90.0, longitude), _unit(0.0, longitude + 90.0)
    poleward = direction_from_angles(np.arctan2(nearer @ east, nearer @ north), 0.0)
    x, y, z = world_from_enu(poleward, place.north_offset_rad).tolist()
    return AuroraShown(
        poleward=(x, y, z),
        edge_km=(edge_deg - float(np.degrees(abs(magnetic)))) * _KM_PER_DEG,
        width_km=(_WIDTH_DEG + _WIDTH_PER_KP_DEG * kp) * _KM_PER_DEG,
        # A dipole's inclination I: tan I = 2 tan(latitude).
        lean=0.5 / max(float(np.tan(abs(magnetic))), 0.2),
        kilorayleigh=brightness * (_NOON_SHARE + (1.0 - _NOON_SHARE) * 0.5 * (1.0 + night)),
        haze=haze,
        phases=phases_at(instant.timestamp()),
        source=source,
    )


def _unit(latitude_deg: float, longitude_deg: float) -> FloatArray:
    """Unit vector (3,): towards longitude 90 deg, longitude 0, and the north pole."""
    return direction_from_angles(np.radians(longitude_deg), np.radians(latitude_deg))


def _longitude(place: FloatArray, pole: FloatArray) -> float:
    """Longitude (rad) about a pole, from a fixed meridian."""
    first = np.cross([1.0, 0.0, 0.0], pole)
    return float(np.arctan2(place @ np.cross(first, pole), place @ first))

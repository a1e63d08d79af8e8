"""The moon's light above the air: ROLO's disk albedo, and earthshine.

Kieffer and Stone (2005, Astron. J. 129, 2887), equation 10 and table 4: the disk's albedo by phase,
by the sun's selenographic longitude (waxing and waning moons differ) and by libration. Good to some
10 %. It holds from 1.55 to 97 deg of phase: nearer to full the value at 1.55 deg holds, beyond the
magnitude follows Allen's formula, scaled to join.
"""

from typing import NamedTuple

import numpy as np

from night_sky.data_files import table
from vrut_lite.atmosphere.planet import EARTH_RADIUS_M
from vrut_lite.geometry.colour import colour_table, rgb_from_spectrum, solar_irradiance
from vrut_lite.numeric_types import FloatArray

# c1 to c4 and p1 to p4 of the publication.
_LIBRATION = 0.00034115, -0.0013425, 0.00095906, 0.00066229
_DECAY_DEG = 4.06054, 12.8802
_WAVE_DEG = -30.5858, 16.7498
_LEAST_PHASE_DEG, _MOST_PHASE_DEG = 1.55, 97.0
# Solid angle (sr) of the disc at the standard distance, and that distance (km).
_SOLID_ANGLE, _STANDARD_KM = 6.4177e-5, 384_400.0
# Full Earth at the moon's distance: 133 klx of sun, its geometric albedo 0.434, its radius.
_EARTH_ALBEDO, _EARTH_KM = 0.434, EARTH_RADIUS_M / 1000.0
_MOON_ALBEDO = 0.12


class Phase(NamedTuple):
    """How the moon is lit and seen.

    Attributes:
        angle_rad: between sun and observer, seen from the moon; 0 is full.
        sun_longitude_rad: the sun's selenographic longitude, above 0 while the moon wanes.
        seen_latitude_rad, seen_longitude_rad: the observer's, the libration.
        sun_au, observer_km: distances from the moon.
    """

    angle_rad: float
    sun_longitude_rad: float
    seen_latitude_rad: float = 0.0
    seen_longitude_rad: float = 0.0
    sun_au: float = 1.0
    observer_km: float = _STANDARD_KM


def disk_albedo(phase: Phase) -> FloatArray:
    """The disk's equivalent albedo (25,) at the table's wavelengths."""
    degrees = float(np.degrees(phase.angle_rad))
    within = float(np.clip(degrees, _LEAST_PHASE_DEG, _MOST_PHASE_DEG))
    sun = phase.sun_longitude_rad
    if degrees > _MOST_PHASE_DEG:
        sun *= within / degrees
    bands = table("rolo_disk_albedo.csv")
    g = np.radians(within)
    logarithm = bands[:, 1:5] @ g ** np.arange(4) + bands[:, 5:8] @ sun ** np.array([1, 3, 5])
    latitude, longitude = np.degrees([phase.seen_latitude_rad, phase.seen_longitude_rad])
    c1, c2, c3, c4 = _LIBRATION
    logarithm = logarithm + c1 * latitude + c2 * longitude + sun * (c3 * latitude + c4 * longitude)
    terms = np.array([
        np.exp(-within / _DECAY_DEG[0]),
        np.exp(-within / _DECAY_DEG[1]),
        np.cos((within - _WAVE_DEG[0]) / _WAVE_DEG[1]),
    ])  # fmt: skip
    beyond = 10.0 ** (-0.4 * (_allen(degrees) - _allen(within))) if degrees > within else 1.0
    return np.asarray(np.exp(logarithm + bands[:, 8:11] @ terms) * beyond)


def albedo_at(phase: Phase, wavelength_nm: FloatArray) -> FloatArray:
    """The disk's albedo (n,), smooth over wavelength: a parabola through the visible bands."""
    bands, albedo = table("rolo_disk_albedo.csv")[:, 0], disk_albedo(phase)
    visible = bands < 800.0
    middle, half = 550.0, 200.0
    fit = np.polyfit((bands[visible] - middle) / half, albedo[visible], 2)
    return np.asarray(np.polyval(fit, (wavelength_nm - middle) / half), dtype=float)


def irradiance_rgb(phase: Phase) -> FloatArray:
    """Moonlight (3,) above the air on a plane that faces it, linear sRGB, W m^-2."""
    wavelength = colour_table()[:, 0]
    share = albedo_at(phase, wavelength) * (_SOLID_ANGLE / np.pi)
    share = share * phase.sun_au**-2.0 * (_STANDARD_KM / phase.observer_km) ** 2
    return rgb_from_spectrum(share * solar_irradiance(wavelength), wavelength)


def sun_rgb() -> FloatArray:
    """Sunlight (3,) above the air at 1 au, linear sRGB, W m^-2."""
    wavelength = colour_table()[:, 0]
    return rgb_from_spectrum(solar_irradiance(wavelength), wavelength)


def earthshine_radiance_rgb(phase: Phase) -> FloatArray:
    """Radiance (3,) of the moon's dark side by light from the Earth, W m^-2 sr^-1."""
    seen_from_moon = np.pi - phase.angle_rad
    lambert = (np.sin(seen_from_moon) + (np.pi - seen_from_moon) * np.cos(seen_from_moon)) / np.pi
    on_moon = _EARTH_ALBEDO * (_EARTH_KM / phase.observer_km) ** 2 * max(float(lambert), 0.0)
    return np.asarray(sun_rgb() * (on_moon * _MOON_ALBEDO / np.pi))


def _allen(phase_deg: float) -> float:
    """Visual magnitude of the moon at mean distance (Allen 1976)."""
    return -12.73 + 0.026 * phase_deg + 4e-9 * phase_deg**4

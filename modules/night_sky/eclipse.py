"""How much sunlight the moon leaves: what of the limb-darkened disc it does not hide.

Neckel and Labs (1994, Solar Physics 153, 91): intensity over that of the disc's middle, by powers
of the cosine mu, at three wavelengths near those of linear sRGB.
"""

import astronomy
import numpy as np

from night_sky.sky_axes import Watch, body_km
from vrut_lite.atmosphere.planet import MOON_RADIUS_KM
from vrut_lite.numeric_types import FloatArray

SUN_RADIUS_KM = 696_000.0
# At 611, 550 and 468 nm: 1 - u (1 - mu) - v (1 - mu)^2, fitted to their polynomials.
_DARKENING = np.array([[0.48, 0.13], [0.57, 0.13], [0.66, 0.13]])
# Samples of the disc: rings of equal area, spokes.
_RINGS, _SPOKES = 200, 720


def sun_left(at: Watch) -> FloatArray:
    """Share (3,) of the sun's light that reaches a place past the moon: 1 outside eclipses."""
    return left_of_disc(*discs(at))


def discs(at: Watch) -> tuple[float, float]:
    """Distance of the moon's disc from the sun's, and its radius, both in radii of the sun's."""
    sun, moon = body_km(astronomy.Body.Sun, at), body_km(astronomy.Body.Moon, at)
    sun_km, moon_km = float(np.linalg.norm(sun)), float(np.linalg.norm(moon))
    # By the sine: an arc cosine would lose small angles.
    apart = float(np.linalg.norm(np.cross(sun / sun_km, moon / moon_km)))
    ratio = MOON_RADIUS_KM / moon_km / (SUN_RADIUS_KM / sun_km)
    return (apart if sun @ moon > 0.0 else np.inf) / (SUN_RADIUS_KM / sun_km), ratio


def hidden_area(separation: float, moon_radius: float) -> float:
    """Share of a disc behind another, the lens of two circles; lengths in radii of the disc."""
    d, r = separation, moon_radius
    if d >= 1.0 + r:
        return 0.0
    if d <= abs(1.0 - r):
        return min(r * r, 1.0)
    sun_angle = np.arccos(np.clip((d * d + 1.0 - r * r) / (2.0 * d), -1.0, 1.0))
    moon_angle = np.arccos(np.clip((d * d + r * r - 1.0) / (2.0 * d * r), -1.0, 1.0))
    kite = 0.5 * np.sqrt(max((1.0 + r - d) * (d + 1.0 - r) * (d - 1.0 + r) * (d + 1.0 + r), 0.0))
    return float((sun_angle + r * r * moon_angle - kite) / np.pi)


def left_of_disc(separation: float, moon_radius: float) -> FloatArray:
    """Share (3,) of a disc's light beside another; both lengths in radii of the disc."""
    if separation >= 1.0 + moon_radius:
        return np.ones(3)
    ring = np.sqrt((np.arange(_RINGS) + 0.5) / _RINGS)[:, None]
    turn = (np.arange(_SPOKES) + 0.5) * (2.0 * np.pi / _SPOKES)
    x, y = ring * np.cos(turn) - separation, ring * np.sin(turn)
    beside = (np.hypot(x, y) > moon_radius).mean(axis=1)
    edge = 1.0 - np.sqrt(1.0 - ring[:, 0] ** 2)
    intensity = 1.0 - _DARKENING[:, :1] * edge - _DARKENING[:, 1:] * edge**2
    return np.asarray((intensity * beside).sum(axis=1) / intensity.sum(axis=1))

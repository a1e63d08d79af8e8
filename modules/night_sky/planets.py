"""The planets that the naked eye sees, as points of light."""

import astronomy
import numpy as np

from night_sky.sky_axes import Watch, body_km
from night_sky.stars import Stars, irradiance_of

# B - V by Mallama, Krobusek and Pavlov (2017, Icarus 282, 19).
_B_MINUS_V = {
    astronomy.Body.Mercury: 0.97,
    astronomy.Body.Venus: 0.81,
    astronomy.Body.Mars: 1.43,
    astronomy.Body.Jupiter: 0.87,
    astronomy.Body.Saturn: 1.09,
    astronomy.Body.Uranus: 0.50,
}
NAMES = tuple(body.name for body in _B_MINUS_V)


def planets_at(at: Watch) -> Stars:
    """The planets in world axes, in the order of `NAMES`, without refraction, above the air."""
    place = np.stack([body_km(body, at) for body in _B_MINUS_V])
    direction = place / np.linalg.norm(place, axis=1, keepdims=True)
    magnitude = np.array([astronomy.Illumination(body, at.time).mag for body in _B_MINUS_V])
    return Stars(direction @ at.world.T, irradiance_of(magnitude, np.array([*_B_MINUS_V.values()])))

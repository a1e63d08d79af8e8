"""The fifteen general skies of CIE S 011/E:2003 (ISO 15469:2004) and the traditional overcast."""

import math

from vrut_lite.atmosphere.sky_distribution import Distribution, Overcast

# a, b of the gradation; c, d, e of the scattering indicatrix; table 1 of the standard.
_PARAMETERS = (
    (4.0, -0.70, 0.0, -1.0, 0.00),  # 1: overcast, steep gradation
    (4.0, -0.70, 2.0, -1.5, 0.15),
    (1.1, -0.80, 0.0, -1.0, 0.00),
    (1.1, -0.80, 2.0, -1.5, 0.15),
    (0.0, -1.00, 0.0, -1.0, 0.00),  # 5: uniform
    (0.0, -1.00, 2.0, -1.5, 0.15),
    (0.0, -1.00, 5.0, -2.5, 0.30),
    (0.0, -1.00, 10.0, -3.0, 0.45),
    (-1.0, -0.55, 2.0, -1.5, 0.15),
    (-1.0, -0.55, 5.0, -2.5, 0.30),
    (-1.0, -0.55, 10.0, -3.0, 0.45),
    (-1.0, -0.32, 10.0, -3.0, 0.45),  # 12: clear, low turbidity
    (-1.0, -0.32, 16.0, -3.0, 0.30),
    (-1.0, -0.15, 16.0, -3.0, 0.30),
    (-1.0, -0.15, 24.0, -2.8, 0.15),
)
TYPES = len(_PARAMETERS)
# Types 1 to 5 are overcast in the standard's words, 6 partly cloudy with the sun hidden.
SUNLESS = 6
OVERCAST = Overcast()


def general_sky(number: int) -> Distribution:
    """The distribution of type 1 to 15; 1 at the zenith times the sun's indicatrix there."""
    a, b, c, d, e = _PARAMETERS[number - 1]
    return Distribution(a, b, c, d, e, math.exp(0.5 * math.pi * d))

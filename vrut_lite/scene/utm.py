"""Universal Transverse Mercator: the geographic place of a map's coordinates.

Krueger's series in the third flattening n, to n^4, as Karney gives it (2011, Journal of Geodesy
85, 475, equations 11 to 36): 1 mm within a zone. The ellipsoid is WGS 84's; that of ETRS89 differs
by 0.1 mm, other datums' places by up to 200 m.
"""

import cmath
import math
from typing import NamedTuple

_EQUATOR_M, _FLATTENING = 6_378_137.0, 1.0 / 298.257_223_563
_SCALE = 0.9996
# Eastings (m) of a zone, 6 deg wide, and beyond its edges.
_EASTINGS_M = (100_000.0, 900_000.0)
_FALSE_EASTING_M, _FALSE_NORTHING_M = 500_000.0, 10_000_000.0

_N = _FLATTENING / (2.0 - _FLATTENING)
_RADIUS_M = _EQUATOR_M / (1.0 + _N) * (1.0 + _N**2 / 4.0 + _N**4 / 64.0)
_BETA = (
    _N / 2 - 2 * _N**2 / 3 + 37 * _N**3 / 96 - _N**4 / 360,
    _N**2 / 48 + _N**3 / 15 - 437 * _N**4 / 1440,
    17 * _N**3 / 480 - 37 * _N**4 / 840,
    4397 * _N**4 / 161280,
)


class MapPlace(NamedTuple):
    """A place of a map, and the azimuth of the map's grid north (rad, clockwise of true north)."""

    latitude_deg: float
    longitude_deg: float
    convergence_rad: float


def place_of_utm(easting_m: float, northing_m: float, zone: int, south: bool) -> MapPlace:
    """The place of coordinates in a zone (1 to 60) of the northern or southern hemisphere.

    Raises:
        ValueError: they lie outside the zone.
    """
    if not (1 <= zone <= 60 and _EASTINGS_M[0] <= easting_m <= _EASTINGS_M[1]):
        raise ValueError("the easting lies outside the zone")
    if not 0.0 <= northing_m <= _FALSE_NORTHING_M:
        raise ValueError("the northing lies outside the zone")
    north_m = northing_m - (_FALSE_NORTHING_M if south else 0.0)
    zeta = complex(north_m, easting_m - _FALSE_EASTING_M) / (_SCALE * _RADIUS_M)
    series = list(enumerate(_BETA, start=1))
    sphere = zeta - sum(beta * cmath.sin(2 * j * zeta) for j, beta in series)
    slope = 1.0 - sum(2 * j * beta * cmath.cos(2 * j * zeta) for j, beta in series)
    xi, eta = sphere.real, sphere.imag
    east_rad = math.atan2(math.sinh(eta), math.cos(xi))
    conformal = math.sin(xi) / math.hypot(math.sinh(eta), math.cos(xi))
    convergence = math.atan(math.tan(xi) * math.tanh(eta)) + cmath.phase(slope)
    return MapPlace(
        math.degrees(math.atan(_tangent(conformal))),
        (6.0 * zone - 183.0 + math.degrees(east_rad) + 180.0) % 360.0 - 180.0,
        convergence,
    )


def _tangent(conformal: float) -> float:
    """The tangent of the latitude whose conformal latitude has the given one, by Newton's steps."""
    squared = _FLATTENING * (2.0 - _FLATTENING)
    eccentricity = math.sqrt(squared)
    tangent = conformal
    for _ in range(4):
        secant = math.hypot(1.0, tangent)
        sigma = math.sinh(eccentricity * math.atanh(eccentricity * tangent / secant))
        found = tangent * math.hypot(1.0, sigma) - sigma * secant
        step = (conformal - found) / math.hypot(1.0, found)
        step *= (1.0 + (1.0 - squared) * tangent**2) / ((1.0 - squared) * secant)
        tangent += step
    return tangent

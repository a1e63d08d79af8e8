"""The aerosol types of OPAC: mixtures of components, and how they thin out with altitude.

Hess, Koepke and Schult 1998, tables 4 and 5: particles per cm^3 at the ground, their scale height
and the top of their layer. Above it, up to 12 km, lies the same thin air at 50 % humidity with an
optical depth of 0.013 at 550 nm. OPAC's 0.005 of the stratosphere are `stratosphere`'s.
"""

from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from vrut_lite.arguments import as_number, shown
from vrut_lite.atmosphere.aerosols.components import Particles, component
from vrut_lite.atmosphere.aerosols.optics import AerosolOptics, optics_of_particles

_550_NM = 550.0
# Depth at 550 nm of the free troposphere from 2 to 12 km, its scale height and mixture.
_ALOFT_DEPTH, _ALOFT_FROM_KM, _ALOFT_TO_KM, _ALOFT_SCALE_KM = 0.013, 2.0, 12.0, 8.0
_ALOFT = MappingProxyType({"waso": 438.0, "inso": 0.0013, "soot": 294.0})
_ALOFT_HUMIDITY = 50.0
USUAL_HUMIDITY = 80.0
MOST_HUMIDITY = 95.0
# Most particles per cm^3, a thousand times those of urban air.
_MOST_PARTICLES = 1e8


class AerosolMixture(NamedTuple):
    """Particles per cm^3 by component, and their layer: its scale height and top in km."""

    particles: Mapping[str, float]
    scale_height_km: float
    top_km: float


def _mixture(scale_height_km: float, top_km: float, **particles: float) -> AerosolMixture:
    return AerosolMixture(MappingProxyType(particles), scale_height_km, top_km)


OPAC_TYPES: Mapping[str, AerosolMixture] = MappingProxyType(
    {
        "continental-clean": _mixture(8, 2, waso=2600, inso=0.15),
        "continental-average": _mixture(8, 2, waso=7000, inso=0.4, soot=8300),
        "continental-polluted": _mixture(8, 2, waso=15700, inso=0.6, soot=34300),
        "urban": _mixture(8, 2, waso=28000, inso=1.5, soot=130_000),
        "maritime-clean": _mixture(1, 2, waso=1500, ssam=20, sscm=0.0032),
        "maritime-polluted": _mixture(1, 2, waso=3800, ssam=20, sscm=0.0032, soot=5180),
        "maritime-tropical": _mixture(1, 2, waso=590, ssam=10, sscm=0.0013),
        "desert": _mixture(2, 6, waso=2000, minm=269.5, miam=30.5, micm=0.142),
        "arctic": _mixture(99, 2, waso=1300, inso=0.01, ssam=1.9, soot=5300),
    }
)


@lru_cache(maxsize=16)
def type_optics(name: str, humidity_percent: float = USUAL_HUMIDITY) -> AerosolOptics:
    """The optics of a type of OPAC at a relative humidity of the lower air, 0 to 95 %.

    Raises:
        ValueError: there is no such type, or the humidity is out of range.
    """
    if name not in OPAC_TYPES:
        raise ValueError(f"no aerosol type {shown(name)}; there are {', '.join(OPAC_TYPES)}")
    return mixture_optics(OPAC_TYPES[name], humidity_percent)


def mixture_optics(
    mixture: AerosolMixture, humidity_percent: float = USUAL_HUMIDITY
) -> AerosolOptics:
    """Optical properties of a user's mixture, below OPAC's free troposphere.

    Raises:
        ValueError: there is no component or an unknown one, or a number is out of range.
    """
    humidity = as_number("humidity_percent", humidity_percent, 0.0, MOST_HUMIDITY, "%")
    height_km = as_number("scale_height_km", mixture.scale_height_km, 0.01, 1000.0, "km")
    top_km = as_number("top_km", mixture.top_km, 0.01, 100.0, "km")
    for name, count in mixture.particles.items():
        as_number(f"particles of {name}", count, 0.0, _MOST_PARTICLES, "per cm^3")
    if not any(mixture.particles.values()):
        raise ValueError("a mixture needs particles of at least one component")
    at_ground = particles_together(mixture.particles, humidity)
    column_km = height_km * -np.expm1(-top_km / height_km)
    lower = at_ground.times(column_km)
    aloft = particles_together(_ALOFT, _ALOFT_HUMIDITY)
    upper = aloft.times(_aloft_depth(top_km) / _at_550(aloft))
    return optics_of_particles(lower, upper, 1000.0 * column_km)


def particles_together(particles: Mapping[str, float], humidity_percent: float) -> Particles:
    """Optical properties of a mixture, by particles per cm^3 of each component."""
    parts = [component(name, humidity_percent).times(n) for name, n in particles.items()]
    total = parts[0]
    for part in parts[1:]:
        total = total.with_others(part)
    return total


def _aloft_depth(from_km: float) -> float:
    """Depth of the free troposphere above the top of a layer."""
    start_km = min(max(from_km, _ALOFT_FROM_KM), _ALOFT_TO_KM)
    ends = np.exp(-np.array([_ALOFT_FROM_KM, start_km, _ALOFT_TO_KM]) / _ALOFT_SCALE_KM)
    return float(_ALOFT_DEPTH * (ends[1] - ends[2]) / (ends[0] - ends[2]))


def _at_550(particles: Particles) -> float:
    return float(np.interp(_550_NM, particles.wavelength_nm, particles.extinction))

"""A venetian blind as measured glazing: rays through flat slats, written as LBNL's Window XML.

Slats are infinitely long along x, Lambertian on both sides, and fill the plane of the blind one
over the other. Rays of each incident patch of Klems's full basis begin evenly over a period and
over the patch, are reflected until one in a thousand of their light is left, and leave through
either side. What passes between slats keeps its direction.
"""

from dataclasses import dataclass

import numpy as np
from daylight_numbers.glazing.angle_basis import KLEMS_FULL, AngleBasis

from vrut_lite.numeric_types import FloatArray

_FORM = """<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov"><Optical><Layer>
<Material><Name>{name}</Name></Material>
<DataDefinition><IncidentDataStructure>Columns</IncidentDataStructure><AngleBasis>
<AngleBasisName>{basis}</AngleBasisName>{rings}</AngleBasis></DataDefinition>
<WavelengthData><LayerNumber>System</LayerNumber><Wavelength unit="Integral">Visible</Wavelength>
<WavelengthDataBlock><WavelengthDataDirection>Transmission Front</WavelengthDataDirection>
<ColumnAngleBasis>{basis}</ColumnAngleBasis><RowAngleBasis>{basis}</RowAngleBasis>
<ScatteringDataType>BTDF</ScatteringDataType><ScatteringData>
{values}
</ScatteringData></WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>
"""
_RING = (
    "<AngleBasisBlock><Theta>{middle}</Theta><nPhis>{count}</nPhis><ThetaBounds><LowerTheta>{low}"
    "</LowerTheta><UpperTheta>{high}</UpperTheta></ThetaBounds></AngleBasisBlock>"
)
_LEAST, _MOST_BOUNCES = 1e-3, 60
_OFF = 1e-9


@dataclass(frozen=True)
class VenetianBlind:
    """Slats of a width, a distance apart, in metres; tilted down outdoors by an angle; their
    reflectance."""

    width_m: float = 0.025
    apart_m: float = 0.02
    tilt_deg: float = 30.0
    reflectance: float = 0.6


def transmission_of(
    blind: VenetianBlind, rays: int = 4096, basis: AngleBasis = KLEMS_FULL
) -> FloatArray:
    """Transmission (N, N), sr^-1, from outdoors, which is z < 0, to indoors."""
    random = np.random.default_rng(1)
    found = np.zeros((len(basis), len(basis)))
    for patch in range(len(basis)):
        way = _in_patch(basis, patch, rays, random)
        leaves, share = _through(blind, way, random)
        indoors = leaves[:, 2] > 0.0
        exiting = basis.patch_of(leaves[indoors])
        found[:, patch] = np.bincount(exiting, share[indoors], len(basis)) / rays
    return np.asarray(found / basis.projected_sr[:, None])


def window_xml_of(name: str, transmission: FloatArray, basis: AngleBasis = KLEMS_FULL) -> str:
    """The text of a file."""
    rings, low = "", 0.0
    for high, count in zip(basis.upper_deg, basis.count, strict=True):
        middle = 0.0 if count == 1 else 0.5 * (low + high)
        rings += _RING.format(middle=middle, count=count, low=low, high=high)
        low = high
    values = "\n".join(", ".join(f"{value:.6g}" for value in row) for row in transmission)
    return _FORM.format(name=name, basis=basis.name, rings=rings, values=values)


def _in_patch(basis: AngleBasis, patch: int, count: int, random: np.random.Generator) -> FloatArray:
    """Directions (count, 3) of a patch, by the cosine."""
    middle = basis.middles[patch]
    edges = np.array([0.0, *basis.upper_deg])
    ring = int(np.searchsorted(np.cumsum(basis.count), patch, side="right"))
    low, high = np.sin(np.radians(edges[ring : ring + 2])) ** 2
    sine2 = low + (high - low) * random.random(count)
    turn = np.arctan2(middle[1], middle[0])
    turn = turn + 2.0 * np.pi * (random.random(count) - 0.5) / basis.count[ring]
    sine = np.sqrt(sine2)
    return np.stack([sine * np.cos(turn), sine * np.sin(turn), np.sqrt(1.0 - sine2)], axis=1)


def _through(
    blind: VenetianBlind, way: FloatArray, random: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Directions (R, 3) in which rays leave the blind, and the share (R,) of light that is left."""
    count = len(way)
    tilt = np.radians(blind.tilt_deg)
    # Along a slat, from outdoors, where it is low, to indoors; in y and z.
    along = np.array([np.sin(tilt), np.cos(tilt)])
    across = np.array([np.cos(tilt), -np.sin(tilt)])
    half_m = 0.5 * blind.width_m
    edge = half_m * np.cos(tilt)
    y = blind.apart_m * random.random(count)
    place = np.stack([y, np.full(count, -edge - _OFF)], axis=1)
    direction, share = way.copy(), np.ones(count)
    active = np.ones(count, bool)
    for _ in range(_MOST_BOUNCES):
        here = np.flatnonzero(active)
        if not len(here):
            break
        distance, side = _nearest_slat(blind, place[here], direction[here, 1:], along, across)
        met = np.isfinite(distance)
        active[here[~met]] = False
        here, distance, side = here[met], distance[met], side[met]
        place[here] += distance[:, None] * direction[here, 1:]
        share[here] *= blind.reflectance
        dark = share[here] < _LEAST
        share[here[dark]] = 0.0
        active[here[dark]] = False
        here, side = here[~dark], side[~dark]
        normal = side[:, None] * across
        place[here] += _OFF * normal
        direction[here] = _lambert(normal, random)
    share[active] = 0.0
    return direction, share


def _nearest_slat(
    blind: VenetianBlind,
    place: FloatArray,
    direction: FloatArray,
    along: FloatArray,
    across: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Distances (R,) to the slat that rays in y and z meet first, infinite for none, and the side
    (R,) of it that they meet: 1 or -1."""
    # A slat's place across is a multiple of this.
    step = blind.apart_m * across[0]
    speed = direction @ across
    height = place @ across
    upwards = speed > 0.0
    first = np.where(upwards, np.floor(height / step) + 1.0, np.ceil(height / step) - 1.0)
    nearest = np.full(len(place), np.inf)
    reach = int(np.ceil(blind.width_m / blind.apart_m)) + 2
    with np.errstate(divide="ignore", invalid="ignore"):
        for n in range(12 * reach):
            number = first + np.where(upwards, n, -n)
            distance = (number * step - height) / speed
            at = place + distance[:, None] * direction
            middle = np.stack([number * blind.apart_m, np.zeros(len(number))], axis=1)
            on_slat = np.abs((at - middle) @ along) < 0.5 * blind.width_m
            found = on_slat & (distance > 0.0) & np.isinf(nearest)
            nearest[found] = distance[found]
            # Behind the slats, in the way of the ray, nothing more is met.
            behind = at[:, 1] * np.sign(direction[:, 1]) > 0.5 * blind.width_m
            if (np.isfinite(nearest) | behind).all():
                break
    return nearest, np.where(upwards, -1.0, 1.0)


def _lambert(normal: FloatArray, random: np.random.Generator) -> FloatArray:
    """Directions (R, 3) around normals (R, 2) in y and z, by the cosine."""
    sine2, turn = random.random(len(normal)), 2.0 * np.pi * random.random(len(normal))
    x, beside = np.sqrt(sine2) * np.cos(turn), np.sqrt(sine2) * np.sin(turn)
    up = np.sqrt(1.0 - sine2)
    y = up * normal[:, 0] - beside * normal[:, 1]
    z = up * normal[:, 1] + beside * normal[:, 0]
    return np.stack([x, y, z], axis=1)

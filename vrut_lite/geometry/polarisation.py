"""Linear polarisation of light: the axes of Q and U in a sky map, and reflection by dielectrics.

Q > 0 is light that vibrates along an axis across the ray, U > 0 light that vibrates 45 degrees
counter-clockwise from it, as an observer sees it who looks against the light. Directions point from
the observer to where the light comes from.

A sky map has one axis for each direction: +X at the zenith, carried along the great circle to the
direction. It is smooth everywhere but in the nadir; the vertical plane is not smooth in the zenith,
nor the plane of the sun at the sun, where a low sun's sky vibrates vertically.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

# Roughness from which surfaces mix vibrations so much that their reflection counts as unpolarised;
# it is polarised wholly up to half of that.
UNPOLARISED_ROUGHNESS = 0.6
_UP = np.array([0.0, 1.0, 0.0])


def map_axis(direction: ArrayLike) -> FloatArray:
    """Axis (..., 3) of Q in a sky map at unit directions (..., 3) in world axes."""
    d = np.asarray(direction, dtype=float)
    share = d[..., :1] / (1.0 + np.maximum(d[..., 1:2], -1.0 + 1e-9))
    return np.asarray(np.array([1.0, 0.0, 0.0]) - share * (d + _UP))


def turned(
    q: ArrayLike, u: ArrayLike, direction: ArrayLike, axis: ArrayLike, to: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Q and U (..., C) by an axis, from those by another one.

    Args:
        q, u: (..., C) by `axis`.
        direction: unit vectors (..., 3) to where the light comes from.
        axis, to: (..., 3) unit vectors across the direction.
    """
    q, u, first, second = (np.asarray(part, dtype=float) for part in (q, u, axis, to))
    cosine = np.sum(first * second, axis=-1, keepdims=True)
    sine = np.sum(np.cross(first, np.asarray(direction)) * second, axis=-1, keepdims=True)
    along, across = (cosine - sine) * (cosine + sine), 2.0 * cosine * sine
    return q * along + u * across, u * along - q * across


def vertical_axis(direction: ArrayLike) -> FloatArray:
    """Axis (..., 3) in the vertical plane of unit directions (..., 3), upwards; -Z is the azimuth
    of zenith and nadir."""
    d = np.asarray(direction, dtype=float)
    level = np.hypot(d[..., 0], d[..., 2])[..., None]
    heading = np.divide(d, level, out=np.broadcast_to([0.0, 0.0, -1.0], d.shape).copy(),
                        where=level > 0.0)  # fmt: skip
    heading[..., 1] = 0.0
    return np.asarray(level * _UP - d[..., 1:2] * heading)


def degree_and_angle(
    radiance: ArrayLike, q: ArrayLike, u: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Degree of polarisation, 0 to 1, and angle of the vibration from the axis in radians, from
    -pi / 2 to pi / 2; both (...,), 0 where there is no light."""
    light, q, u = np.broadcast_arrays(*(np.asarray(part, float) for part in (radiance, q, u)))
    degree = np.divide(np.hypot(q, u), light, out=np.zeros_like(light), where=light > 0.0)
    return np.minimum(degree, 1.0), 0.5 * np.arctan2(u, q)


class NeutralPoints(NamedTuple):
    """Distances in degrees of the points of the sun's vertical where its light is unpolarised:
    Babinet's above the sun, Brewster's below it, Arago's above the antisolar point. nan: the point
    is not above the horizon."""

    babinet: float
    brewster: float
    arago: float


def neutral_points(angle_deg: ArrayLike, q: ArrayLike, sun_deg: float) -> NeutralPoints:
    """Neutral points by the zeros of Q along the sun's vertical.

    Args:
        angle_deg: rising angles (n,) from the horizon below the sun, over the zenith, to 180.
        q: Q (n,) there by the vertical plane.
        sun_deg: the sun's elevation.
    """
    angle, q = np.asarray(angle_deg, dtype=float), np.asarray(q, dtype=float)
    change = np.flatnonzero(np.sign(q[1:]) != np.sign(q[:-1]))
    zeros = angle[change] + q[change] / (q[change] - q[change + 1]) * np.diff(angle)[change]
    beyond = zeros[zeros > 90.0 + sun_deg]
    above = zeros[(zeros > sun_deg) & (zeros <= 90.0 + sun_deg)]
    below = zeros[zeros < sun_deg]
    return NeutralPoints(
        babinet=float(above[0] - sun_deg) if above.size else np.nan,
        brewster=float(sun_deg - below[-1]) if below.size else np.nan,
        arago=float(180.0 + sun_deg - beyond[-1]) if beyond.size else np.nan,
    )


def polariser_axis(rotation: ArrayLike, angle_deg: float) -> FloatArray:
    """Vibration (3,) that a polariser before a camera passes, in world axes.

    Args:
        rotation: matrix (3, 3) or larger from world axes to the camera's: right, up, back.
        angle_deg: counter-clockwise from the picture's vertical.
    """
    right, up = np.asarray(rotation, dtype=float)[:2, :3]
    angle = np.radians(angle_deg)
    return np.asarray(np.cos(angle) * up - np.sin(angle) * right)


def fresnel_polarisation(cosine: ArrayLike, f0: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Polarisation by a dielectric surface, both (...,), from Fresnel's equations.

    The first is (Rs - Rp) / (Rs + Rp), the degree of reflected unpolarised light, across the plane
    of incidence; the second 2 |rs| rp / (Rs + Rp), below 0 beyond Brewster's angle.

    Args:
        cosine: of the angle of incidence, 0 to 1.
        f0: reflectance at normal incidence, from above 0 to below 1.
    """
    root = np.sqrt(np.asarray(f0, dtype=float))
    index, c = (1.0 + root) / (1.0 - root), np.asarray(cosine, dtype=float)
    inner = np.sqrt(1.0 - (1.0 - c * c) / (index * index))
    s = (index * inner - c) / (index * inner + c)
    p = (index * c - inner) / (index * c + inner)
    both = s * s + p * p
    return (s * s - p * p) / both, 2.0 * s * p / both


def reflected(
    radiance: ArrayLike, q: ArrayLike, u: ArrayLike, cosine: ArrayLike, f0: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """I, Q, U (..., C) of light reflected by a smooth dielectric, over its reflectance.

    Q and U are by the axis across the plane of incidence, of the light that comes in as seen from
    the surface, of the reflected light as the eye sees it: Mueller's matrix of a mirror.
    """
    radiance, q, u = (np.asarray(part, dtype=float) for part in (radiance, q, u))
    difference, product = (part[..., None] for part in fresnel_polarisation(cosine, f0))
    return radiance + difference * q, difference * radiance + q, -product * u

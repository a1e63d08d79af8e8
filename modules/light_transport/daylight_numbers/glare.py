"""Daylight glare probability of an eye (Wienold and Christoffersen 2006), as evalglare has it."""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import distance_transform_edt, label

from light_transport.daylight_numbers.eye_view import EDGE_PX, SUN_SR, EyeView, Hemisphere
from vrut_lite.numeric_types import FloatArray

# EN 17037:2018, annex E: DGP that 5 % of the hours may exceed.
EN_GLARE = (("high", 0.35), ("medium", 0.40), ("minimum", 0.45))
# Brighter directions are sources of glare; those above the second are sources of their own.
THRESHOLD, PEAK = 2_000.0, 50_000.0
# Sources that are so near each other are one, in radians.
_NEAR = 0.2


class Glare(NamedTuple):
    """Daylight glare probability, and vertical illuminance at the eye in lux."""

    dgp: float
    vertical_lx: float


class Sources(NamedTuple):
    """Luminance (K,), solid angle (K,) and direction (K, 3) of sources of glare."""

    luminance: FloatArray
    solid_angle_sr: FloatArray
    direction: FloatArray


def glare_of(view: EyeView, vertical_lx: float) -> Glare:
    """DGP of what an eye sees, with the illuminance on the plane that it looks out of."""
    sun = view.sun_illuminance
    discs = Sources(sun / SUN_SR, np.full(len(sun), SUN_SR), view.sun_directions)
    seen = Hemisphere(view.directions, view.solid_angle_sr, view.pixel, EDGE_PX)
    return Glare(dgp_of((bright_parts(seen, view.luminance), discs), vertical_lx), vertical_lx)


def vertical_of(view: EyeView) -> float:
    """Vertical illuminance in lux by what is seen, discs of the sun included."""
    seen = float(np.sum(view.luminance * view.solid_angle_sr * view.directions[:, 2]))
    return seen + float(np.sum(view.sun_illuminance * view.sun_directions[:, 2]))


def dgp_of(sources: tuple[Sources, ...], vertical_lx: float) -> float:
    """Wienold and Christoffersen's formula, damped below some 300 lx (Wienold 2012)."""
    contrast = sum(
        float(
            np.sum(
                one.luminance**2
                * one.solid_angle_sr
                / (max(vertical_lx, 1e-6) ** 1.87 * position_index(one.direction) ** 2)
            )
        )
        for one in sources
    )
    dgp = 5.87e-5 * vertical_lx + 0.0918 * np.log10(1.0 + contrast) + 0.16
    low = np.exp(np.minimum(0.024 * vertical_lx - 4.0, 50.0))
    return float(np.clip(dgp * low / (1.0 + low), 0.0, 1.0))


def position_index(directions: FloatArray) -> FloatArray:
    """Guth's index (K,) of directions (K, 3) to the right, up and ahead; below by Iwata 1997."""
    x, y, z = np.asarray(directions, float).reshape(-1, 3).T
    ahead = np.maximum(z, 1e-9)
    tilt = np.degrees(np.arctan2(np.abs(x), np.maximum(np.abs(y), 1e-12)))
    off = np.degrees(np.arccos(np.clip(z, -1.0, 1.0)))
    above = np.exp(
        (35.2 - 0.31889 * tilt - 1.22 * np.exp(-2.0 * tilt / 9.0)) / 1000.0 * off
        + (21.0 + 0.26667 * tilt - 0.002963 * tilt**2) / 100_000.0 * off**2
    )
    reach = np.minimum(np.hypot(x, y) / ahead, 3.0)
    below = 1.0 + np.where(reach > 0.6, 1.2, 0.8) * reach
    return np.asarray(np.minimum(np.where(y < 0.0, below, above), 16.0))


def bright_parts(seen: Hemisphere, luminance: FloatArray) -> Sources:
    """Bright parts of what is seen, by luminances (N,): their means, solid angles and weighted
    directions."""
    kinds = ((luminance > THRESHOLD) & (luminance <= PEAK), luminance > PEAK)
    parts = [_joined(seen, luminance, kind) for kind in kinds]
    return Sources(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def _joined(seen: Hemisphere, luminance: FloatArray, chosen: np.ndarray) -> Sources:
    if not chosen.any():
        return Sources(np.empty(0), np.empty(0), np.empty((0, 3)))
    field = np.zeros((seen.edge_px, seen.edge_px), bool)
    row, column = seen.pixel[chosen].T
    field[row, column] = True
    # Half the way from either side: what is nearer than that grows together.
    reach = 0.5 * _NEAR * seen.edge_px / np.pi
    grown, count = label(distance_transform_edt(~field) <= reach, np.ones((3, 3)))
    number = grown[row, column] - 1
    solid = seen.solid_angle_sr[chosen]
    weight = luminance[chosen] * solid
    total = np.bincount(number, weight, count).astype(float)
    angle = np.bincount(number, solid, count).astype(float)
    direction: FloatArray = np.stack(
        [
            np.bincount(number, weight * axis, count).astype(float)
            for axis in seen.directions[chosen].T
        ],
        axis=1,
    )
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return Sources(total / angle, angle, direction)

"""Daylight glare probability of an eye (Wienold and Christoffersen 2006), as evalglare has it.

Sources of glare are bright sky, sunlit surfaces, the sun's disc and its mirror images. Vertical
illuminance in a year is that of the year's product.
"""

from typing import NamedTuple

import numpy as np
from light_transport.public import CancelCheck, always
from scipy.ndimage import distance_transform_edt, label

from daylight_numbers.glare.eye_view import (
    EDGE_PX,
    SUN_SR,
    Eye,
    EyeView,
    EyeYear,
    Hemisphere,
    sun_through,
)
from daylight_numbers.glare.mirrored_sun import Flats, mirrored_suns
from daylight_numbers.matrix.sensor_rays import glazed
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.metrics import OCCUPIED_H, occupied
from daylight_numbers.year.year import (
    LUMENS_RGB,
    SolvedYear,
    year_matrices,
    year_of,
)
from daylight_numbers.year.year_light import YearLight
from vrut_lite.numeric_types import FloatArray

# EN 17037:2018, annex E: DGP that 5 % of the hours may exceed.
EN_GLARE = (("high", 0.35), ("medium", 0.40), ("minimum", 0.45))
# Luminances, cd m^-2, above which a direction is a source, and is joined with none below.
THRESHOLD, PEAK = 2_000.0, 50_000.0
# Distance in radians below which two sources are one.
_NEAR = 0.2
# EN 17037: maximum share of hours in which DGP exceeds its limit.
_SHARE_OF_HOURS = 0.05


class Glare(NamedTuple):
    """Daylight glare probability, and vertical illuminance at the eye in lux."""

    dgp: float
    vertical_lx: float


class GlareSources(NamedTuple):
    """Luminance (K,), solid angle (K,) and direction (K, 3) of sources of glare."""

    luminance: FloatArray
    solid_angle_sr: FloatArray
    direction: FloatArray


def glare_of(view: EyeView, vertical_lx: float) -> Glare:
    """DGP of an eye's view, with the illuminance on the plane at right angles to its axis."""
    sun = view.sun_illuminance
    discs = GlareSources(sun / SUN_SR, np.full(len(sun), SUN_SR), view.sun_directions)
    seen = Hemisphere(view.directions, view.solid_angle_sr, view.pixel, EDGE_PX)
    return Glare(dgp_of((bright_parts(seen, view.luminance), discs), vertical_lx), vertical_lx)


def vertical_of(view: EyeView) -> float:
    """Vertical illuminance in lux by the view, discs of the sun included."""
    seen = float(np.sum(view.luminance * view.solid_angle_sr * view.directions[:, 2]))
    return seen + float(np.sum(view.sun_illuminance * view.sun_directions[:, 2]))


def dgp_of(sources: tuple[GlareSources, ...], vertical_lx: float) -> float:
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


def bright_parts(seen: Hemisphere, luminance: FloatArray) -> GlareSources:
    """Bright parts of a view, by luminances (N,): their means, solid angles and weighted
    directions."""
    kinds = ((luminance > THRESHOLD) & (luminance <= PEAK), luminance > PEAK)
    parts = [_joined(seen, luminance, kind) for kind in kinds]
    return GlareSources(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def _joined(seen: Hemisphere, luminance: FloatArray, chosen: np.ndarray) -> GlareSources:
    if not chosen.any():
        return GlareSources(np.empty(0), np.empty(0), np.empty((0, 3)))
    field = np.zeros((seen.edge_px, seen.edge_px), bool)
    row, column = seen.pixel[chosen].T
    field[row, column] = True
    # Each source grows by half the distance, so that near ones join.
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
    return GlareSources(total / angle, angle, direction)


def glare_year(
    work: DaylightWork,
    flats: Flats,
    light: YearLight,
    solved: SolvedYear,
    go_on: CancelCheck = always,
) -> FloatArray:
    """DGP (P, H) of the eyes that `work` has as sensors; 0 outside 8:00 to 18:00.

    Raises:
        GivenUp: by `go_on`.
    """
    vertical = year_of(year_matrices(work, light, solved, go_on), light).total.astype(float)
    found = np.zeros(vertical.shape)
    hours = np.flatnonzero(occupied(light))
    sun_lx = light.sun_irradiance_rgb @ LUMENS_RGB
    for n, (place, towards) in enumerate(
        zip(work.sensors.places_m, work.sensors.normals, strict=True)
    ):
        eye = Eye(place, towards)
        seen = EyeYear(work, eye, light, solved, hours)
        for hour in hours.tolist():
            go_on()
            sources = [bright_parts(seen.hemisphere, seen.luminance(hour))]
            if sun_lx[hour] > 0.0:
                sources.append(_discs(work, flats, eye, light, hour))
            found[n, hour] = dgp_of(tuple(sources), vertical[n, hour])
    return found


def en_level(dgp: FloatArray, light: YearLight) -> tuple[str, FloatArray]:
    """EN 17037's level of an eye's year (H,), and the share of 8:00 to 18:00 above each limit."""
    used = dgp[occupied(light)]
    shares = np.array([(used > limit).sum() / OCCUPIED_H for _, limit in EN_GLARE])
    reached = [
        name for (name, _), share in zip(EN_GLARE, shares, strict=True) if share <= _SHARE_OF_HOURS
    ]
    return (reached[0] if reached else "none"), shares


def _discs(work: DaylightWork, flats: Flats, eye: Eye, light: YearLight, hour: int) -> GlareSources:
    towards, irradiance = mirrored_suns(
        work.transport,
        work.glass,
        flats,
        eye.place_m,
        light.sun_direction[hour],
        light.sun_irradiance_rgb[hour],
    )
    if work.operator.panes is not None:
        sun, power = light.sun_direction[hour], light.sun_irradiance_rgb[hour]
        place = work.transport.in_radii(eye.place_m)
        disc = sun_through(glazed(work.transport, work.glass), work.operator.panes, place, sun)
        if disc.any():
            towards, irradiance = np.vstack([towards, sun]), np.vstack([irradiance, disc * power])
    seen = towards @ eye.towards > 0.0
    lux = irradiance[seen] @ LUMENS_RGB
    return GlareSources(lux / SUN_SR, np.full(len(lux), SUN_SR), towards[seen] @ eye.axes.T)

"""Illuminance of lamps at sensors: straight from their openings, and by all bounces.

Direct light falls with the square of the distance and the cosine of incidence (Lambert's laws).
Near an opening it is the sum over points of it by Gauss's rule, each with the far field's intensity
in proportion (Ashdown 1993, "Near-field photometry: a new approach"), so that a Lambertian opening
is exact and others are so as far as each part of them radiates alike.
"""

from typing import NamedTuple

import numpy as np
from light_transport.public import CancelCheck, SceneTransport, always

from daylight_numbers.lamps.lamp_places import PlacedLuminaires, opening_points
from daylight_numbers.matrix.sensor_rays import glazed, shares_between
from daylight_numbers.sky_cells import CELLS
from daylight_numbers.work import DaylightWork
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.headless import LuminousOpening
from vrut_lite.numeric_types import Float32Array, FloatArray, IntArray, Vector

# Openings that look smaller than this (size over distance) are points: 0.1 % off at most.
_POINT = 1.0 / 15.0
# Points along an edge for each size over distance: below a Lambertian opening 0.1 % off at most,
# from an eighth of its length on.
_POINTS_OF_RATIO, _MOST_POINTS = 2.5, 24
# The same for light on patches, whose texels show no more; and the least share of a luminaire's
# brightest light that is seen in these.
_MOST_OF_BOUNCES, _LIT = 12, 0.02
_OFF = 1e-5


class LampsAtSensors(NamedTuple):
    """Illuminance (P, G) in lux of groups of lamps at full output: straight, and by `surfaces`;
    `noise` is the standard error that rays leave in the latter."""

    direct: FloatArray
    surfaces: FloatArray
    noise: FloatArray

    @property
    def total(self) -> FloatArray:
        """Illuminance (P, G)."""
        return self.direct + self.surfaces


def lamps_at_sensors(
    work: DaylightWork,
    lamps: PlacedLuminaires,
    ground_albedo_rgb: Vector,
    go_on: CancelCheck = always,
) -> LampsAtSensors:
    """The light of each group alone.

    Raises:
        GivenUp: by `go_on`.
    """
    count = len(lamps.groups)
    direct = np.zeros((len(work.sensors), count))
    for lamp in range(len(lamps)):
        go_on()
        direct[:, lamps.group[lamp]] += direct_lux(work, lamps, lamp)
    surfaces, noise = np.zeros((2, len(work.sensors), count))
    for group in range(count):
        go_on()
        radiosity = bounced_by(work.transport, lamps, group, ground_albedo_rgb)
        dark = np.zeros((CELLS + 1, 3))
        light, error = work.operator.irradiance(dark, radiosity.astype(float))
        surfaces[:, group] = luminance(light) * LUMENS_PER_WATT
        noise[:, group] = luminance(error) * LUMENS_PER_WATT
    return LampsAtSensors(direct, surfaces, noise)


def direct_lux(work: DaylightWork, lamps: PlacedLuminaires, lamp: int) -> FloatArray:
    """Illuminance (P,) in lux straight from one lamp, through glass by its angle."""
    luminaire = lamps.kinds[lamps.kind[lamp]]
    axes, place = lamps.axes[lamp], lamps.places_m[lamp]
    where, sensors = glazed(work.transport, work.glass), work.sensors
    nearest = distances_m(luminaire.opening, (sensors.places_m - place) @ axes.T)
    counts = point_counts(luminaire.opening, nearest)
    found = np.zeros(len(sensors))
    kinds, which = np.unique(counts, axis=0, return_inverse=True)
    for number, along in enumerate(kinds):
        here = np.flatnonzero(which.ravel() == number)
        offsets, weights = opening_points(luminaire.opening, along)
        points = place + offsets @ axes[1:]
        away = points[None] - sensors.places_m[here, None]
        squared = np.maximum(np.sum(away * away, axis=-1), 1e-12)
        towards = away / np.sqrt(squared)[..., None]
        cosine = np.einsum("snk,sk->sn", towards, sensors.normals[here])
        lux = luminaire.intensity_cd(-towards @ axes.T) * weights * np.maximum(cosine, 0.0)
        lux *= lamps.output[lamp] / squared
        row, column = np.nonzero(lux > 0.0)
        origin = work.transport.in_radii(sensors.places_m[here[row]])
        origin = origin + _OFF * sensors.normals[here[row]]
        passed = shares_between(where, origin, work.transport.in_radii(points[column]))
        lux[row, column] *= luminance(passed.astype(float))
        found[here] = lux.sum(axis=1)
    return found


def point_counts(
    opening: LuminousOpening, nearest_m: FloatArray, most: int = _MOST_POINTS
) -> IntArray:
    """Points (P, 2) along an opening's edges that places at such distances (P,) from it need."""
    edges = np.array([opening.length_m, opening.width_m])
    ratio = edges / np.maximum(nearest_m, 1e-9)[:, None]
    counts = np.minimum(np.ceil(_POINTS_OF_RATIO * np.minimum(ratio, most)) + 1, most)
    return np.where(ratio < _POINT, 1, counts).astype(np.int64)


def distances_m(opening: LuminousOpening, local_m: FloatArray) -> FloatArray:
    """Distances (P,) of places (P, 3) on axis, +X and +Y from an opening's rectangle."""
    half = 0.5 * np.array([opening.length_m, opening.width_m])
    beyond = np.maximum(np.abs(local_m[:, 1:]) - half, 0.0)
    return np.asarray(np.sqrt(local_m[:, 0] ** 2 + np.sum(beyond * beyond, axis=1)))


def bounce_counts(transport: SceneTransport, lamps: PlacedLuminaires, lamp: int) -> IntArray:
    """Points (2,) along the edges of a lamp's opening that the nearest texel it may light needs."""
    luminaire, texels = lamps.kinds[lamps.kind[lamp]], transport.texels
    centre, radius = transport.surfaces.centre_m, transport.surfaces.radius_m
    away = texels.place * radius + centre - lamps.places_m[lamp]
    local = away @ lamps.axes[lamp].T
    faces = np.einsum("nk,nk->n", away, texels.normal) < 0.0
    length = np.maximum(np.linalg.norm(local, axis=1, keepdims=True), 1e-9)
    candela = luminaire.intensity_cd(local / length)
    lit = faces & (candela > _LIT * luminaire.candela.max())
    if not lit.any():
        return np.ones(2, np.int64)
    nearest = distances_m(luminaire.opening, local[lit]).min()
    return point_counts(luminaire.opening, np.array([nearest]), _MOST_OF_BOUNCES)[0]


def bounced_by(
    transport: SceneTransport, lamps: PlacedLuminaires, group: int, ground_albedo_rgb: Vector
) -> Float32Array:
    """Radiosity (M, 3) of patches, W m^-2, by the lamps of a group and all bounces."""
    assert transport.patches is not None
    reflectance = transport.patches.reflectance_rgb.copy()
    reflectance[transport.patches.on_ground] = ground_albedo_rgb
    here = np.flatnonzero(lamps.group == group)
    counts = np.array([bounce_counts(transport, lamps, int(lamp)) for lamp in here])
    direct = transport.lamplit_patches(lamps.points(here, counts))
    return transport.radiosity(direct, np.zeros_like(reflectance), reflectance)

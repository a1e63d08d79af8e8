"""Light at points that are no texels, by rays of their own, which end on the map's patches."""

from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from light_transport.bake import Bake
from light_transport.giving_up import CancelCheck, always
from light_transport.hour.gather import patches_gathered, sky_gathered
from light_transport.hour.illumination import Illumination
from light_transport.rays.ray_starts import Probes
from light_transport.rays.ray_table import columns_and_rays, empty_rows, slice_of, with_rays
from light_transport.rays.sky_nodes import NODES
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import Float32Array, FloatArray

_BLOCK = 1024


class PointLight(NamedTuple):
    """Light at points (P).

    Attributes:
        irradiance_rgb: (P, 3), W m^-2.
        sky: (P,), luminance of what of it the sky sends.
        error: (P,), what the number of rays leaves of the luminance, rms, if they were random.
        room_m: (P,), harmonic mean distance of what is seen from there, infinite under open sky.
        free: (P,), share of the rays that meet no backs of bodies: little inside them.
    """

    irradiance_rgb: Float32Array
    sky: Float32Array
    error: Float32Array
    room_m: Float32Array
    free: Float32Array


def light_at(
    bake: Bake,
    places_m: FloatArray,
    normals: FloatArray,
    hour: Illumination,
    rays: int,
    threads: int = 1,
    go_on: CancelCheck = always,
    first_ray: int = 0,
) -> PointLight:
    """Light of an hour at `places_m` (P, 3) on planes with unit `normals` (P, 3), world axes.

    The key light's own is not in it. Light does not depend on the number of threads. Rays are
    numbered from `first_ray`: other numbers are other rays.

    Raises:
        GivenUp: by `go_on`.
    """
    assert bake.patches is not None
    surfaces, texels = bake.surfaces, len(bake.texels.pixel)
    places = (places_m - surfaces.centre_m) / surfaces.radius_m
    probes = Probes(places.astype(np.float32), normals.astype(np.float32))
    # Rows of these points stand where those of the bake's probes do.
    columns, own = bake.patches.column_of, len(bake.receivers.probes.place)
    nothing = np.full(len(places), NODES + len(bake.patches.area), np.int32)
    after = columns[NODES + texels + own :]
    column_of = np.concatenate([columns[: NODES + texels], nothing, after])
    receivers = bake.receivers._replace(probes=probes)
    column_light = bake.column_light(hour)
    squares = np.zeros_like(column_light)
    squares[:, 0] = luminance(column_light[:, :3]) ** 2
    rows = empty_rows(texels, len(places))
    light, square = np.empty((2, len(places), 4), np.float32)
    room, free, error = np.empty((3, len(places)), np.float32)

    def block(first: int) -> None:
        go_on()
        last = min(first + _BLOCK, len(places))
        here = slice_of(rows, first, last)
        # Nobody looks at points inside bodies: backs are of sheets, and hide what is behind.
        found = with_rays(bake.tree, receivers, here, column_of, first_ray, rays, NODES + texels)
        for means, of in ((light[first:last], column_light), (square[first:last], squares)):
            sky_gathered(found, of, 0, last - first, means)
            patches_gathered(found, of, 0, last - first, means)
        spread = np.maximum(square[first:last, 0] - luminance(light[first:last, :3]) ** 2, 0.0)
        error[first:last] = np.sqrt(spread / np.maximum(found.valid, 1))
        with np.errstate(divide="ignore", invalid="ignore"):
            room[first:last] = found.valid / found.nearness * np.float32(surfaces.radius_m)
        column, number = columns_and_rays(found.entry)
        dark = np.append(np.where(column == nothing[0], number, 0), 0)
        free[first:last] = 1.0 - np.add.reduceat(dark, found.start[:-1]) / np.float32(rays)

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(block, range(0, len(places), _BLOCK)))
    return PointLight(light[:, :3], light[:, 3], error, room, free)

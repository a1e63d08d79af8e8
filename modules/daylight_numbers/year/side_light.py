"""How much of a year's light comes into a room through each of its sides.

No ray is traced: what a sensor or a patch of the room gets from beyond its box leaves the box, seen
from there, by one side. Bounces within the room follow on its patches, joined to larger ones after
the first bounce.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from light_transport.public import GROUND_NODE, SceneTransport, edges_of
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from daylight_numbers.matrix.operator import Operator
from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.rooms import Opening, RoomBox, ground_shares
from daylight_numbers.sky_cells import CELLS, cell_directions, node_means, node_of_cell
from daylight_numbers.year.year import LUMENS_RGB, SolvedYear, suns_of_hours
from daylight_numbers.year.year_light import YearLight
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

# A room's bounces after the first are counted on at most so many patches.
_MOST_JOINED = 1_200
_FIRST_CELLS, _FEWER = 24.0, 0.8


@dataclass(frozen=True, eq=False)
class SideLight:
    """Light at sensors (P) of a room through each of its sides, without direct sun.

    `of_sky` (G, P, GROUND_NODE + 1) by radiances, of openings in their order; `of_suns`
    (G, P, S) by irradiances of solved suns; `of_one` (G, P) if all that is seen beyond the side has
    the radiance 1. Grey: by luminances.
    """

    of_sky: Float32Array
    of_suns: Float32Array
    of_one: Float32Array

    def of_year(self, group: int, light: YearLight, solved: SolvedYear) -> Float32Array:
        """Lux (P, H) through one side."""
        sky = (light.sky @ LUMENS_RGB.astype(np.float32)).T
        sun = light.sun_irradiance_rgb @ LUMENS_RGB
        spread = suns_of_hours(solved.near, solved.share, sun, self.of_suns.shape[2])
        by_sun = (spread.T @ self.of_suns[group].T).T
        return np.asarray(self.of_sky[group] @ np.ascontiguousarray(sky) + by_sun, np.float32)


class _Room(NamedTuple):
    """A room, the middles of all patches (M, 3), and which lie in it (M,)."""

    box: RoomBox
    openings: tuple[Opening, ...]
    centres_m: FloatArray
    within: BoolArray


class _Seen(NamedTuple):
    """Light at points (N) from beyond their room by one side: (N, GROUND_NODE + 1) by radiances of
    the sky, (N, M) by radiosities of patches outside."""

    sky: csr_matrix
    patches: csr_matrix


def side_light(
    transport: SceneTransport,
    operator: Operator,
    sensors: Sensors,
    box: RoomBox,
    openings: tuple[Opening, ...],
    solved: SolvedYear,
) -> SideLight:
    """The light of each side of a room that has openings, for its sensors and their operator."""
    assert transport.patches is not None
    grey = luminance(transport.patches.reflectance_rgb)
    centres = patch_centres_m(transport)
    within = box.holds(centres) & (transport.patches.area > 0.0)
    room = np.flatnonzero(within)
    seen, sent = _grey_operator(operator)
    known = _Room(box, openings, centres, within)
    at_places = _by_sides(known, sensors.places_m, _on_nodes(seen), sent)
    exchange = transport.cache.patch_transfer
    count = len(centres)
    received = csr_matrix((exchange.share, exchange.column, exchange.start), (count, count))[room]
    straight = csr_matrix(solved.sent_by_cells[room])
    patches = _by_sides(known, centres[room], straight, received)
    bounce = sent[:, room].multiply(grey[room][None]).tocsr()
    further, joined = _further_bounces(transport, room, centres, bounce, received[:, room], grey)
    weights = LUMENS_RGB / LUMENS_RGB.sum()
    sent_by_sky = np.einsum("k,kml->ml", weights, solved.by_sky)
    sent_by_suns = np.einsum("k,kml->ml", weights, solved.by_suns)
    sun_side = np.empty((len(room), len(solved.sun_direction)), np.int8)
    for n, towards in enumerate(solved.sun_direction):
        sun_side[:, n] = box.side_of(centres[room], np.broadcast_to(towards, (len(room), 3)))
    sunlit = solved.sunlit[:, room].T

    def at_sensors(own: FloatArray, on_patches: FloatArray) -> Float32Array:
        return np.asarray(own + bounce @ on_patches + further @ (joined @ on_patches), np.float32)

    skies, suns, ones = [], [], []
    for opening, own, theirs in zip(openings, at_places, patches, strict=True):
        by_sky = theirs.sky.toarray() + theirs.patches @ sent_by_sky
        by_suns = theirs.patches @ sent_by_suns + sunlit * (sun_side == opening.side)
        skies.append(at_sensors(own.sky.toarray() + own.patches @ sent_by_sky, by_sky))
        suns.append(at_sensors(own.patches @ sent_by_suns, by_suns))
        ones.append(at_sensors(_all_at_one(own), _all_at_one(theirs))[:, 0])
    return SideLight(np.array(skies), np.array(suns), np.array(ones))


def patch_centres_m(transport: SceneTransport) -> FloatArray:
    """Where patches (M, 3) are in the mean, world axes."""
    assert transport.patches is not None
    receivers, patches = transport.receivers, transport.patches
    groups = receivers.groups
    corner, one, other = edges_of(receivers.geometry, groups.triangle)
    middle = corner + (one + other) / 3.0
    group_of = np.repeat(np.arange(len(groups.area)), np.diff(groups.start))
    number = np.maximum(np.bincount(group_of, minlength=len(groups.area)), 1)
    of_groups = [np.bincount(group_of, axis, len(groups.area)) / number for axis in middle.T]
    rows = np.concatenate(
        [receivers.texels.place, receivers.probes.place, np.stack(of_groups, axis=1)]
    )
    patch = np.repeat(np.arange(len(patches.area)), np.diff(patches.start))
    sums = [
        np.bincount(patch, patches.weight * axis, len(patches.area))
        for axis in rows[patches.member].T
    ]
    return np.stack(sums, axis=1) * transport.surfaces.radius_m + transport.surfaces.centre_m


def _grey_operator(operator: Operator) -> tuple[csr_matrix, csr_matrix]:
    """Both halves and all colours of its matrices in the mean."""
    weights = LUMENS_RGB / LUMENS_RGB.sum()

    def mean(matrices: tuple[csr_matrix, ...]) -> csr_matrix:
        if len(matrices) == 1:
            return matrices[0]
        return sum(w * one for w, one in zip(weights, matrices, strict=True))

    one, other = operator.halves
    return (
        (0.5 * (mean(one.seen) + mean(other.seen))).tocsr(),
        (0.5 * (mean(one.sent) + mean(other.sent))).tocsr(),
    )


@lru_cache(maxsize=1)
def node_directions() -> FloatArray:
    """Mean direction (GROUND_NODE, 3) of the ray table's cells of the sky."""
    found = node_means(cell_directions().mean(axis=1))
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def _on_nodes(seen: csr_matrix) -> csr_matrix:
    nodes = np.append(node_of_cell(), GROUND_NODE)
    joined = csr_matrix(
        (np.ones(CELLS + 1), (np.arange(CELLS + 1), nodes)), (CELLS + 1, GROUND_NODE + 1)
    )
    return (seen @ joined).tocsr()


def _by_sides(room: _Room, places_m: FloatArray, sky: csr_matrix, sent: csr_matrix) -> list[_Seen]:
    """Views of points through each opening, of the sky (N, GROUND_NODE + 1) and of patches (N, M).

    Of open ground no direction is known: see `ground_shares`.
    """
    sky, sent = sky.tocoo(), sent.tocoo()
    ground = np.bincount(sky.row, sky.data * (sky.col == GROUND_NODE), minlength=len(places_m))
    up, outside = sky.col < GROUND_NODE, ~room.within[sent.col]
    row, node, value = sky.row[up], sky.col[up], sky.data[up]
    from_row, patch, share = sent.row[outside], sent.col[outside], sent.data[outside]
    sky_side = room.box.side_of(places_m[row], node_directions()[node])
    away = room.centres_m[patch] - places_m[from_row]
    patch_side = room.box.side_of(places_m[from_row], away)
    below = ground * ground_shares(room.openings, places_m)
    found = []
    for n, opening in enumerate(room.openings):
        here, there = sky_side == opening.side, patch_side == opening.side
        some = np.flatnonzero(below[n])
        columns = np.append(node[here], np.full(len(some), GROUND_NODE))
        values = np.append(value[here], below[n, some])
        found.append(
            _Seen(
                csr_matrix((values, (np.append(row[here], some), columns)), sky.shape),
                csr_matrix((share[there], (from_row[there], patch[there])), sent.shape),
            )
        )
    return found


def _all_at_one(seen: _Seen) -> FloatArray:
    """Irradiance (N, 1) where all beyond has the radiance 1."""
    return np.asarray(seen.sky.sum(axis=1) + np.pi * seen.patches.sum(axis=1))


def _further_bounces(
    transport: SceneTransport,
    room: NDArray[np.integer],
    centres_m: FloatArray,
    bounce: csr_matrix,
    received: csr_matrix,
    grey: FloatArray,
) -> tuple[FloatArray, csr_matrix]:
    """Light at sensors (P, K) by light on K joined patches after a first bounce, and means (K, R)
    over these of light on patches of the room (R)."""
    assert transport.patches is not None
    number = _joined(transport, room, centres_m)
    area = transport.patches.area[room].astype(float)
    count = int(number.max(initial=-1)) + 1
    share = area / np.bincount(number, area, count)[number]
    means = csr_matrix((share, (number, np.arange(len(room)))), (count, len(room)))
    spread = csr_matrix((np.ones(len(room)), (np.arange(len(room)), number)), (len(room), count))
    exchange = (means @ received @ spread).toarray()
    reflectance = np.asarray(means @ grey[room])
    # Joined patches have B = rho (E + F B); sensors get bounce F B of the first patches.
    solved = np.linalg.solve(np.eye(count) - reflectance[:, None] * exchange, np.diag(reflectance))
    return np.asarray((bounce @ received @ spread) @ solved), means


def _joined(
    transport: SceneTransport, room: NDArray[np.integer], centres_m: FloatArray
) -> NDArray[np.int64]:
    """Numbers (R,) of joined patches: those that face one way within a cell of space."""
    assert transport.patches is not None
    patches, texels = transport.patches, transport.receivers.texels
    first = patches.member[patches.start[room]]
    normal = np.zeros((len(room), 3))
    is_texel = first < len(texels.pixel)
    normal[is_texel] = texels.normal[first[is_texel]]
    axis = np.argmax(np.abs(normal), axis=1)
    facing = 2 * axis + (np.take_along_axis(normal, axis[:, None], axis=1)[:, 0] > 0.0)
    place = centres_m[room] - centres_m[room].min(axis=0)
    cells = _FIRST_CELLS
    while True:
        cell = np.floor(place / (place.max() / cells + 1e-9)).astype(np.int64)
        _, number = np.unique(np.column_stack([facing, cell]), axis=0, return_inverse=True)
        if number.max() < _MOST_JOINED:
            return number.reshape(-1)
        cells *= _FEWER

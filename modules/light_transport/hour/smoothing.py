"""Noise is smoothed along surfaces, where light cannot change fast.

The bound is the harmonic mean distance R to the surfaces that a texel sees (Ward and Heckbert
1992): each step mixes neighbours by min(g_i, g_j), g = min(1, 0.3 R / h)^2, h the texel, and by a
half at least: along an edge, where R is small, light changes slowly too. All of it is multiplied by
(R_i / R_j)^4, the smaller above: towards an edge light changes as R does, and the dark foot of a
wall must not spread; by the eighth power of the ratio of the shares of the sky that both see, for
beside a sill or a reveal these change while R does not; and by the 32nd power of the cosine between
both normals: facets of a column 15 degrees apart mix by a third, for they see different things.
Neighbours exchange light symmetrically, so that none is lost.

Near edges light bends within few texels, and steps as many as noise asks for take some of it away.
There what they took is smoothed alike and given back ("twicing", Tukey 1977): noise is not even
along surfaces, and stays away.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.hour.gather import four_sums
from light_transport.kernels import hot, kernel
from light_transport.rays.map_texels import Texels
from vrut_lite.numeric_types import BoolArray, Float32Array

STEPS = 8
_SHARE_OF_ROOM = 0.3
# With four neighbours the texel itself keeps as much as each of them gives.
_MOST = 0.2
_ALIKE_POWER = 32
# Neighbours with the same room mix at least so much; with a third of it hardly at all.
_SAME_ROOM, _ROOM_POWER = 0.5, 4
# Power of the ratio of two shares of the sky, each with this added: of few rays shares are noise.
_SKY_POWER, _LEAST_SKY = 8, np.float32(0.02)
# Rooms of more texels count as so many: where few rays meet anything their mean is noise.
_ENOUGH_ROOM = 16.0
# Room in texels up to which all that steps took is given back; nothing is where there is enough
# room: on open walls it would raise the noise 1.7 times.
_LITTLE_ROOM = 8.0


class Smoothing(NamedTuple):
    """How much of its neighbours' light each texel (N) takes in a step.

    `weights` (N, 4) float32 of the `links` (N, 4) int32, 0 without a link; `seam_weights`
    (K, 2) float32 of both ends of the `seams` (K, 2) int32. `back` (N, 1) float32: share
    of the light that all steps took from a texel which is smoothed and given back.
    """

    links: NDArray[np.int32]
    weights: Float32Array
    seams: NDArray[np.int32]
    seam_weights: Float32Array
    back: Float32Array


def smoothing_of(
    texels: Texels,
    links: NDArray[np.int32],
    seams: NDArray[np.int32],
    good: BoolArray,
    room: Float32Array,
) -> Smoothing:
    """Weights for good texels (N,) around which there is so much room (N,), in radii."""
    gate = np.minimum(1.0, _SHARE_OF_ROOM * room / np.maximum(texels.width, 1e-12)) ** 2
    gate = gate.astype(np.float32)
    weights = _weights(links, texels.normal, texels.area, texels.width, gate, room, good)
    across = np.zeros(seams.shape, np.float32)
    if len(seams):
        # All seams of a texel together give it as much as one neighbour does.
        meeting = np.bincount(seams.ravel(), minlength=len(good))[seams].max(axis=1)
        for end in range(2):
            shared = _exchange(texels, gate, room, good, seams[:, end], seams[:, 1 - end])
            across[:, end] = shared / meeting
    texels_wide = room / np.maximum(texels.width, np.float32(1e-12))
    back = np.clip((_ENOUGH_ROOM - texels_wide) / (_ENOUGH_ROOM - _LITTLE_ROOM), 0.0, 1.0)
    # A link of no weight leads to the texel itself: kernels need not ask.
    own = np.arange(len(links), dtype=np.int32)[:, None]
    return Smoothing(
        np.where(weights > 0.0, links, own).astype(np.int32),
        weights,
        seams,
        across,
        back[:, None].astype(np.float32),
    )


def parted_by_sky(smoothing: Smoothing, sky: Float32Array) -> Smoothing:
    """The smoothing of texels (N,) that see these shares (N,) of the sky, smoothed ones."""
    level = np.maximum(sky, 0.0) + _LEAST_SKY

    def alike(here: Float32Array, there: Float32Array) -> Float32Array:
        ratio = np.minimum(here, there) / np.maximum(here, there)
        return np.asarray(ratio**_SKY_POWER, np.float32)

    weights = smoothing.weights * alike(level[:, None], level[smoothing.links])
    at_seams = alike(*level[smoothing.seams].T)[:, None] * smoothing.seam_weights
    return smoothing._replace(weights=weights, seam_weights=at_seams)


def _exchange(
    texels: Texels,
    gate: Float32Array,
    room: Float32Array,
    good: BoolArray,
    here: NDArray[np.int32],
    there: NDArray[np.int32],
) -> Float32Array:
    """Weights of texels (K,) for the light of others (K,), as in `_weights`."""
    alike = np.maximum(np.einsum("ki,ki->k", texels.normal[here], texels.normal[there]), 0.0)
    area = np.minimum(texels.area[here], texels.area[there]) / np.maximum(texels.area[here], 1e-30)
    wide = np.float32(_ENOUGH_ROOM) * np.maximum(texels.width[here], texels.width[there])
    nearer = np.minimum(np.minimum(room[here], room[there]), wide)
    farther = np.minimum(np.maximum(room[here], room[there]), wide)
    same = (nearer / np.maximum(farther, 1e-30)) ** _ROOM_POWER
    mixing = np.maximum(np.minimum(gate[here], gate[there]), _SAME_ROOM) * same
    shared = mixing * alike**_ALIKE_POWER * area
    return np.where(good[here] & good[there], _MOST * shared, 0.0).astype(np.float32)


@kernel
def _weights(links, normal, area, width, gate, room, good):  # type: ignore[no-untyped-def]
    weights = np.zeros(links.shape, np.float32)
    for i in range(len(links)):
        for k in range(links.shape[1]):
            j = links[i, k]
            if j < 0 or not good[i] or not good[j]:
                continue
            alike = 0.0
            for axis in range(3):
                alike += normal[i, axis] * normal[j, axis]
            if alike > 0.0 and area[i] > 0.0:
                wide = np.float32(_ENOUGH_ROOM) * max(width[i], width[j])
                nearer, farther = min(room[i], room[j], wide), min(max(room[i], room[j]), wide)
                nearness = nearer / max(farther, np.float32(1e-30))
                mixing = max(min(gate[i], gate[j]), _SAME_ROOM) * nearness**_ROOM_POWER
                exchange = mixing * alike**_ALIKE_POWER * min(area[i], area[j])
                weights[i, k] = _MOST * exchange / area[i]
    return weights


@hot
def smoothed_rows(light, out, smoothing, first, last):  # type: ignore[no-untyped-def]
    """One step: rows `first` to `last` of light (N, 4) into `out`."""
    links, weights = smoothing.links, smoothing.weights
    for i in range(first, last):
        wa, wb, wc, wd = weights[i, 0], weights[i, 1], weights[i, 2], weights[i, 3]
        own = np.float32(1.0) - wa - wb - wc - wd
        taken = four_sums(light, links, weights, 4 * i, 4 * i + 4)
        for k in range(4):
            out[i, k] = own * light[i, k] + taken[k]


@hot
def mix_at_seams(light, out, smoothing):  # type: ignore[no-untyped-def]
    """Exchange between charts in the step from `light` to `out` (N, 4)."""
    seams, weights = smoothing.seams, smoothing.seam_weights
    for s in range(len(seams)):
        i, j = seams[s, 0], seams[s, 1]
        for k in range(4):
            difference = light[j, k] - light[i, k]
            out[i, k] += weights[s, 0] * difference
            out[j, k] -= weights[s, 1] * difference

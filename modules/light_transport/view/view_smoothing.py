"""Averages light over neighbouring points of a still, as far as noise and free space allow.

Noise is smoothed over _REACH points to each side, then over as many that lie farther apart
(Dammertz et al. 2010, "Edge-avoiding A-trous wavelet transform"); light changes slowly in
open space; neighbours that differ by more than the noise are left out.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.giving_up import CancelCheck
from light_transport.kernels import inlined, kernel
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

_REACH, _APART = 2, (1, 2, 4)
# Share of the room within which points count, smaller for farther points.
_SHARE_OF_ROOM = (0.3, 0.03, 0.03)
# Points differ by so many times the noise about them. Where that is a large share of the light, a
# few rays through a window bring most of it: room alone decides. Noise falls with each step: were
# it that of single points to the last, shadows of a table's legs would be smoothed away.
_NOISES, _AROUND, _LARGE_SHARE = 1.25, 5, 0.2
# Ratio of the noise's variance that a step leaves to that of as many independent points: points of
# a later step have neighbours in common. Below 10, low-frequency noise stays as blotches on walls.
_SHARED = 12.5
# Room of so many steps between points that is not resolved: neighbours fall into a dark strip or
# beside it by chance, and the strip's edge would have teeth.
_RESOLVED = 6.0


class PointGrid(NamedTuple):
    """Points in rows and columns (H, W) as a picture shows them.

    Attributes:
        plane: (H, W, 4) float32, face normals and distances; 0 where nothing is seen.
        place: (H, W, 3) float32, relative to the eye, in radii.
    """

    plane: Float32Array
    place: Float32Array

    def filled(self, values: FloatArray | Float32Array, points: NDArray[np.intp]) -> Float32Array:
        """Values (N,) of some points, by their numbers (N,), as a grid (H, W); 0 elsewhere."""
        grid = np.zeros(self.plane.shape[:2], np.float32)
        grid.ravel()[points] = values
        return grid


def smoothed(
    values: Float32Array,
    grid: PointGrid,
    room: Float32Array,
    error: Float32Array,
    go_on: CancelCheck,
) -> Float32Array:
    """Means of values (H, W, 4) of this room (H, W), in radii, and error (H, W), rms."""
    # The larger of the two: a single point's rays may have hit a small bright surface.
    error2 = np.maximum(mean_about(error * error), error * error).astype(np.float32)
    finest = _steps(grid)
    unresolved = np.clip(1.0 - room / np.maximum(_RESOLVED * finest, 1e-30), 0.0, 1.0)
    error2 = np.maximum(error2, (unresolved * mean_about(luminance(values[..., :3]))) ** 2)
    error2 = error2.astype(np.float32)
    room = np.maximum(room, np.where(unresolved > 0.0, finest / _SHARE_OF_ROOM[0], 0.0))
    room = room.astype(np.float32)
    for apart, share in zip(_APART, _SHARE_OF_ROOM, strict=True):
        go_on()
        noise2 = _noise2(values, error2)
        values, left2 = _smoothed(values, *grid, room, noise2, error2, apart, share)
        error2 = np.minimum(np.float32(_SHARED) * left2, error2)
    return values


def _steps(grid: PointGrid) -> Float32Array:
    """Distance (H, W) in radii from each point to the nearest of its four neighbours."""
    place = np.where(grid.plane[..., :3].any(axis=-1, keepdims=True), grid.place, np.inf)
    nearest = np.full(place.shape[:2], np.inf, np.float32)
    with np.errstate(invalid="ignore"):
        right = np.linalg.norm(place[:, 1:] - place[:, :-1], axis=-1)
        above = np.linalg.norm(place[1:] - place[:-1], axis=-1)
    for part, far in (
        (nearest[:, 1:], right), (nearest[:, :-1], right),
        (nearest[1:], above), (nearest[:-1], above),
    ):  # fmt: skip
        np.fmin(part, far, out=part)
    return np.where(np.isfinite(nearest), nearest, 0.0).astype(np.float32)


def is_noisy(
    grid: PointGrid,
    light: Float32Array,
    room: Float32Array,
    error: Float32Array,
    unseen: float,
    largest: float,
) -> BoolArray:
    """Where (H, W) noise will be seen in light, by luminance, room and error, all (H, W).

    `unseen`: noise that may stay after smoothing over next neighbours alone, as a share of the
    light. Noise of single points above the share `largest` means that few rays bring most light.
    """
    share, left = noise_shares(grid, light, room, error)
    return np.asarray((share > largest) | (left > unseen))


def noise_shares(
    grid: PointGrid, light: Float32Array, room: Float32Array, error: Float32Array
) -> tuple[FloatArray, FloatArray]:
    """Noise (H, W) as a share of light, and what smoothing over next neighbours leaves of it.

    Light by luminance, room and error are (H, W).
    """
    # Means about a point: where few rays bring most light, some points have met none of it.
    share = np.sqrt(mean_about(error * error)) / np.maximum(mean_about(light), 1e-30)
    return np.asarray(share), np.asarray(share / np.sqrt(company(grid, room)))


def company(grid: PointGrid, room: Float32Array) -> Float32Array:
    """How many points (H, W) next to a point share its light, itself included, if it is even."""
    return np.asarray(_company(*grid, room, _SHARE_OF_ROOM[0]))


def _noise2(values: Float32Array, error2: Float32Array) -> Float32Array:
    """Squared bound of the noise (H, W), by the squared error (H, W) of values (H, W, 4)."""
    mean = mean_about(luminance(values[..., :3]))
    share2 = error2 / np.maximum(mean**2, np.float32(1e-30)) / _LARGE_SHARE**2
    # Where next to no light is, any noise is a large share.
    bound2 = error2 * (_NOISES**2 * (1.0 + share2**2))
    return np.asarray(np.minimum(bound2, np.finfo(np.float32).max), np.float32)


def mean_about(values: FloatArray | Float32Array) -> FloatArray:
    """Means (H, W) over neighbours, mirrored at the rim; scipy's filter takes 0.4 s to import."""
    mean: FloatArray = np.asarray(values)
    for _ in range(2):
        rows = np.pad(mean, ((_AROUND // 2,) * 2, (0, 0)), mode="symmetric")
        mean = np.asarray(sum(rows[k : k + len(mean)] for k in range(_AROUND))).T / _AROUND
    return mean


@inlined
def _shared(plane, place, room, y, x, r, c, share):  # type: ignore[no-untyped-def]
    """How far two points count as one, by their planes and the room about them."""
    alike, away2, off = np.float32(0.0), np.float32(0.0), np.float32(0.0)
    for k in range(3):
        step = place[r, c, k] - place[y, x, k]
        alike += plane[r, c, k] * plane[y, x, k]
        away2 += step * step
        off += step * plane[y, x, k]
    away = np.sqrt(away2)
    if alike < np.float32(0.9) or abs(off) > np.float32(0.1) * away:
        return np.float32(0.0)
    reach = np.float32(share) * min(room[y, x], room[r, c])
    weight = min(np.float32(1.0), reach / max(away, np.float32(1e-9)))
    return weight * weight


@kernel
def _company(plane, place, room, share):  # type: ignore[no-untyped-def]
    """Sum of the weights of each point's neighbours (H, W), at least 1."""
    height, width = room.shape
    out = np.empty_like(room)
    for y in range(height):
        for x in range(width):
            total = np.float32(0.0)
            for r in range(max(y - _REACH, 0), min(y + _REACH + 1, height)):
                for c in range(max(x - _REACH, 0), min(x + _REACH + 1, width)):
                    total += _shared(plane, place, room, y, x, r, c, share)
            out[y, x] = max(total, np.float32(1.0))
    return out


@kernel
def _smoothed(light, plane, place, room, noise2, error2, apart, share):  # type: ignore[no-untyped-def]
    """Means of light (H, W, 4) over neighbours on one plane, by room and squared noise (H, W).

    The squared error (H, W) that is left of `error2` comes second.
    """
    height, width = room.shape
    out, left = np.zeros_like(light), error2.copy()
    for y in range(height):
        for x in range(width):
            total, squares = np.float32(0.0), np.float32(0.0)
            for i in range(-_REACH, _REACH + 1):
                for j in range(-_REACH, _REACH + 1):
                    r, c = y + i * apart, x + j * apart
                    if r < 0 or c < 0 or r >= height or c >= width:
                        continue
                    weight = _shared(plane, place, room, y, x, r, c, share)
                    if weight <= 0.0:
                        continue
                    apart_by = np.float32(0.2126) * (light[r, c, 0] - light[y, x, 0])
                    apart_by += np.float32(0.7152) * (light[r, c, 1] - light[y, x, 1])
                    apart_by += np.float32(0.0722) * (light[r, c, 2] - light[y, x, 2])
                    both = noise2[r, c] + noise2[y, x]
                    same = np.float32(1.0) - apart_by**2 / max(both, np.float32(1e-30))
                    weight *= max(same, np.float32(0.0))
                    total += weight
                    squares += weight * weight * error2[r, c]
                    for k in range(4):
                        out[y, x, k] += weight * light[r, c, k]
            if total > 0.0:
                for k in range(4):
                    out[y, x, k] /= total
                left[y, x] = squares / (total * total)
    return out, left

"""Light maps as sums of few basis maps, by clusters of texels: clustered principal components.

Each cluster has separate basis maps, and each texel is in the cluster whose maps leave the least
of its light (Sloan, Hall, Hart and Snyder 2003, "Clustered principal components for precomputed
radiance transfer", section 5: iterative PCA). On even walls the texels of two clusters then lie
among each other where both fit alike, and no border shows. The three channels share maps and differ
in coefficients, which depend on the hour. Values are whole steps, one step for all maps of a
cluster: strong maps have many bits, weak ones few.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from share.components import principal
from share.light_maps import LightMaps
from vrut_lite.geometry.colour import LUMINANCE_WEIGHTS
from vrut_lite.numeric_types import Float32Array, FloatArray

CLUSTERS = 64
# Step of a cluster's values, as a share of the sun's light in them (rms over texels).
_STEP = 7e-4
_MOST = 32000.0
# Codes of a value's factor are its logarithm to base 2, times this; 0 is no light.
CODES_PER_STOP = 16.0
# Errors count in shares of a texel's mean light to this power: dark texels count, but not as much
# as if nobody saw brighter ones beside them.
_WEIGHT_POWER = 0.85
# Directions of all maps that bases are built in, and texels that these are found by.
_DIMENSIONS, _SAMPLES = 256, 6000
# Directions and texels that clusters are found by; rounds of k-means, then of iterative PCA.
_CLUSTERED_DIMENSIONS, _CLUSTERED_SAMPLES = 96, 50_000
_FIRST_ROUNDS, _ROUNDS = 4, 4
_BLOCK = 4096


@dataclass(frozen=True, eq=False)
class LightBasis:
    """Basis maps over T values, K terms in each of C clusters.

    Attributes:
        factor_code: (T,) uint8; the factor is 2^((code - 255) / `CODES_PER_STOP`), 0 for code 0.
        cluster: (T,) uint8.
        terms: (K, T) int16, whole steps.
        sun: (S, C, K, 3) float32, coefficients of a step at the sun's places, as shares of levels.
        glow, lamps: (C, K, 3) float32, W m^-2 of a step.
    """

    factor_code: NDArray[np.uint8]
    cluster: NDArray[np.uint8]
    terms: NDArray[np.int16]
    sun: Float32Array
    glow: Float32Array
    lamps: Float32Array

    def light(self, coefficients: FloatArray | Float32Array) -> Float32Array:
        """Light (T, 3) of coefficients (C, K, 3): the twin of the page's sum."""
        found = np.zeros((len(self.cluster), 3), np.float32)
        for number in range(len(coefficients)):
            at = self.cluster == number
            values = self.terms[:, at].T.astype(np.float32)
            found[at] = values @ coefficients[number].astype(np.float32)
        return np.maximum(found * factors(self.factor_code)[:, None], 0.0)

    def spread(self) -> FloatArray:
        """Rms (C, K) of the steps of a cluster's terms."""
        found = np.zeros((CLUSTERS, len(self.terms)))
        for number in range(CLUSTERS):
            own = self.terms[:, (self.cluster == number) & (self.factor_code > 0)]
            found[number] = np.sqrt(np.square(own.astype(float)).sum(axis=1) / max(own.shape[1], 1))
        return found


def factors(code: NDArray[np.uint8]) -> Float32Array:
    """Factors (T,) of codes."""
    found = np.exp2((code.astype(np.float32) - 255.0) / np.float32(CODES_PER_STOP))
    return np.where(code > 0, found, 0.0).astype(np.float32)


def light_basis(maps: LightMaps, terms: int, seed: int = 49) -> LightBasis:
    """The basis of light maps; `seed` chooses the samples, so that a page is the same twice.

    Terms come in fours, as the page sums them.
    """
    terms = -(-terms // 4) * 4
    random = np.random.default_rng(seed)
    code = _factor_code(maps)
    columns = _Columns(maps, factors(code))
    used = np.flatnonzero(code)
    sample = random.permutation(used)[:_SAMPLES]
    rows = columns.rows(sample)
    directions = principal(rows.T @ rows, _DIMENSIONS)
    towards = np.empty((len(code), directions.shape[1]), np.float32)
    for block in _blocks(len(code)):
        towards[block] = columns.rows(block) @ directions
    cluster = np.zeros(len(code), np.uint8)
    cluster[used] = _clusters(towards[used, :_CLUSTERED_DIMENSIONS], terms, random)
    values = np.zeros((terms, len(code)), np.int16)
    count = columns.count
    found = np.zeros((CLUSTERS, terms, count), np.float32)
    for number in range(CLUSTERS):
        at = used[cluster[used] == number]
        if not len(at):
            continue
        own = principal(towards[at].T @ towards[at], terms)
        rows = columns.rows(at)
        steps = _whole_steps(towards[at] @ own, columns.sunlight(rows))
        values[: steps.shape[1], at] = steps.T
        # Coefficients of the rounded maps, by least squares.
        exact = steps.astype(np.float32)
        inner = (exact.T @ exact).astype(float)
        inner += np.diag(1e-6 * np.diag(inner) + 1e-6)
        product = exact.T @ rows
        found[number, : len(inner)] = np.linalg.solve(inner, product)
    sun, glow, lamps = columns.split(found)
    return LightBasis(code, cluster, values, sun, glow, lamps)


class _Columns:
    """All light of values as rows: the sun's places, the glow and the lamps, channel by channel."""

    def __init__(self, maps: LightMaps, factor: Float32Array):
        self._maps = maps
        self._inverse = np.where(factor > 0.0, 1.0 / np.maximum(factor, 1e-30), 0.0)
        self._places = len(maps.by_sun)
        # Deep in hundreds of the sun's places, one of night or lamps would hardly count.
        weight = np.sqrt(max(self._places, 1) / 2.0)
        means = [float(light.mean()) for light in (maps.by_glow, maps.by_lamps)]
        level = float(maps.by_sun.mean())
        self._scales = [weight * level / mean if mean > 0.0 else 0.0 for mean in means]
        self.count = 3 * (self._places + 2)

    def rows(self, at: NDArray[np.integer] | slice) -> Float32Array:
        """Rows (n, columns) of values, over their factors."""
        sun = self._maps.by_sun[:, at].transpose(1, 0, 2)
        extra = [
            light[at] * np.float32(scale)
            for light, scale in zip(
                (self._maps.by_glow, self._maps.by_lamps), self._scales, strict=True
            )
        ]
        found = np.concatenate([sun.reshape(len(sun), -1), *extra], axis=1)
        return np.asarray(found * self._inverse[at][:, None], np.float32)

    def sunlight(self, rows: Float32Array) -> float:
        """Rms length of rows (n, columns) in the columns of the sun's places."""
        return float(np.sqrt(np.square(rows[:, : 3 * self._places]).sum(axis=1).mean()))

    def split(self, found: Float32Array) -> tuple[Float32Array, Float32Array, Float32Array]:
        """Coefficients (C, K, columns) of the sun's places, the glow and the lamps."""
        clusters, terms, _ = found.shape
        sun = found[..., : 3 * self._places].reshape(clusters, terms, self._places, 3)
        extra = [
            np.asarray(part / scale if scale else part * 0.0, np.float32)
            for part, scale in zip(np.split(found[..., -6:], 2, axis=-1), self._scales, strict=True)
        ]
        return np.ascontiguousarray(sun.transpose(2, 0, 1, 3)), extra[0], extra[1]


def _blocks(count: int) -> Iterator[slice]:
    for first in range(0, count, _BLOCK):
        yield slice(first, min(first + _BLOCK, count))


def _whole_steps(basis: Float32Array, sunlight: float) -> NDArray[np.int16]:
    """Whole steps of a cluster's maps (n, K) of rows whose light by the sun is `sunlight` long.

    Texels that lamps light alone have long rows, in which the sun's light would be rounded off.
    """
    step = max(_STEP * sunlight, float(np.abs(basis).max()) / _MOST, 1e-30)
    return np.rint(basis / step).astype(np.int16)


def _clusters(points: Float32Array, terms: int, random: np.random.Generator) -> NDArray[np.integer]:
    """Clusters (n,) of points (n, D), each in the one whose basis keeps most of it."""
    sample = points[random.permutation(len(points))[:_CLUSTERED_SAMPLES]]
    cluster = _by_direction(sample, random)
    for _ in range(_ROUNDS):
        cluster = _by_basis(sample, _bases(sample, cluster, terms))
    return _by_basis(points, _bases(sample, cluster, terms))


def _by_direction(points: Float32Array, random: np.random.Generator) -> NDArray[np.integer]:
    """Clusters (n,) of points by their direction (Lloyd's k-means)."""
    points = points / np.maximum(np.linalg.norm(points, axis=1, keepdims=True), 1e-20)
    centres = points[random.permutation(len(points))[:CLUSTERS]]
    nearest = np.zeros(len(points), np.int64)
    for _ in range(_FIRST_ROUNDS):
        for block in _blocks(len(points)):
            away = np.square(centres).sum(axis=1) - 2.0 * points[block] @ centres.T
            nearest[block] = away.argmin(axis=1)
        centres = np.stack(
            [
                points[nearest == number].mean(axis=0) if np.any(nearest == number) else centre
                for number, centre in enumerate(centres)
            ]
        )
    return nearest


def _bases(points: Float32Array, cluster: NDArray[np.integer], terms: int) -> Float32Array:
    """Orthonormal bases (C, D, K) of clusters of points (n, D); those without points are 0."""
    found = np.zeros((CLUSTERS, points.shape[1], min(terms, points.shape[1])), np.float32)
    for number in range(CLUSTERS):
        own = points[cluster == number]
        if len(own):
            found[number] = principal(own.T @ own, terms)
    return found


def _by_basis(points: Float32Array, bases: Float32Array) -> NDArray[np.integer]:
    """Clusters (n,) of points (n, D) whose bases (C, D, K) keep most of them."""
    clusters, dimensions, terms = bases.shape
    along = bases.transpose(1, 0, 2).reshape(dimensions, -1)
    found = np.zeros(len(points), np.int64)
    for block in _blocks(len(points)):
        kept = np.square(points[block] @ along).reshape(-1, terms).sum(axis=1)
        found[block] = kept.reshape(-1, clusters).argmax(axis=1)
    return found


def _factor_code(maps: LightMaps) -> NDArray[np.uint8]:
    """Codes (T,) of the factors of values: their mean light to a power."""
    mean = np.zeros(maps.by_sun.shape[1])
    for light in maps.by_sun:
        mean += light @ LUMINANCE_WEIGHTS
    mean /= max(float(mean.max()), 1e-30)
    for extra in (maps.by_glow, maps.by_lamps):
        # Where lamps alone give light, theirs counts.
        own = extra @ LUMINANCE_WEIGHTS
        mean = np.maximum(mean, own * (0.1 / max(float(own.max()), 1e-30)))
    stops = _WEIGHT_POWER * np.log2(np.maximum(mean, 1e-30))
    code = np.clip(np.rint(255.0 + CODES_PER_STOP * stops), 1, 255)
    return np.where(mean > 0.0, code, 0).astype(np.uint8)

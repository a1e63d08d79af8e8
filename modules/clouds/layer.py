"""Makes a `CloudLayer` from settings; solves for the weather threshold that gives the coverage."""

import msgspec
import numpy as np

from clouds.noise import noises
from clouds.settings import CloudSettings
from vrut_lite.array import Array
from vrut_lite.daylight.cloud_density import (
    DETAIL_PERIOD_M,
    SHAPE_PERIOD_M,
    WEATHER_PERIODS_M,
    column_of,
    density_of,
    envelope,
    noise_at,
    weather_at,
)
from vrut_lite.daylight.clouds import CloudLayer
from vrut_lite.numeric_types import FloatArray

# Two Henyey-Greenstein lobes for a droplet's phase function; their mean cosine is 0.74.
PHASE = (0.85, -0.3, 0.9)
# Samples for the coverage: columns along each side, and heights.
_COLUMNS, _HEIGHTS = 96, 24
_HALVINGS = 12
# Range of the threshold: at the lower end all sky is covered, at the upper end none.
_LOWEST, _HIGHEST = -0.5, 1.0
# Coverage of a closed layer: to close its last gaps clouds would lose all shape.
_CLOSED = 0.997
# Columns of less optical depth count as clear sky.
_LEAST_OPTICAL_DEPTH = 0.5


class _Samples:
    """Noise in columns, (columns,) and (columns, heights), before the threshold is applied."""

    def __init__(self, layer: CloudLayer):
        # The R2 sequence (Roberts 2018): evenly spread, without a pattern.
        index = np.arange(_COLUMNS * _COLUMNS)
        spread = np.stack([index * 0.7548776662466927, index * 0.5698402909980532], axis=-1) % 1.0
        level = spread * 7.0 * max(*WEATHER_PERIODS_M, SHAPE_PERIOD_M, DETAIL_PERIOD_M)
        self.height = (np.arange(_HEIGHTS) + 0.5) / _HEIGHTS
        self.weather = weather_at(layer, level)
        over_base = self.height * layer.thickness_m
        there = np.broadcast_to(level[:, None], (len(level), _HEIGHTS, 2))
        still = (0.0, 0.0)
        self.shape = noise_at(layer.shape.values, SHAPE_PERIOD_M, still, there, over_base)
        self.detail = noise_at(layer.detail.values, DETAIL_PERIOD_M, still, there, over_base)

    def column_density(self, threshold: float) -> FloatArray:
        """Mean density of each column (columns,)."""
        column = column_of(self.weather[:, None], threshold)
        densities = density_of(envelope(column, self.height), self.shape, self.detail)
        return np.asarray(densities.mean(axis=1))


def cloud_layer(settings: CloudSettings) -> CloudLayer:
    """The layer for these settings, without drift."""
    weather, shape, detail = noises(settings.seed)
    layer = CloudLayer(
        base_m=settings.base_m,
        thickness_m=settings.thickness_m,
        extinction_per_m=settings.extinction_per_m,
        coverage=settings.coverage,
        threshold=_LOWEST,
        column_density=0.0,
        drift_m=(0.0, 0.0),
        phase=PHASE,
        weather=Array(weather),
        shape=Array(shape),
        detail=Array(detail),
    )
    return with_coverage(layer, settings.coverage)


def with_coverage(layer: CloudLayer, coverage: float) -> CloudLayer:
    """The layer with the threshold at which this share of the zenith is cloud."""
    samples = _Samples(layer)
    full_depth = layer.extinction_per_m * layer.thickness_m
    low, high = _LOWEST, _HIGHEST
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        covered = samples.column_density(middle) * full_depth > _LEAST_OPTICAL_DEPTH
        if covered.mean() > min(coverage, _CLOSED):
            low = middle
        else:
            high = middle
    densities = samples.column_density(low)
    clouds = densities * full_depth > _LEAST_OPTICAL_DEPTH
    return msgspec.structs.replace(
        layer,
        coverage=coverage,
        threshold=low,
        column_density=float(densities[clouds].mean()) if clouds.any() else 0.0,
    )

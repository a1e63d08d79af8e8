"""Makes layers of clouds; solves for the weather threshold that gives a layer its coverage."""

import msgspec
import numpy as np

from clouds.genera import GENERA
from clouds.model.cloud_density import (
    column_of,
    density_of,
    detail_at,
    envelope,
    shape_at,
    weather_at,
)
from clouds.model.cloud_transport import even_transmittance, layer_transmittance
from clouds.noise import detail_volume, shape_volume, weather_map
from clouds.settings import Layer, Passes
from vrut_lite.array import Array
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.numeric_types import FloatArray

# Samples for the coverage: columns along each side, and heights.
_COLUMNS, _HEIGHTS = 96, 24
_HALVINGS = 12
# Range of the threshold: at the lower end all sky is covered, at the upper end none.
_LOWEST, _HIGHEST = -0.5, 1.0
# Coverage of a closed layer: to close its last gaps clouds would lose all shape.
_CLOSED = 0.997
# Columns of less optical depth count as clear sky, in thin layers those of less than this share of
# what a full column has.
_LEAST_OPTICAL_DEPTH, _LEAST_SHARE = 0.5, 0.05
_THINNEST, _DENSEST_PER_M, _USUAL_ALBEDO = 0.1, 0.2, 0.15
# Layers of one seed are not of one noise.
_SEEDS_APART = 1_000_003


class _Samples:
    """Noise in columns, (columns,) and (columns, heights), before the threshold is applied."""

    def __init__(self, layer: CloudLayer):
        # The R2 sequence (Roberts 2018): evenly spread, without a pattern.
        index = np.arange(_COLUMNS * _COLUMNS)
        spread = np.stack([index * 0.7548776662466927, index * 0.5698402909980532], axis=-1) % 1.0
        form = layer.form
        periods_m = (*form.weather_periods_m, form.shape_period_m, form.detail_period_m)
        level = spread * 7.0 * max(periods_m)
        self.form = form
        self.height = (np.arange(_HEIGHTS) + 0.5) / _HEIGHTS
        self.weather = weather_at(layer, level)
        over_base = self.height * layer.thickness_m
        there = np.broadcast_to(level[:, None], (len(level), _HEIGHTS, 2))
        self.shape = shape_at(layer, there, over_base)
        self.detail = detail_at(layer, there, over_base)

    def column_density(self, threshold: float) -> FloatArray:
        """Mean density of each column (columns,)."""
        column = column_of(self.weather[:, None], threshold, self.form)
        covered = envelope(column, self.height, self.form)
        densities = density_of(covered, self.shape, self.detail, self.form)
        return np.asarray(densities.mean(axis=1))


def cloud_layer(layer: Layer, seed: int) -> CloudLayer:
    """A layer of clouds, without drift."""
    genus = GENERA[layer.genus]
    # Noise is of the genus, so that a layer that changes its numbers keeps its clouds.
    own_seed = seed + _SEEDS_APART * list(GENERA).index(layer.genus)
    made = CloudLayer(
        base_m=layer.base_m,
        thickness_m=layer.thickness_m,
        extinction_per_m=layer.extinction_per_m,
        coverage=layer.coverage,
        threshold=_LOWEST,
        column_density=0.0,
        drift_m=(0.0, 0.0),
        weather=Array(weather_map(own_seed, genus.pattern)),
        shape=Array(shape_volume(seed)),
        detail=Array(detail_volume(seed)),
        particles=genus.particles,
        form=genus.form,
    )
    covered = with_coverage(made, layer.coverage)
    return covered if layer.passes is None else with_light(covered, layer.passes)


def with_light(layer: CloudLayer, passes: Passes) -> CloudLayer:
    """The layer with the extinction at which this share of a clear sky's light passes, in the mean.

    A column counts as a plane layer of its depth over usual ground: light through gaps is in the
    mean, light from clouds' sides is not. The extinction stays between a tenth of the layer's and
    the densest cloud's.
    """
    columns_m = _Samples(layer).column_density(layer.threshold) * layer.thickness_m
    sine, direct = float(np.sin(passes.sun_elevation_rad)), passes.direct_share
    low, high = np.log([_THINNEST * layer.extinction_per_m, _DENSEST_PER_M])
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        depths = np.exp(middle) * columns_m
        even = float(even_transmittance(depths).mean())
        light = direct * float(layer_transmittance(depths, sine).mean()) + (1.0 - direct) * even
        # The ground's light comes back from the clouds, and so on.
        light /= 1.0 - _USUAL_ALBEDO * (1.0 - even)
        low, high = (middle, high) if light > passes.global_share else (low, middle)
    return msgspec.structs.replace(layer, extinction_per_m=float(np.exp(low)))


def with_coverage(layer: CloudLayer, coverage: float) -> CloudLayer:
    """The layer with the threshold at which this share of the zenith is cloud."""
    samples = _Samples(layer)
    full_depth = layer.extinction_per_m * layer.thickness_m
    least_depth = min(_LEAST_OPTICAL_DEPTH, _LEAST_SHARE * full_depth)
    low, high = _LOWEST, _HIGHEST
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        covered = samples.column_density(middle) * full_depth > least_depth
        if covered.mean() > min(coverage, _CLOSED):
            low = middle
        else:
            high = middle
    densities = samples.column_density(low)
    clouds = densities * full_depth > least_depth
    return msgspec.structs.replace(
        layer,
        coverage=coverage,
        threshold=low,
        column_density=float(densities[clouds].mean()) if clouds.any() else 0.0,
    )

"""Fits a sky model to the clear sky of a photograph: turbidity, one exposure, three gains.

A photograph's unit and white balance are unknown. So one exposure (the photograph's unit per
W m^-2 sr^-1) and three gains (their sum, weighted as luminance is, is 1) are taken out before
light and colour are compared. Pixels count by their solid angle.
"""

from collections.abc import Callable, Iterable
from functools import lru_cache, partial
from itertools import product
from typing import NamedTuple

import msgspec
import numpy as np
from bruneton_sky.background import background_cube, surroundings
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solver import SourceField, solve
from dynamic_skylight.daylight import Daylight
from numpy.typing import NDArray

from vrut_lite.atmosphere.aerosol import optical_depth_of_turbidity
from vrut_lite.atmosphere.equal_haze import equal_sky
from vrut_lite.geometry.colour import LUMINANCE_WEIGHTS, SRGB_FROM_XYZ, luminance
from vrut_lite.geometry.panorama import lat_long_directions, sample_sky
from vrut_lite.messages.haze import DEFAULT_AEROSOL, AerosolType, SetHaze
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.visible_disc import visible_fraction
from vrut_lite_lab.study.photographs.mask import Sun, elevations_deg

# Radiance (n, 3), W m^-2 sr^-1, of a turbidity and a sun at directions (n, 3).
Model = Callable[[float, Sun, FloatArray], FloatArray]

ALBEDO = 0.1
# A residual beyond this, in natural logarithms of luminance, counts by its size, not its square.
_HUBER = 0.15
_CUBE_SIZE = 128
_AS_GOOD = 1.1
_SETTINGS = BrunetonSkySettings(albedo=ALBEDO)


class ClearPixels(NamedTuple):
    """The clear sky of a photograph: directions (n, 3), linear RGB (n, 3), solid angles (n,)."""

    direction: FloatArray
    rgb: FloatArray
    weight: FloatArray


class Fit(NamedTuple):
    """A model's sky fitted to the photograph's.

    Attributes:
        turbidity, sun: the sky's.
        exposure: of the photograph, its unit per W m^-2 sr^-1.
        gains: (3,) of the photograph's channels, after the exposure.
        rms_log10: of the ratio of luminances, photograph over model.
        rms_uv: distance of gain-corrected chromaticities on the CIE 1976 diagram, u'v'.
        cost: what the search makes small: mean Huber loss of the logarithm of luminance.
    """

    turbidity: float
    sun: Sun
    exposure: float
    gains: FloatArray
    rms_log10: float
    rms_uv: float
    cost: float


def hosek_wilkie(turbidity: float, sun: Sun, direction: FloatArray) -> FloatArray:
    """The sky of the module dynamic_skylight, at equal haze, twilight included."""
    elevation = float(np.radians(sun.elevation_deg))
    haze = SetHaze(optical_depth_550=float(optical_depth_of_turbidity(turbidity)))
    equal = equal_sky(haze.optical_depth_550, elevation)
    light = Daylight(
        turbidity=equal.turbidity,
        level=equal.level,
        haze=haze,
        albedo=ALBEDO,
        sun_colour="air",
        apparent_elevation_rad=elevation,
        sun_azimuth_rad=float(np.radians(sun.azimuth_deg)),
        visible_disc_fraction=float(visible_fraction(elevation)),
    )
    theta = np.arccos(np.clip(direction[:, 1], -1.0, 1.0))
    gamma = np.arccos(np.clip(direction @ sun.direction(), -1.0, 1.0))
    return light.sky.radiance(theta, gamma)


def bruneton(turbidity: float, sun: Sun, direction: FloatArray) -> FloatArray:
    """The sky of the module bruneton_sky, seen from the ground."""
    return _bruneton_of(_SETTINGS, turbidity, sun, direction)


def bruneton_with(**changes: float) -> Model:
    """The same with other settings than the module's own, such as `mie_g`."""
    return partial(_bruneton_of, msgspec.structs.replace(_SETTINGS, **changes))


def bruneton_in(aerosol: AerosolType) -> Model:
    """The same in air of a type of OPAC, with nothing else changed."""
    return partial(_bruneton_of, _SETTINGS, aerosol=aerosol)


def _bruneton_of(
    settings: BrunetonSkySettings,
    turbidity: float,
    sun: Sun,
    direction: FloatArray,
    aerosol: AerosolType = DEFAULT_AEROSOL,
) -> FloatArray:
    depth = float(optical_depth_of_turbidity(turbidity))
    field = _field(settings, SetHaze(optical_depth_550=depth, aerosol=aerosol))
    around = surroundings(field, 0.0, sun.direction())
    return sample_sky(background_cube(around, _CUBE_SIZE), direction)


@lru_cache(maxsize=32)
def _field(settings: BrunetonSkySettings, haze: SetHaze) -> SourceField:
    return solve(atmosphere_of(settings, 0.0, haze), all_orders=True)


MODELS: dict[str, Model] = {"Hosek-Wilkie": hosek_wilkie, "Bruneton": bruneton}


def pixels_of(photo: FloatArray, usable: NDArray[np.bool_], step: int = 1) -> ClearPixels:
    """The usable pixels of a photograph (h, 2 h, 3), of every `step`-th row and column."""
    height = photo.shape[0]
    chosen = np.zeros_like(usable)
    chosen[::step, ::step] = usable[::step, ::step]
    weight = np.cos(np.radians(elevations_deg(height)))[:, None] * np.ones(2 * height)
    return ClearPixels(lat_long_directions(height)[chosen], photo[chosen], weight[chosen])


def best_fit(
    pixels: ClearPixels, model: Model, turbidities: Iterable[float], suns: Iterable[Sun]
) -> tuple[Fit, tuple[float, float]]:
    """The fit of least cost, and from and to which turbidity its sun fits within 10 % of that."""
    fits = [fit(pixels, model, t, sun) for t, sun in product(turbidities, suns)]
    best = min(fits, key=lambda found: found.cost)
    near = [f.turbidity for f in fits if f.sun == best.sun and f.cost < _AS_GOOD * best.cost]
    return best, (min(near), max(near))


def fit(pixels: ClearPixels, model: Model, turbidity: float, sun: Sun) -> Fit:
    """Exposure and gains, and the residual between photograph and model."""
    sky = model(turbidity, sun, pixels.direction)
    # The model's sky may be zero somewhere, which has no logarithm.
    sky = np.maximum(sky, 1e-4 * sky.mean(axis=0))
    offsets = [_robust_mean(np.log(pixels.rgb[:, c] / sky[:, c]), pixels.weight) for c in range(3)]
    gains = np.exp(offsets)
    gains /= LUMINANCE_WEIGHTS @ gains
    ratio = np.log(luminance(pixels.rgb) / luminance(sky * gains))
    exposure = _robust_mean(ratio, pixels.weight)
    residual = ratio - exposure
    share = pixels.weight / pixels.weight.sum()
    apart = chromaticity(pixels.rgb / gains) - chromaticity(sky)
    return Fit(
        turbidity,
        sun,
        float(np.exp(exposure)),
        gains,
        float(np.sqrt(share @ residual**2) / np.log(10.0)),
        float(np.sqrt(share @ (apart**2).sum(axis=-1))),
        float(share @ _huber_loss(residual)),
    )


def residual_log10(pixels: ClearPixels, model: Model, found: Fit) -> FloatArray:
    """log10 (n,) of luminance, photograph over fitted model."""
    sky = model(found.turbidity, found.sun, pixels.direction)
    return np.log10(luminance(pixels.rgb) / (luminance(sky * found.gains) * found.exposure))


def contrast(pixels: ClearPixels, residual: FloatArray) -> float:
    """The power of the model's luminance that the photograph's goes with, 1 for a true pair.

    Least squares in logarithms of what `residual_log10` gives; below 1 the photograph's range
    is the smaller one, as it is where bright light was cut.
    """
    log = np.log10(luminance(pixels.rgb)) - residual
    share = pixels.weight / pixels.weight.sum()
    apart = log - share @ log
    return float(1.0 + (share @ (apart * residual)) / (share @ apart**2))


def spread_log10(pixels: ClearPixels) -> float:
    """The rms residual of a sky of one even luminance, for comparison."""
    log = np.log10(luminance(pixels.rgb))
    share = pixels.weight / pixels.weight.sum()
    return float(np.sqrt(share @ (log - share @ log) ** 2))


def chromaticity(rgb: FloatArray) -> FloatArray:
    """CIE 1976 u', v' (..., 2) of linear sRGB (..., 3)."""
    x, y, z = np.moveaxis(rgb @ np.linalg.inv(SRGB_FROM_XYZ).T, -1, 0)
    return np.stack([4.0 * x, 9.0 * y], axis=-1) / (x + 15.0 * y + 3.0 * z)[..., None]


def _robust_mean(values: FloatArray, weight: FloatArray) -> float:
    """Huber's estimate of location, by iterated weights."""
    mean = float(np.median(values))
    for _ in range(20):
        trust = weight * _HUBER / np.maximum(np.abs(values - mean), _HUBER)
        mean = float(np.average(values, weights=trust))
    return mean


def _huber_loss(residual: FloatArray) -> FloatArray:
    size = np.abs(residual)
    return np.where(size < _HUBER, 0.5 * size**2, _HUBER * (size - 0.5 * _HUBER))

"""The converged sky under the benchmark's conditions, by direct evaluation."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.ray_light import scattered_once
from bruneton_sky.solver import SolverSizes, SourceField, multiple_scattering, solve

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.bench.skies import Condition, air, conditions, sky_directions

# Of the truth: orders at most, and the change of all light at which they end.
_TRUE_ORDERS, _TRUE_TOLERANCE = 40, 2e-3
_NODES = 48
_SKYLIGHT_EXPONENT = 3.0
# Steps and bins of a ray that add no visible error.
_STEPS, _BINS = 256, 64
# Solved in seconds; good for errors above half a percent.
_QUICK_SIZES = SolverSizes(
    altitude=36, mu_s=80, direction_mu=48, direction_azimuth=24, later_azimuth=16, degree=24,
    source_mu=64, source_azimuth=24, steps=128, node_bins=32, single_bins=64, multiple_bins=48,
    polarised_mu=24, polarised_azimuth=8, polarised_bins=24,
)  # fmt: skip


def in_words(quick: bool) -> str:
    """The truth in words, for the plots."""
    sizes = "nearly converged" if quick else "converged"
    return (
        f"direct evaluation, {_NODES} nodes for light scattered once, for the rest the solver with "
        f"{sizes} sizes and all orders"
    )


@lru_cache
def exact_skies(name: str, quick: bool) -> dict[str, FloatArray]:
    """Linear sRGB radiance (n, 3) of the picture's sky, by condition."""
    sizes = _QUICK_SIZES if quick else SolverSizes.converged()
    field = solve(air(name), _TRUE_ORDERS, sizes, True, _TRUE_TOLERANCE)
    return {each.name: sky_rgb(field, name, each) for each in conditions(quick)}


def sky_rgb(field: SourceField, name: str, condition: Condition) -> FloatArray:
    """The picture's sky (n, 3) by a solution; light scattered once is exact."""
    towards = _towards(name, condition)
    light = light_once(field, condition, towards) + light_again(field, condition, towards)
    return in_colour(field.atmosphere, light)


def light_once(field: SourceField, condition: Condition, towards: FloatArray) -> FloatArray:
    """Spectral radiance (n, C) of light scattered once, towards unit directions (n, 3)."""
    sun = condition.sun
    nu = np.clip(towards @ sun, -1.0, 1.0)
    return scattered_once(field, condition.height_m, towards[:, 1], float(sun[1]), nu, _NODES)


def light_again(field: SourceField, condition: Condition, towards: FloatArray) -> FloatArray:
    """The same of light scattered more than once, with the field's own steps and bins."""
    sun = condition.sun
    nu = np.clip(towards @ sun, -1.0, 1.0)
    return multiple_scattering(field, condition.height_m, towards[:, 1], float(sun[1]), nu)


def finely_traced(field: SourceField) -> SourceField:
    """The same solution, looked at along rays in so many bins that they do not show."""
    return replace(field, sizes=replace(field.sizes, steps=_STEPS, multiple_bins=_BINS))


def in_colour(atmosphere: Atmosphere, radiance: FloatArray) -> FloatArray:
    """Linear sRGB (n, 3) of spectral radiance (n, C), without what lies outside the gamut."""
    return np.maximum(
        rgb_from_spectrum(radiance, atmosphere.wavelength_nm, _SKYLIGHT_EXPONENT), 0.0
    )


def _towards(name: str, condition: Condition) -> FloatArray:
    return sky_directions(air(name), condition.height_m)

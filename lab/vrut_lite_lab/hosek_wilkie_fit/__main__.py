"""Fit turbidity and level of Hosek and Wilkie's sky to the solver's sky of equal haze.

    python -m vrut_lite_lab.hosek_wilkie_fit        # prints the table of atmosphere/equal_haze.py

For each optical depth of OPAC's continental average the turbidity whose luminance over the sky
differs least from the solver's in shape, in the mean over the sun's elevations; for each elevation
the factor that brings it to the same level. Least is half the narrowest range of the ratio's
logarithm that holds nine tenths of the sky. No measurement enters.
"""

import numpy as np
from bruneton_sky import solve
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from dynamic_skylight import HosekWilkieSky

from vrut_lite.atmosphere.equal_haze import DEPTHS, ELEVATIONS_DEG
from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.haze import SetHaze
from vrut_lite.numeric_types import FloatArray

_ALBEDO = 0.1
_TURBIDITIES = np.linspace(1.0, 10.0, 91)
_DIRECTIONS = 240


def directions() -> FloatArray:
    """Unit vectors (n, 3), up along z, evenly over the sky (Fibonacci's spiral)."""
    k = np.arange(_DIRECTIONS) + 0.5
    z, turn = k / _DIRECTIONS, np.pi * (1.0 + np.sqrt(5.0)) * k
    level = np.sqrt(1.0 - z * z)
    return np.stack([level * np.cos(turn), level * np.sin(turn), z], axis=-1)


def fit(depth: float) -> tuple[float, FloatArray, FloatArray]:
    """Turbidity; level and worst ratio in nine tenths of the sky for each elevation."""
    haze = SetHaze(optical_depth_550=depth, aerosol="continental-average")
    sky = solve(atmosphere_of(BrunetonSkySettings(albedo=_ALBEDO), 0.0, haze))
    d = directions()
    found = np.empty((len(ELEVATIONS_DEG), len(_TURBIDITIES), 2))
    for k, elevation_deg in enumerate(ELEVATIONS_DEG):
        sun = np.radians(elevation_deg)
        nu = np.clip(d @ np.array([np.cos(sun), 0.0, np.sin(sun)]), -1.0, 1.0)
        solved = luminance(sky.radiance_rgb(0.0, d[:, 2], float(np.sin(sun)), nu))
        found[k] = [_off(t, sun, d, nu, solved) for t in _TURBIDITIES]
    best = int(np.log(found[..., 1]).mean(axis=0).argmin())
    return float(_TURBIDITIES[best]), found[:, best, 0], found[:, best, 1]


def _off(
    turbidity: float, sun: float, d: FloatArray, nu: FloatArray, solved: FloatArray
) -> tuple[float, float]:
    model = HosekWilkieSky(float(turbidity), _ALBEDO, float(sun))
    shown = luminance(model.radiance(np.arccos(d[:, 2]), np.arccos(nu)))
    ratio = np.log(shown / solved)
    # The middle of the narrowest range that holds nine tenths.
    ordered, keep = np.sort(ratio), int(0.9 * ratio.size)
    width = ordered[keep:] - ordered[:-keep]
    k = int(width.argmin())
    middle, half = 0.5 * (ordered[k] + ordered[k + keep]), 0.5 * width[k]
    return float(np.exp(-middle)), float(np.exp(half))


def main() -> None:
    """Print a line for each depth: turbidity, levels, worst ratios."""
    for depth in DEPTHS:
        turbidity, level, worst = fit(depth)
        print(depth, round(turbidity, 1), level.round(3).tolist(), worst.round(3), flush=True)


if __name__ == "__main__":
    main()

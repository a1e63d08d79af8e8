"""Sunlight through the clear air and its haze, at any altitude and for any height of the sun.

The one path of direct light that skies, clouds, weather and the night share: refracted
(`slant_path`), through the standard gases (`clear_air`) and layers of haze.
"""

from collections.abc import Sequence
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.atmosphere import clear_air
from vrut_lite.atmosphere.gases import water_optical_depth
from vrut_lite.atmosphere.slant_path import (
    Density,
    exponential,
    horizon_sine,
    slant_paths,
    tent,
)
from vrut_lite.geometry.colour import colour_table, rgb_from_spectrum, solar_irradiance
from vrut_lite.numeric_types import FloatArray

_SUN_RADIUS_RAD = 0.004675


class LayerOfHaze(Protocol):
    """A layer of aerosol: exponential, or a tent about a peak."""

    @property
    def height_m(self) -> float:
        """The scale height, or the tent's half width."""

    @property
    def peak_m(self) -> float | None:
        """Altitude of the tent's peak; None where the layer is exponential."""

    def depth_at(self, wavelength_nm: ArrayLike) -> FloatArray:
        """The vertical optical depth (n,)."""


def sunlight_at_altitude(
    altitude_m: ArrayLike,
    sine: ArrayLike,
    haze: Sequence[LayerOfHaze] = (),
    nitrogen_dioxide_du: float = clear_air.NITROGEN_DIOXIDE_DU,
) -> FloatArray:
    """Irradiance (..., 3) of a plane that faces the sun, linear sRGB in W m^-2.

    Args:
        altitude_m: (...,) of the plane over the ground, 0 or more; it may lie above the air.
        sine: (...,) of the sun's apparent elevation there. The horizon, which dips with the
            altitude, cuts the disc off.
        haze: between the ground and the sun.
        nitrogen_dioxide_du: of the whole column.
    """
    altitude, mu = np.broadcast_arrays(
        np.asarray(altitude_m, dtype=float), np.asarray(sine, dtype=float)
    )
    lowest = horizon_sine(clear_air.STANDARD_AIR, altitude)
    over_horizon = np.arcsin(np.clip(mu, -1.0, 1.0)) - np.arcsin(lowest)
    shown = _shown_share(over_horizon / _SUN_RADIUS_RAD)
    # The visible part of a setting disc is seen along the horizon.
    rgb = whole_disc_rgb(altitude, np.maximum(mu, lowest), haze, nitrogen_dioxide_du)
    return np.maximum(rgb, 0.0) * shown[..., None]


def whole_disc_rgb(
    altitude_m: ArrayLike,
    sine: ArrayLike,
    haze: Sequence[LayerOfHaze],
    nitrogen_dioxide_du: float = clear_air.NITROGEN_DIOXIDE_DU,
) -> FloatArray:
    """The same by the whole disc, seen or not; may lie below 0, outside the gamut."""
    wavelength_nm = colour_table()[:, 0]
    depth = slant_depth(altitude_m, sine, wavelength_nm, haze, nitrogen_dioxide_du)
    spectral = solar_irradiance(wavelength_nm) * np.exp(-depth)
    return rgb_from_spectrum(spectral, wavelength_nm, solar_exponent=0.0)


def slant_depth(
    altitude_m: ArrayLike,
    sine: ArrayLike,
    wavelength_nm: ArrayLike,
    haze: Sequence[LayerOfHaze],
    nitrogen_dioxide_du: float = clear_air.NITROGEN_DIOXIDE_DU,
) -> FloatArray:
    """Optical depth (..., n) of all the air along a refracted ray to space; see `slant_paths`."""
    densities: list[Density] = [
        clear_air.molecule_density,
        clear_air.ozone_density,
        clear_air.pair_density,
        partial(exponential, clear_air.WATER_HEIGHT_M),
        *(layer_density(layer) for layer in haze),
    ]
    kinks = {*clear_air.STANDARD_AIR.kinks_m, *(m for layer in haze for m in layer_kinks_m(layer))}
    air = clear_air.STANDARD_AIR._replace(kinks_m=tuple(sorted(kinks)))
    paths = slant_paths(air, altitude_m, sine, densities)
    nm = np.asarray(wavelength_nm, dtype=float)
    per_m = [
        clear_air.molecules_per_m(nm) + clear_air.nitrogen_dioxide_per_m(nm, nitrogen_dioxide_du),
        clear_air.ozone_per_m(nm),
        clear_air.oxygen_pairs_per_m(nm),
        np.zeros(nm.size),
        *(layer.depth_at(nm) / layer.height_m for layer in haze),
    ]
    water_cm = clear_air.WATER_CM * paths[..., 3] / clear_air.WATER_HEIGHT_M
    return paths @ np.stack(per_m) + water_optical_depth(nm, water_cm)


def extinctions_per_m(
    altitude_m: ArrayLike, wavelength_nm: ArrayLike, haze: Sequence[LayerOfHaze]
) -> FloatArray:
    """Extinction by ozone, molecules and each layer of haze, (2 + layers, ..., n), 1/m.

    The weak absorbers are left out: the light of the night needs them less exactly.
    """
    altitude = np.asarray(altitude_m, dtype=float)[..., None]
    nm = np.asarray(wavelength_nm, dtype=float)
    found = [
        clear_air.ozone_per_m(nm) * clear_air.ozone_density(altitude),
        clear_air.molecules_per_m(nm) * clear_air.molecule_density(altitude),
    ]
    for layer in haze:
        found.append(layer.depth_at(nm) / layer.height_m * layer_density(layer)(altitude))
    return np.stack(found)


def layer_density(layer: LayerOfHaze) -> Density:
    """Relative density of a layer; its integral over the altitude is the layer's height."""
    if layer.peak_m is None:
        return partial(exponential, layer.height_m)
    return partial(tent, layer.height_m, layer.peak_m)


def layer_kinks_m(layer: LayerOfHaze) -> tuple[float, ...]:
    """Altitudes where a layer's density has a kink; none where it is exponential."""
    if layer.peak_m is None:
        return ()
    return tuple(layer.peak_m + side * layer.height_m for side in (-1.0, 0.0, 1.0))


def _shown_share(over_horizon: FloatArray) -> FloatArray:
    """Visible share (...,) of a disc whose centre is `over_horizon` radii above the horizon."""
    h = np.clip(over_horizon, -1.0, 1.0)
    return 0.5 + (np.arcsin(h) + h * np.sqrt(1.0 - h * h)) / np.pi

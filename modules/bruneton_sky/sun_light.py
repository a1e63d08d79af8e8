"""Sunlight behind the air, and the disc's limb darkening."""

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from vrut_lite.atmosphere.clear_air import WATER_HEIGHT_M
from vrut_lite.atmosphere.gases import water_optical_depth
from vrut_lite.atmosphere.haze_layer import HazeLayer
from vrut_lite.atmosphere.slant_path import (
    BentAir,
    Density,
    exponential,
    horizon_sine,
    slant_paths,
)
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray

RGB_WAVELENGTH_NM = (680.0, 550.0, 440.0)
_SUNLIGHT_EXPONENT = 0.0
# Nodes over the disc, from low orbit two kilometres of air apart, and over how many of its radii.
_DISC_NODES, _DISC_MARGIN, _DISC_STRIPS = 12, 1.2, 64


class DiscLight(NamedTuple):
    """The sun's light by the point of its disc, for one observer.

    `depth` (n,): 1 + mu of points from the disc's lowest to its highest, uniform.
    `irradiance_rgb` (n, 3): that of a whole sun that is seen there, linear sRGB, W m^-2;
    `seen_rgb` (3,): that of the visible part of the disc.
    """

    depth: NDArray[np.float64]
    irradiance_rgb: NDArray[np.float64]
    seen_rgb: NDArray[np.float64]


def bent_air(atmosphere: Atmosphere) -> BentAir:
    """The air as the direct sun's rays pass it."""
    top_m = atmosphere.top_altitude_m
    air = BentAir(
        atmosphere.ground_radius_m,
        top_m,
        atmosphere.refractivity,
        atmosphere.molecules,
        atmosphere.kinks_m,
    )
    layers = atmosphere.molecule_layers
    bases_m = np.array(layers.base_m)
    slopes = atmosphere.molecules(bases_m) / layers.scale_height_m
    return air.limited(float(np.max(slopes[bases_m < top_m])))


def sun_irradiance(atmosphere: Atmosphere, altitude_m: ArrayLike, mu_s: ArrayLike) -> FloatArray:
    """Irradiance (..., C) on a plane that faces the whole disc, W m^-2 nm^-1.

    The transmittance is that of the disc's centre along its refracted ray, at cosines (...,) of its
    apparent zenith angle; below the horizon, while a part of the disc still shows, that of the
    horizon. Observers (...,) may be above the air.
    """
    air = bent_air(atmosphere)
    altitude = np.asarray(altitude_m, dtype=float)
    mu = np.maximum(np.asarray(mu_s, dtype=float), horizon_sine(air, altitude))
    kinds = atmosphere.particles()
    densities: list[Density] = [
        atmosphere.molecules,
        lambda height: atmosphere.molecules(height) ** 2,
        atmosphere.absorber,
        partial(exponential, WATER_HEIGHT_M),
        *(kind.density for kind in kinds),
    ]
    paths = slant_paths(air, altitude, mu, densities)
    per_m = [
        np.asarray(atmosphere.rayleigh_scattering) + np.asarray(atmosphere.gas_absorption),
        np.asarray(atmosphere.pair_absorption),
        np.asarray(atmosphere.absorption_extinction),
        np.zeros(len(atmosphere.wavelength_nm)),
        *(kind.extinction for kind in kinds),
    ]
    depth = paths @ np.stack(per_m)
    if atmosphere.water_vapour_cm > 0.0:
        water_cm = atmosphere.water_vapour_cm * paths[..., 3] / WATER_HEIGHT_M
        depth += water_optical_depth(atmosphere.wavelength_nm, water_cm)
    return np.asarray(atmosphere.solar_irradiance) * np.exp(-depth)


def haze_layers(atmosphere: Atmosphere) -> tuple[HazeLayer, ...]:
    """Aerosol and fog of an atmosphere at `HAZE_NM`, as the key light names them."""
    layers = []
    for kind in atmosphere.particles():
        red, green, blue = (kind.extinction * kind.scale_height_m).tolist()
        layers.append(HazeLayer(kind.scale_height_m, (red, green, blue), kind.peak_m))
    return tuple(layers)


def disc_light(atmosphere: Atmosphere, altitude_m: float, mu_s: float) -> DiscLight:
    """Light of each part of the disc behind the air, for an observer at any altitude."""
    zenith_angle = np.arccos(np.clip(mu_s, -1.0, 1.0))
    reach = _DISC_MARGIN * atmosphere.sun_angular_radius_rad
    ends = np.clip(zenith_angle + np.array([reach, -reach]), 0.0, np.pi)
    # 1 + cos z is 2 cos^2(z / 2): no cancellation at the nadir.
    lowest, highest = 2.0 * np.cos(0.5 * ends) ** 2
    depth = np.linspace(lowest, highest, _DISC_NODES)
    light = sun_irradiance(atmosphere, altitude_m, depth - 1.0)
    rgb = rgb_from_spectrum(light, atmosphere.wavelength_nm, _SUNLIGHT_EXPONENT)
    seen = seen_irradiance_rgb(atmosphere, altitude_m, mu_s)
    return DiscLight(depth, np.maximum(rgb, 0.0), seen)


def seen_irradiance_rgb(atmosphere: Atmosphere, altitude_m: float, mu_s: float) -> FloatArray:
    """Irradiance (3,) of the disc's visible part, linear sRGB, W m^-2."""
    spectral = seen_irradiance(atmosphere, altitude_m, mu_s)
    rgb = rgb_from_spectrum(spectral, atmosphere.wavelength_nm, _SUNLIGHT_EXPONENT)
    return np.maximum(rgb, 0.0)


def seen_irradiance(atmosphere: Atmosphere, altitude_m: ArrayLike, mu_s: ArrayLike) -> FloatArray:
    """Irradiance (..., C) of the disc's visible part on a plane that faces it, W m^-2 nm^-1.

    The disc by level strips, of which the horizon cuts one: it sets without steps. Its darkening
    toward the limb is not counted.
    """
    altitude = np.asarray(altitude_m, dtype=float)[..., None]
    height = (np.arange(_DISC_STRIPS) + 0.5) * 2.0 / _DISC_STRIPS - 1.0
    chord = np.sqrt((1.0 - height) * (1.0 + height))
    centre = np.arccos(np.clip(mu_s, -1.0, 1.0))[..., None]
    zenith_angle = centre - atmosphere.sun_angular_radius_rad * height
    horizon = np.arccos(horizon_sine(bent_air(atmosphere), altitude))
    strip = 2.0 * atmosphere.sun_angular_radius_rad / _DISC_STRIPS
    up = np.clip((horizon - np.abs(zenith_angle)) / strip + 0.5, 0.0, 1.0)
    seen = chord / chord.sum() * up
    light = sun_irradiance(atmosphere, altitude, np.cos(zenith_angle))
    return np.asarray((seen[..., None, :] @ light)[..., 0, :])


def sun_irradiance_rgb(
    atmosphere: Atmosphere, altitude_m: float, mu_s: float, visible_disc_fraction: float
) -> FloatArray:
    """Irradiance (3,) of the visible part of the disc, linear sRGB, W m^-2.

    A component below zero, a sun redder than the gamut, is clamped.
    """
    spectral = sun_irradiance(atmosphere, altitude_m, mu_s)
    rgb = rgb_from_spectrum(spectral, atmosphere.wavelength_nm, _SUNLIGHT_EXPONENT)
    return np.maximum(rgb, 0.0) * visible_disc_fraction


def limb_darkening(wavelength_nm: float) -> NDArray[np.float64]:
    """Polynomial (6,) in cos psi, constant first, whose mean over the disc is 1.

    Neckel 2005, "Analytical Reference Functions F(lambda) for the Sun's Limb Darkening and
    Its Absolute Continuum Intensities", the fit for 422.57 to 1100 nm to Neckel and Labs'
    observations of 1994.
    """
    inverse = 1000.0 / wavelength_nm
    fifth = inverse**5
    polynomial = np.array(
        [
            0.75267 - 0.265577 * inverse,
            0.93874 + 0.265577 * inverse - 0.004095 * fifth,
            -1.89287 + 0.012582 * fifth,
            2.42234 - 0.017117 * fifth,
            -1.71150 + 0.011977 * fifth,
            0.49062 - 0.003347 * fifth,
        ]
    )
    # The mean of cos^k over the disc is 2 / (k + 2).
    return polynomial / (polynomial * 2.0 / (np.arange(6) + 2.0)).sum()


def limb_darkening_rgb() -> tuple[tuple[float, ...], ...]:
    """One polynomial per channel, in the form that KeyLightChanged carries."""
    return tuple(tuple(map(float, limb_darkening(nm))) for nm in RGB_WAVELENGTH_NM)

"""Spectra of many clear skies, per unit of solar irradiance: what a colour fit learns from."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.phase import molecules_phase
from bruneton_sky.presets import WIDE_BAND_NM, earth_standard
from bruneton_sky.single_scattering_kernels import fast_scattered_without_phase
from bruneton_sky.solver import SourceField, ground_irradiance, multiple_scattering, solve
from numpy.typing import NDArray

from vrut_lite.atmosphere.aerosol import ANGSTROM_EXPONENT, optical_depth_of_turbidity
from vrut_lite.atmosphere.clear_air import oxygen_pairs_per_m, ozone_per_m
from vrut_lite.geometry.colour import (
    colour_table,
    luminance,
    rgb_from_spectrum,
    solar_irradiance,
)
from vrut_lite.numeric_types import FloatArray

# Cross sections of ozone are known each 10 nm; between, the optical depth is linear.
COARSE_NM = np.arange(360.0, 831.0, 10.0)
FINE_NM = colour_table()[:, 0]
VIEW_ELEVATIONS_DEG = (90.0, 50.0, 25.0, 10.0, 4.0, 1.0, -3.0, -20.0, -70.0)
VIEW_AZIMUTHS_DEG = (0.0, 30.0, 90.0, 180.0)
# Errors where a sky is dim count against this share of its brightest luminance.
_DIM = 1e-3
# Aerosol with g = 0.8 scatters straight on so much, in 1/sr: where its light matters most.
_AEROSOL_PEAK = 4.0
_GAUSS_NODES = 16


class Skies(NamedTuple):
    """Spectra (n, 95) each 5 nm, and where each comes from.

    `counts_against`: the luminance beside which an error of this spectrum is seen. `part`:
    0 molecules once and all orders above, 1 aerosol once without its phase function, 2 what
    the sky sends to level ground.
    """

    transfer: FloatArray
    counts_against: FloatArray
    part: NDArray[np.int64]
    turbidity: FloatArray
    sun_deg: FloatArray
    height_m: FloatArray


class FitConditions(NamedTuple):
    """The skies to compute: every atmosphere under every sun, seen from every height."""

    turbidities: tuple[float, ...]
    albedos: tuple[float, ...]
    ozone_du: tuple[float, ...]
    suns_deg: tuple[float, ...]
    heights_m: tuple[float, ...]


TO_FIT = FitConditions(
    turbidities=(1.05, 2.0, 4.0, 10.0),
    albedos=(0.0, 0.3, 0.8),
    ozone_du=(0.0, 200.0, 350.0, 500.0),
    suns_deg=(90, 60, 40, 25, 15, 10, 6, 3, 1, 0, -1, -2, -3, -4, -5, -6, -7, -8, -9),
    heights_m=(0.0, 3000.0, 12_000.0),
)
TO_TEST = FitConditions(
    turbidities=(1.5, 3.0, 6.0),
    albedos=(0.1, 0.5),
    ozone_du=(100.0, 300.0, 450.0),
    suns_deg=(
        75,
        50,
        30,
        20,
        12,
        8,
        4,
        2,
        0.5,
        -0.5,
        -1.5,
        -2.5,
        -3.5,
        -4.5,
        -5.5,
        -6.5,
        -7.5,
        -8.5,
    ),
    heights_m=(0.0, 1000.0, 8000.0),
)


def compute(conditions: FitConditions, progress: Callable[[str], None]) -> Skies:
    """Every sky of the conditions; a few seconds for each atmosphere."""
    atmospheres = list(_atmospheres(conditions))
    collected: list[Skies] = []
    for index, (turbidity, air) in enumerate(atmospheres):
        field = solve(air, all_orders=True)
        for sun_deg in conditions.suns_deg:
            collected.extend(_of_one_sun(field, turbidity, sun_deg, conditions.heights_m))
        progress(f"{index + 1} of {len(atmospheres)} atmospheres")
    return join(collected)


def join(parts: Iterable[Skies]) -> Skies:
    """All skies in one."""
    return Skies(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _atmospheres(conditions: FitConditions) -> Iterator[tuple[float, Atmosphere]]:
    """Pairs of turbidity and atmosphere; the air ends at 60 and at 120 km by turns."""
    wishes = product(conditions.turbidities, conditions.albedos, conditions.ozone_du)
    for index, (turbidity, albedo, ozone_du) in enumerate(wishes):
        earth = earth_standard(COARSE_NM)
        depth = float(optical_depth_of_turbidity(turbidity))
        yield (
            turbidity,
            replace(
                earth.with_aerosol(depth, ANGSTROM_EXPONENT),
                top_altitude_m=(60_000.0, 120_000.0)[index % 2],
                ground_albedo=(albedo,) * COARSE_NM.size,
                absorption_extinction=tuple(ozone_per_m(COARSE_NM, ozone_du)),
                # A wavelength of the product's four stands for such a band of oxygen's.
                pair_absorption=tuple(oxygen_pairs_per_m(COARSE_NM, WIDE_BAND_NM)),
                solar_irradiance=(1.0,) * COARSE_NM.size,
            ),
        )


def _of_one_sun(
    field: SourceField, turbidity: float, sun_deg: float, heights_m: tuple[float, ...]
) -> Iterator[Skies]:
    mu_s = float(np.sin(np.radians(sun_deg)))
    ground = at_fine_wavelengths(ground_irradiance(field, np.array([mu_s])))
    yield _labelled(ground, luminance_of(ground), 2, turbidity, sun_deg, 0.0)
    for height_m in heights_m:
        rest, aerosol = (at_fine_wavelengths(part) for part in _seen(field, height_m, mu_s))
        beside = luminance_of(rest)
        beside += _DIM * beside.max()
        yield _labelled(rest, beside, 0, turbidity, sun_deg, height_m)
        of_aerosol = luminance_of(aerosol) + beside / _AEROSOL_PEAK
        yield _labelled(aerosol, of_aerosol, 1, turbidity, sun_deg, height_m)


def _seen(field: SourceField, height_m: float, mu_s: float) -> tuple[FloatArray, FloatArray]:
    """Two parts (views, C) of the light of the air, as the sky-view table keeps them."""
    air = field.atmosphere
    elevation, azimuth = (
        angle.ravel()
        for angle in np.meshgrid(
            np.radians(VIEW_ELEVATIONS_DEG), np.radians(VIEW_AZIMUTHS_DEG), indexing="ij"
        )
    )
    mu = np.sin(elevation)
    nu = mu * mu_s + np.cos(elevation) * np.sqrt(1.0 - mu_s**2) * np.cos(azimuth)
    seen = (mu > horizon_mu(air.ground_radius_m, height_m)) | (height_m > 0.0)
    mu, nu = mu[seen], np.clip(nu[seen], -1.0, 1.0)
    molecules, aerosol = fast_scattered_without_phase(air, height_m, mu, mu_s, nu, _GAUSS_NODES)
    once = molecules * molecules_phase(air, nu)[:, None]
    return once + multiple_scattering(field, height_m, mu, mu_s, nu), aerosol


def _labelled(
    transfer: FloatArray,
    counts_against: FloatArray,
    part: int,
    turbidity: float,
    sun_deg: float,
    height_m: float,
) -> Skies:
    count = len(transfer)
    labels = (np.full(count, float(value)) for value in (turbidity, sun_deg, height_m))
    return Skies(transfer, counts_against, np.full(count, part), *labels)


def rgb_of(transfer: FloatArray) -> FloatArray:
    """Linear sRGB (n, 3) of spectra (n, 95) under the host's sun: the truth of the fit."""
    return rgb_from_spectrum(transfer * solar_irradiance(FINE_NM), FINE_NM)


def luminance_of(transfer: FloatArray) -> FloatArray:
    """CIE Y (n,) of spectra (n, 95) under the host's sun."""
    return luminance(rgb_of(transfer))


def at_fine_wavelengths(coarse: FloatArray) -> FloatArray:
    """Spectra (n, 95) from ones at COARSE_NM: ln is linear between, as optical depth is."""
    position = np.interp(FINE_NM, COARSE_NM, np.arange(COARSE_NM.size))
    low = np.minimum(position.astype(int), COARSE_NM.size - 2)
    share = position - low
    logarithm = np.log(np.maximum(coarse, 1e-300))
    return np.exp(logarithm[:, low] * (1.0 - share) + logarithm[:, low + 1] * share)

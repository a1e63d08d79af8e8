"""Make modules/dynamic_skylight/data/twilight.npz from traced light.

Run from the repository's root, after trace_tables.py: python -m tools.twilight_fit.fit
The first order of scattering is computed exactly at the table's own suns and directions. The
higher orders, smooth and noisy, are fitted: ln of radiance as a polynomial in the sun's elevation
and the view's, times harmonics of the azimuth. The sum becomes linear sRGB and is divided by the
illuminance that it makes on level ground.
"""

import numpy as np
from bruneton_sky import single_scattering
from dynamic_skylight.twilight_table import (
    luminous_irradiance,
    sin_elevation_of,
)
from numpy.typing import NDArray

from tools.twilight_fit.air import air
from tools.twilight_fit.spectra import rgb_of
from tools.twilight_fit.trace_tables import (
    AZIMUTH_DEG,
    MULTIPLE,
    ROOT,
    SUN_DEG,
    TURBIDITIES,
    VIEW_V,
)

FloatArray = NDArray[np.float64]
TARGET = ROOT / "modules" / "dynamic_skylight" / "data" / "twilight.npz"
# Deeper the traced light is too noisy, and half of what is seen is the night's.
TABLE_SUN_DEG = np.arange(2.0, -13.5, -1.0)
TABLE_V = np.linspace(0.0, 1.0, 24)
TABLE_A = np.linspace(0.0, 1.0, 13)
# Degrees in sun and view of the polynomial that multiplies each harmonic of the azimuth.
DEGREES = ((8, 6), (7, 5), (6, 4), (5, 3))
# A coefficient is expected within so much of 0, less by a factor for each degree and harmonic:
# where the traced light is noisy this smooths it.
EXPECTED, FALL = 4.0, 0.5
# The model's own error: keeps the best traced points from ruling the fit.
MODEL_ERROR = 0.01
LOG_STEP = 1.0 / 4000.0


def basis(
    sun_deg: FloatArray, mu: FloatArray, azimuth: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Columns (n, k) of the fit at suns, view cosines and azimuths (n,), and their degrees (k,).

    The square root of mu resolves the horizon and is smooth at the zenith, where the k-th
    harmonic must vanish as sin(theta)^k.
    """
    x = np.interp(sun_deg, (SUN_DEG.min(), SUN_DEG.max()), (-1.0, 1.0))
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    columns, degrees = [], []
    for k, (degree_sun, degree_view) in enumerate(DEGREES):
        of_sun = np.polynomial.chebyshev.chebvander(x, degree_sun)
        of_view = np.polynomial.chebyshev.chebvander(2.0 * np.sqrt(mu) - 1.0, degree_view)
        harmonic = np.cos(k * azimuth) * sine**k
        product = of_sun[:, :, None] * of_view[:, None, :] * harmonic[:, None, None]
        columns.append(product.reshape(sun_deg.size, -1))
        degrees.append((k + np.add.outer(range(degree_sun + 1), range(degree_view + 1))).ravel())
    return np.concatenate(columns, axis=1), np.concatenate(degrees)


def fit_multiple(mean: FloatArray, error: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Coefficients (k, C) of ln radiance from traced [sun, v, azimuth, C], and chi^2 per point.

    A path's noise is common to its wavelengths: one weight for all keeps it out of the colours.
    """
    sun, mu, azimuth = np.meshgrid(SUN_DEG, VIEW_V**2, np.radians(AZIMUTH_DEG), indexing="ij")
    # The zenith was traced once: its copies at other azimuths are left out.
    keep = ((mu < 1.0) | (azimuth == 0.0)).ravel()
    columns, degrees = basis(*(g.ravel()[keep] for g in (sun, mu, azimuth)))
    mean, relative = (a.reshape(keep.size, -1)[keep] for a in (mean, error / mean))
    # ln of a noisy mean is low by half its variance.
    target = np.log(mean) + 0.5 * relative**2
    weight = 1.0 / np.hypot(relative.mean(axis=1, keepdims=True), MODEL_ERROR)
    expected = np.where(degrees == 0, 100.0, EXPECTED * FALL**degrees)
    left = np.concatenate([columns * weight, np.diag(1.0 / expected)])
    right = np.concatenate([target * weight, np.zeros((degrees.size, target.shape[1]))])
    coefficients = np.linalg.lstsq(left, right, rcond=None)[0]
    residual = (columns @ coefficients - target) / np.hypot(relative, MODEL_ERROR)
    return coefficients, np.mean(residual**2, axis=0)


def table_radiance(turbidity: float, coefficients: FloatArray) -> FloatArray:
    """Radiance per unit of solar irradiance [sun, v, a, C] on the table's grid."""
    azimuths, cosines = 2.0 * np.arcsin(TABLE_A), sin_elevation_of(TABLE_V)
    sun, mu, azimuth = np.meshgrid(TABLE_SUN_DEG, cosines, azimuths, indexing="ij")
    columns, _ = basis(sun.ravel(), mu.ravel(), azimuth.ravel())
    multiple = np.exp(columns @ coefficients)
    mu_s = np.sin(np.radians(sun))
    nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * np.cos(azimuth)
    first = single_scattering(air(turbidity), 0.0, mu, mu_s, nu, samples=32)
    return first + multiple.reshape(first.shape)


def main() -> None:
    """Fit each turbidity and write the data file."""
    with np.load(MULTIPLE) as traced:
        mean, error = traced["mean"], traced["error"]
    logarithm, irradiance = [], []
    for t in np.argsort(TURBIDITIES):
        turbidity = TURBIDITIES[t]
        coefficients, chi_squared = fit_multiple(mean[t], error[t])
        print(f"turbidity {turbidity:g}: chi^2 per point {np.round(chi_squared, 2)}")
        rgb = rgb_of(table_radiance(turbidity, coefficients))
        level = np.array([luminous_irradiance(sky) for sky in rgb])
        logarithm.append(np.log(rgb / level[:, None, None, None]))
        irradiance.append(level)
    np.savez_compressed(
        TARGET,
        log_shape_steps=np.round(np.array(logarithm) / LOG_STEP).astype(np.int16),
        log_step=LOG_STEP,
        turbidity=np.sort(TURBIDITIES),
        sun_deg=TABLE_SUN_DEG,
        luminous_irradiance=np.array(irradiance),
        provenance=np.array(
            "Made by tools/twilight_fit (trace_tables.py, then fit.py) of this project: exact "
            "first order and backward Monte Carlo of orders 2 to 8 in a spherical atmosphere to "
            "120 km with Rayleigh, aerosol and 300 Dobson units of ozone (cross sections: "
            "University of Bremen, Serdyuchenko et al. 2014), ground albedo 0.2, sun ASTM G-173, "
            "nine wavelengths 380 to 700 nm, no refraction. log_shape_steps * log_step = ln of "
            "linear sRGB radiance over the luminous irradiance (CIE Y) on level ground, axes: "
            "turbidity, sun_deg (elevation), v (24 even steps), a (13 even steps), channel; v "
            "and a as in twilight_table.py. luminous_irradiance: W m^-2 (times 683: lux), as "
            "computed; the program takes its level from a published curve instead."
        ),
    )
    print(f"{TARGET.name}: {TARGET.stat().st_size} bytes")


if __name__ == "__main__":
    main()

"""Make modules/dynamic_skylight/data/twilight.npz from solved skies.

Run after solve_skies.py: python -m vrut_lite_lab.twilight_fit.make_table

Every second node of the solved skies becomes linear sRGB and is divided by the illuminance that
the sky makes on level ground. What the table, interpolated, misses at the nodes between is
printed.
"""

import numpy as np
from dynamic_skylight.twilight_table import (
    TwilightTable,
    look_up,
    luminous_irradiance,
    twilight_table,
)

from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.twilight_fit.solve_skies import ROOT, SKIES, SUN_DEG, TURBIDITIES, VIEW_A, VIEW_V
from vrut_lite_lab.twilight_fit.spectra import rgb_of

TARGET = ROOT / "modules" / "dynamic_skylight" / "data" / "twilight.npz"
# Deeper, half of what is seen is the night's.
LOWEST_SUN_DEG = -13.0
LOG_STEP = 1.0 / 4000.0
PROVENANCE = """Made by vrut_lite_lab.twilight_fit (solve_skies.py, then make_table.py):
exact first order and bruneton_sky's multiple-scattering solver for all others, in a spherical
atmosphere to 120 km with Rayleigh, Preetham's aerosol and 300 Dobson units of ozone (cross
sections: University of Bremen, Serdyuchenko et al.), ground albedo 0.2, sun ASTM G-173, 28
wavelengths 400 to 780 nm, polarised light of molecules, no refraction.
log_shape_steps * log_step = ln of linear sRGB radiance over the luminous irradiance (CIE Y) on
level ground, axes: turbidity, sun_deg (elevation), v (24 even steps), a (13 even steps),
channel; v and a as in twilight_table.py. luminous_irradiance: W m^-2 (times 683: lux), as
computed; the program takes its level from a published curve instead."""


def solved_rgb(turbidity: float) -> FloatArray:
    """Linear sRGB [sun, v, a, 3] of a solved sky, W m^-2 sr^-1."""
    with np.load(SKIES / f"sky_{turbidity:g}.npz") as data:
        return rgb_of(data["radiance"].astype(float))


def print_missed(table: TwilightTable, rgb: FloatArray, turbidity: float) -> None:
    """Print, sun by sun, how the interpolated sky differs from the solved one."""
    v, a = np.meshgrid(VIEW_V, VIEW_A, indexing="ij")
    for sun_deg, sky in zip(SUN_DEG, rgb, strict=True):
        if sun_deg < LOWEST_SUN_DEG:
            break
        seen = look_up(table.directions(turbidity, sun_deg), v, a) * luminous_irradiance(sky)
        of_luminance = luminance(seen) / luminance(sky) - 1.0
        of_colour = (seen - sky) / luminance(sky)[..., None]
        rms, colour = (np.sqrt(np.mean(e**2)) for e in (of_luminance, of_colour))
        largest = np.abs(of_luminance).max()
        print(f"  sun {sun_deg:5.1f}: rms {rms:.4f}, channels {colour:.4f}, largest {largest:.3f}")


def main() -> None:
    """Write the data file."""
    every = [solved_rgb(turbidity) for turbidity in TURBIDITIES]
    kept = SUN_DEG[::2] >= LOWEST_SUN_DEG
    nodes = np.array([rgb[::2, ::2, ::2][kept] for rgb in every])
    # From the finer grid, which integrates better.
    irradiance = np.array([[luminous_irradiance(sky) for sky in rgb[::2][kept]] for rgb in every])
    logarithm = np.log(nodes / irradiance[..., None, None, None])
    np.savez_compressed(
        TARGET,
        log_shape_steps=np.round(logarithm / LOG_STEP).astype(np.int16),
        log_step=LOG_STEP,
        turbidity=np.array(TURBIDITIES),
        sun_deg=SUN_DEG[::2][kept],
        luminous_irradiance=irradiance,
        provenance=np.array(PROVENANCE.replace("\n", " ")),
    )
    print(f"{TARGET.name}: {TARGET.stat().st_size} bytes")
    for turbidity, rgb in zip(TURBIDITIES, every, strict=True):
        print(f"turbidity {turbidity:g}")
        print_missed(twilight_table(), rgb, turbidity)


if __name__ == "__main__":
    main()

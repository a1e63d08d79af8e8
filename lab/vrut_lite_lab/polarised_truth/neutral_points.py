"""Neutral points and the zenith's polarisation of flat layers of molecules.

    python -m vrut_lite_lab.polarised_truth.neutral_points

writes tests/data/rayleigh_neutral_points.txt. Sekera 1957 and Coulson 1988 ("Polarization and
Intensity of Light in the Atmosphere") tabulate the same from the tables of Coulson, Dave and Sekera
1960; here the light is sasktran2's, which agrees with IPRT's and Natraj's tables to 1e-4 of I.
"""

from dataclasses import replace

import numpy as np
from bruneton_sky import Atmosphere

from vrut_lite.geometry.polarisation import neutral_points
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.polarised_truth.by_sasktran import sasktran_stokes
from vrut_lite_lab.polarised_truth.views import Rays

TARGET = ROOT / "tests" / "data" / "rayleigh_neutral_points.txt"
_DEPTHS, _ALBEDOS, _SUN_ZENITHS_DEG = (0.05, 0.1, 0.25, 0.5, 1.0), (0.0, 0.25), (30, 50, 70, 80, 85)
_STEP_DEG = 1.0
_HEADER = """\
Sky of a flat layer of molecules without depolarisation over a Lambert ground, from the ground, by
sasktran2 (python -m vrut_lite_lab.polarised_truth.neutral_points).
Columns: optical depth, ground albedo, the sun's zenith angle; degree of polarisation at the zenith;
degrees along the sun's vertical: Babinet's point above the sun, Brewster's below it, Arago's above
the antisolar point. nan: the point is not above the horizon."""


def rayleigh_layer(depth: float, albedo: float, depolarisation: float = 0.0) -> Atmosphere:
    """Molecules alone on a planet a hundred times as large as Earth.

    Its sky is that of a flat layer to 1e-3 down to 6 degrees of elevation, to 1e-4 from 20 on.
    """
    earth = Atmosphere.earth(ozone=False)
    height_m = earth.rayleigh_scale_height_m
    column_m = -height_m * np.expm1(-earth.top_altitude_m / height_m)
    return replace(
        earth,
        wavelength_nm=(550.0,),
        solar_irradiance=(1.0,),
        ground_radius_m=6.36e8,
        rayleigh_scattering=(depth / column_m,),
        rayleigh_depolarisation=depolarisation,
        mie_scattering=(0.0,),
        mie_extinction=(0.0,),
        absorption_extinction=(0.0,),
        ground_albedo=(albedo,),
    )


def polarisation_of(depth: float, albedo: float, sun_zenith_deg: float) -> FloatArray:
    """Degree of polarisation at the zenith; distances of Babinet's, Brewster's, Arago's points."""
    angle_deg = np.arange(_STEP_DEG, 180.0, _STEP_DEG)
    sun_deg = 90.0 - sun_zenith_deg
    off_sun = angle_deg != sun_deg
    angle_deg = angle_deg[off_sun]
    azimuth = np.where(angle_deg > 90.0, np.pi, 0.0)
    angle = np.radians(angle_deg)
    rays = Rays(
        0.0,
        np.sin(angle),
        azimuth,
        np.cos(angle - np.radians(sun_deg)),
        np.sin(np.radians(sun_deg)),
    )
    i, q, _ = sasktran_stokes(rayleigh_layer(depth, albedo), rays, 0, flat=True).T
    zenith = np.argmin(np.abs(angle_deg - 90.0))
    points = neutral_points(angle_deg, q, sun_deg)
    return np.array([abs(q[zenith]) / i[zenith], *points])


def main() -> None:
    """Write the table."""
    rows = [
        [depth, albedo, sun, *polarisation_of(depth, albedo, sun)]
        for depth in _DEPTHS
        for albedo in _ALBEDOS
        for sun in _SUN_ZENITHS_DEG
    ]
    forms = ["%g", "%g", "%g", "%.4f", "%.2f", "%.2f", "%.2f"]
    np.savetxt(TARGET, rows, forms, header=_HEADER)


if __name__ == "__main__":
    main()

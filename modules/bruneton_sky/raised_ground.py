"""An atmosphere above a higher or lower ground."""

import math
from dataclasses import replace

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from vrut_lite.arguments import as_number
from vrut_lite.atmosphere.clear_air import WATER_HEIGHT_M


def raise_ground(atmosphere: Atmosphere, altitude_m: float) -> Atmosphere:
    """The same air above a ground at `altitude_m`; altitudes are then measured from there.

    A plateau cuts off the air below it, a basin below sea level is filled with more. The
    exponential profiles keep their form: their coefficients are those at the new ground.

    Raises:
        ValueError: the ground would lie above the air, or below the planet's centre.
    """
    altitude_m = as_number("altitude_m of the ground", altitude_m)
    if not -atmosphere.ground_radius_m < altitude_m < atmosphere.top_altitude_m:
        raise ValueError(
            f"a ground at {altitude_m:g} m lies outside the planet's air, "
            f"whose top is at {atmosphere.top_altitude_m:g} m"
        )
    layers, molecules = atmosphere.molecule_layers.raised(altitude_m)
    aerosol = np.exp(-altitude_m / atmosphere.mie_scale_height_m)
    aloft = np.exp(-altitude_m / atmosphere.aloft_scale_height_m)
    absorber_altitude_m, density = _cut_layers(atmosphere, altitude_m)
    return replace(
        atmosphere,
        ground_radius_m=atmosphere.ground_radius_m + altitude_m,
        top_altitude_m=atmosphere.top_altitude_m - altitude_m,
        rayleigh_scattering=tuple(np.asarray(atmosphere.rayleigh_scattering) * molecules),
        rayleigh_scale_height_m=layers.scale_height_m[0],
        rayleigh_above_m=layers.base_m[1:] or (0.0,),
        rayleigh_above_scale_height_m=layers.scale_height_m[1:] or (8000.0,),
        gas_absorption=tuple(np.asarray(atmosphere.gas_absorption) * molecules),
        pair_absorption=tuple(np.asarray(atmosphere.pair_absorption) * molecules**2),
        water_vapour_cm=atmosphere.water_vapour_cm * math.exp(-altitude_m / WATER_HEIGHT_M),
        refractivity=atmosphere.refractivity * molecules,
        mie_scattering=tuple(np.asarray(atmosphere.mie_scattering) * aerosol),
        mie_extinction=tuple(np.asarray(atmosphere.mie_extinction) * aerosol),
        aloft_scattering=tuple(np.asarray(atmosphere.aloft_scattering) * aloft),
        aloft_extinction=tuple(np.asarray(atmosphere.aloft_extinction) * aloft),
        stratosphere_peak_m=atmosphere.stratosphere_peak_m - altitude_m,
        absorber_altitude_m=absorber_altitude_m,
        absorber_density=density,
    )


def _cut_layers(
    atmosphere: Atmosphere, altitude_m: float
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Altitudes and densities of the absorber's nodes above the new ground."""
    above = np.asarray(atmosphere.absorber_altitude_m) - altitude_m
    density = np.asarray(atmosphere.absorber_density)
    if above[0] >= 0:
        return tuple(above), tuple(density)
    kept = above > 0
    at_ground = float(np.interp(0.0, above, density, right=0.0))
    if kept.any():
        return (0.0, *above[kept]), (at_ground, *density[kept])
    # All of the absorber lies below the ground.
    return (0.0, atmosphere.top_altitude_m - altitude_m), (0.0, 0.0)

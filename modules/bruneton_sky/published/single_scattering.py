"""Light scattered once on its way from the sun to the eye: the exact twin, in float64.

S = E_sun (beta_R P_R(nu) I_R + beta_M P_M(nu) I_M), with, for each substance X,
I_X = integral along the view ray of density_X exp(-tau(eye, point) - tau(point, sun)),
where the extinction of molecules, aerosol and absorber together makes tau (Nishita et al.
1993; Bruneton and Neyret 2008, section 2, with Mie extinction in the optical depth). Fog is one
more substance.
"""

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import Ray, make_ray
from bruneton_sky.optical_path import optical_depth, optical_depth_to_top
from bruneton_sky.phase import molecules_phase, particles_phase
from bruneton_sky.published.classical_rules import classical_integrals
from bruneton_sky.quadrature import sun_cosine, view_nodes
from vrut_lite.arguments import ROUNDING, as_count, as_numbers, broadcast, check_choice, check_type
from vrut_lite.numeric_types import FloatArray

# The nodes are the eigenvalues of a matrix of this size.
_MOST_SAMPLES = 1024
Rule = Literal["gauss-legendre", "midpoint", "trapezoid", "simpson"]


def single_scattering(
    atmosphere: Atmosphere,
    altitude_m: ArrayLike,
    mu: ArrayLike,
    mu_s: ArrayLike,
    nu: ArrayLike,
    rule: Rule = "gauss-legendre",
    samples: int | tuple[int, int] = 12,
) -> FloatArray:
    """Radiance (..., C) of light scattered once, W m^-2 sr^-1 nm^-1.

    The arguments broadcast. A ray that meets the ground stops there; the ground's own
    radiance is not part of this. The sun is a point, and the planet casts a sharp shadow.

    Args:
        atmosphere: C wavelengths.
        altitude_m: of the observer, from 0 to the top of the atmosphere.
        mu: cosine of the view direction's zenith angle.
        mu_s: cosine of the sun's zenith angle.
        nu: cosine of the angle between view direction and sun.
        rule: `gauss-legendre`, or one of the classical rules `midpoint`, `trapezoid`,
            `simpson`, with even intervals along both rays.
        samples: nodes on each segment of the view ray, 1 to 1024; for a classical rule the
            intervals (view, light), 1 to 16,384, even ones for `simpson`.

    Raises:
        ValueError: an argument is outside its range, not a number, or the rule is unknown.
    """
    light = _of_scatterers(atmosphere, altitude_m, mu, mu_s, nu, rule, samples)
    cosine = np.clip(np.asarray(nu, dtype=float), -1.0, 1.0)
    radiance = light.pop("molecules") * molecules_phase(atmosphere, cosine)[..., None]
    for name, part in light.items():
        radiance = radiance + part * particles_phase(atmosphere, name, cosine)
    return np.asarray(radiance)


def scattered_without_phase(
    atmosphere: Atmosphere,
    altitude_m: ArrayLike,
    mu: ArrayLike,
    mu_s: ArrayLike,
    nu: ArrayLike,
    rule: Rule = "gauss-legendre",
    samples: int | tuple[int, int] = 12,
) -> tuple[FloatArray, FloatArray]:
    """The Rayleigh and the Mie part (..., C) of `single_scattering`, without phase functions.

    Fog is in the Mie part.
    """
    light = _of_scatterers(atmosphere, altitude_m, mu, mu_s, nu, rule, samples)
    return light.pop("molecules"), np.sum(list(light.values()), axis=0)


def _of_scatterers(
    atmosphere: Atmosphere,
    altitude_m: ArrayLike,
    mu: ArrayLike,
    mu_s: ArrayLike,
    nu: ArrayLike,
    rule: Rule,
    samples: int | tuple[int, int],
) -> dict[str, FloatArray]:
    """The light (..., C) of each scatterer by name, without phase functions."""
    check_type("atmosphere", atmosphere, Atmosphere)
    check_choice("rule", rule, get_args(Rule))
    top_m = atmosphere.top_altitude_m
    altitude = as_numbers("altitude_m", altitude_m, 0.0, top_m, "m", slack=ROUNDING)
    cosines = {"mu": mu, "mu_s": mu_s, "nu": nu}
    h, view, sun_s, cosine = broadcast(
        altitude_m=altitude,
        **{name: as_numbers(name, v, -1.0, 1.0, slack=ROUNDING) for name, v in cosines.items()},
    )
    if rule == "gauss-legendre":
        samples = as_count("samples of gauss-legendre", samples, 1, _MOST_SAMPLES)
        integrals = _gauss_legendre_integrals(atmosphere, h, view, sun_s, cosine, samples)
    else:
        integrals = classical_integrals(atmosphere, h, view, sun_s, cosine, rule, samples)
    sun = np.asarray(atmosphere.solar_irradiance)
    pairs = zip(atmosphere.scatterers(), integrals, strict=True)
    return {kind.name: sun * kind.scattering * integral for kind, integral in pairs}


def _gauss_legendre_integrals(
    atmosphere: Atmosphere,
    altitude_m: FloatArray,
    mu: FloatArray,
    mu_s: FloatArray,
    nu: FloatArray,
    count: int,
) -> list[FloatArray]:
    """I_X (..., C) in m of each of the atmosphere's scatterers."""
    ray = make_ray(atmosphere.ground_radius_m, altitude_m, mu)
    node_altitude, node_y, metres, lit = view_nodes(atmosphere, ray, mu_s, nu, count)
    along = Ray(*(part[..., None] for part in ray))
    depth = optical_depth(atmosphere, along, node_altitude, node_y)
    mu_s_there = sun_cosine(along, node_altitude, node_y, mu_s[..., None], nu[..., None])
    depth += optical_depth_to_top(atmosphere, node_altitude, mu_s_there)
    light = np.exp(-depth) * (metres * lit)[..., None]
    densities = (kind.density(node_altitude) for kind in atmosphere.scatterers())
    return [(light * density[..., None]).sum(axis=-2) for density in densities]

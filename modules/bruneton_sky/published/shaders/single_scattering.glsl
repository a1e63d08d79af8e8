// Light scattered once on its way from the sun to the eye, by any of four quadrature rules and
// without any table: the twin of single_scattering.py in single precision.

#include "atmosphere.glsl"
#include "ray.glsl"
#include "optical_path.glsl"

const int GAUSS_LEGENDRE = 0;
uniform int rule;       // 0 Gauss-Legendre, 1 midpoint, 2 trapezoid, 3 Simpson

// I_R, I_M and that of fog of single_scattering.py, in m.
struct Integrals {
    vec3 rayleigh;
    vec3 mie;
    vec3 fog;
};

#include "gauss_legendre.glsl"
#include "classical_rules.glsl"

// Radiance of the Rayleigh and the Mie part without their phase functions; fog is in the latter.
Integrals scattered_without_phase(float altitude, float mu, float mu_s, float nu) {
    Integrals integrals;
    if (rule == GAUSS_LEGENDRE) {
        integrals = gauss_legendre_integrals(altitude, mu, mu_s, nu);
    } else {
        integrals = classical_integrals(altitude, mu, mu_s, nu);
    }
    integrals.rayleigh *= solar_irradiance * rayleigh_scattering;
    integrals.mie *= solar_irradiance * mie_scattering;
    integrals.mie += solar_irradiance * fog_scattering * integrals.fog;
    return integrals;
}

// W m^-2 sr^-1 nm^-1. Altitude in [0, top]; cosines as everywhere in this module.
vec3 single_scattering(float altitude, float mu, float mu_s, float nu) {
    Integrals parts = scattered_without_phase(altitude, mu, mu_s, nu);
    return rayleigh_phase_at(nu) * parts.rayleigh + mie_phase_at(nu) * parts.mie;
}

// The atmosphere as uniforms, for three wavelengths: a changed parameter needs no compilation.
// `gpu_atmosphere.py` fills them from an Atmosphere, which explains each. Lengths in metres.

uniform float ground_radius_m;
uniform float top_altitude_m;
uniform vec2 scale_height_m;            // of molecules, of aerosol
uniform vec3 solar_irradiance;          // W m^-2 nm^-1
uniform vec3 rayleigh_scattering;       // 1/m at altitude 0, as the next four
uniform vec3 mie_scattering;
uniform vec3 mie_extinction;
uniform vec3 fog_scattering;
uniform vec3 fog_extinction;
uniform float fog_scale_height_m;       // 0: no fog
uniform vec3 absorption_extinction;     // 1/m where the absorber's density is 1
uniform vec3 mie_phase;                 // g, factor and form, see phase.py

const int MOST_ABSORBER_NODES = 8;
uniform int absorber_nodes;             // 0: nothing absorbs
uniform float absorber_altitude_m[MOST_ABSORBER_NODES];
uniform float absorber_density[MOST_ABSORBER_NODES];

const float PI = 3.14159265358979;

// Relative densities of molecules and aerosol.
vec2 densities_at(float altitude) {
    return exp(-altitude / scale_height_m);
}

float fog_at(float altitude) {
    return fog_scale_height_m > 0.0 ? exp(-altitude / fog_scale_height_m) : 0.0;
}

// Relative density of the absorber: linear between its nodes, zero outside them.
float absorber_at(float altitude) {
    for (int k = 0; k + 1 < absorber_nodes; ++k) {
        float low = absorber_altitude_m[k];
        float high = absorber_altitude_m[k + 1];
        if (altitude >= low && altitude <= high) {
            float share = (altitude - low) / (high - low);
            return mix(absorber_density[k], absorber_density[k + 1], share);
        }
    }
    return 0.0;
}

// Optical depth of paths through molecules, aerosol (x, y), fog and absorber, in metres of
// density 1.
vec3 optical_depth(vec2 paths, float fog, float absorbed) {
    return rayleigh_scattering * paths.x + mie_extinction * paths.y
        + absorption_extinction * absorbed + fog_extinction * fog;
}

float rayleigh_phase_at(float nu) {
    return 3.0 / (16.0 * PI) * (1.0 + nu * nu);
}

// Cornette-Shanks or Henyey-Greenstein without a branch; 1 - nu is exact toward the sun.
float mie_phase_at(float nu) {
    float g = mie_phase.x;
    float spread = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - nu);
    return mie_phase.y * (1.0 + mie_phase.z * nu * nu) / (spread * sqrt(spread));
}

// The atmosphere for the precomputation, four wavelengths at a time, in a buffer: a changed
// parameter needs no compilation. `gpu_pipeline/air.py` fills it; Atmosphere explains each.
// Lengths in metres, coefficients in 1/m.

layout(std430, binding = 0) restrict readonly buffer Air {
    vec4 solar_irradiance;
    vec4 rayleigh_scattering;
    vec4 mie_scattering;
    vec4 mie_extinction;
    vec4 absorption_extinction;
    vec4 ground_albedo;
    vec4 mie_phase;             // g, factor and form, see phase.py
    vec2 scale_height_m;        // of molecules, of aerosol
    float ground_radius_m;
    float top_altitude_m;
    float top_tangent_m;        // from the top of the atmosphere to the ground
    float sun_angular_radius;
    float lowest_sun_share;     // where the lowest sun is on the axis of mu_s, by length
    vec2 absorber[];            // altitude and relative density of each node
};

const float PI = 3.14159265358979;

// Relative densities of molecules and aerosol.
vec2 densities_at(float altitude) {
    return exp(-altitude / scale_height_m);
}

// Relative density of the absorber: linear between its nodes, zero outside them.
float absorber_at(float altitude) {
    for (int k = 0; k + 1 < absorber.length(); ++k) {
        vec2 low = absorber[k];
        vec2 high = absorber[k + 1];
        if (altitude >= low.x && altitude <= high.x) {
            return mix(low.y, high.y, (altitude - low.x) / (high.x - low.x));
        }
    }
    return 0.0;
}

float rayleigh_phase_at(float nu) {
    return 3.0 / (16.0 * PI) * (1.0 + nu * nu);
}

float mie_phase_at(float nu) {
    float g = mie_phase.x;
    float spread = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - nu);
    return mie_phase.y * (1.0 + mie_phase.z * nu * nu) / (spread * sqrt(spread));
}

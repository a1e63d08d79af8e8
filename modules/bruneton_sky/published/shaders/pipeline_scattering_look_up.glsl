// Coordinates of states in a scattering table, in nodes from the first, and look-ups there.

float altitude_place(float altitude) {
    return tangent(altitude) / top_tangent_m * float(ALTITUDE - 1);
}

// Coordinate of a ray to the ground or to the top, from its difference to the longest.
float mu_place(float altitude, float deficit, bool hits) {
    const float last = float(MU / 2 - 1);
    float room = hits ? tangent(altitude) - altitude : room_to_top(altitude);
    // On the ground all downward rays have length 0 and count as the one straight down.
    float lacking = room > 0.0 ? clamp(deficit / room, 0.0, 1.0) : 1.0;
    return hits ? last * lacking : float(MU - 1) - last * lacking;
}

float nu_place(float nu) {
    return clamp(0.5 + 0.5 * nu, 0.0, 1.0) * float(NU - 1);
}

float mu_s_place(float mu_s) {
    float longer = length_to_top(0.0, mu_s) - top_altitude_m;
    float share = max(longer / (top_tangent_m - top_altitude_m), 0.0);
    return max(1.0 - share / lowest_sun_share, 0.0) / (1.0 + share) * float(MU_S - 1);
}

// Four-linear: one function for each axis. By hand, as that of the transmittance.
vec4 along_mu_s(sampler3D table, ivec3 at, float far) {
    return mix(texelFetch(table, at, 0), texelFetch(table, at + ivec3(1, 0, 0), 0), far);
}

vec4 along_nu(sampler3D table, ivec3 at, vec2 far) {
    ivec3 next = at + ivec3(MU_S, 0, 0);
    return mix(along_mu_s(table, at, far.x), along_mu_s(table, next, far.x), far.y);
}

vec4 along_mu(sampler3D table, ivec3 at, vec3 far) {
    ivec3 next = at + ivec3(0, 1, 0);
    return mix(along_nu(table, at, far.xy), along_nu(table, next, far.xy), far.z);
}

// At places along mu_s, nu, mu and altitude.
vec4 look_up(sampler3D table, vec4 place) {
    ivec4 before = min(ivec4(place), ivec4(MU_S, NU, MU, ALTITUDE) - 2);
    vec4 far = place - vec4(before);
    ivec3 at = ivec3(before.y * MU_S + before.x, before.z, before.w);
    ivec3 next = at + ivec3(0, 0, 1);
    return mix(along_mu(table, at, far.xyz), along_mu(table, next, far.xyz), far.w);
}

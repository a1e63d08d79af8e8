// Polarisation of the sky, and its reflection by smooth surfaces: geometry/polarisation.py's twin.
// Include it after sky_lookup.glsl.

#if defined(POLARISED) || defined(POLARISER)
layout(binding = 12) uniform samplerCube sky_q;  // by map_axis
layout(binding = 13) uniform samplerCube sky_u;
uniform float polarisation_scale;
uniform vec3 polariser_axis;  // vibration that passes the filter before the lens

vec3 map_axis(vec3 d) {
    return vec3(1.0, 0.0, 0.0) - d.x / max(1.0 + d.y, 1e-6) * (d + vec3(0.0, 1.0, 0.0));
}

// The filter's axis across a ray that leaves the eye along d.
vec3 polariser_across(vec3 d) {
    return normalize(polariser_axis - d * dot(d, polariser_axis));
}

// cos(2 t) and sin(2 t) of the angle t of an axis from another, counter-clockwise seen along d.
vec2 twice_turned(vec3 d, vec3 from, vec3 axis) {
    float c = dot(from, axis), s = dot(cross(from, d), axis);
    return vec2((c - s) * (c + s), 2.0 * c * s);
}

// Q and U by an axis across d. Before an eye on the ground there are none below the horizon.
void sky_stokes(vec3 d, vec3 axis, out vec3 q, out vec3 u) {
    vec2 turn = twice_turned(d, map_axis(d), axis) * polarisation_scale;
#ifdef BACKGROUND
    vec3 map_q = textureLod(sky_q, d, 0.0).rgb, map_u = textureLod(sky_u, d, 0.0).rgb;
#else
    vec3 map_q = sky_on_side(sky_q, d, 1.0), map_u = sky_on_side(sky_u, d, 1.0);
    turn *= step(0.0, d.y);
#endif
    q = map_q * turn.x + map_u * turn.y;
    u = map_u * turn.x - map_q * turn.y;
}
#endif

// A surface's reflection: `passed` times that of unpolarised light, plus the share of the sky in
// it times `added`. A polariser counts twice, so that unpolarised light keeps its radiance.
struct Polarised {
    float passed;
    vec3 added;
};

vec3 polarised(Polarised by, vec3 mirrored, vec3 sky_share) {
#ifdef POLARISED
    return max(by.passed * mirrored + by.added * sky_share, 0.0);
#else
    return mirrored;
#endif
}

#ifdef POLARISED
const float WHOLLY_UP_TO = 0.3, POLARISED_UP_TO = 0.6;  // roughness

// (Rs - Rp) / (Rs + Rp) and 2 |rs| rp / (Rs + Rp) by Fresnel, of a dielectric of this reflectance
// at normal incidence; the second is below 0 beyond Brewster's angle.
vec2 fresnel_polarisation(float cosine, float f0) {
    float root = sqrt(clamp(f0, 1e-6, 0.99)), n = (1.0 + root) / (1.0 - root);
    float inner = sqrt(1.0 - (1.0 - cosine * cosine) / (n * n));
    float s = (n * inner - cosine) / (n * inner + cosine);
    float p = (n * cosine - inner) / (n * cosine + inner);
    return vec2(s * s - p * p, 2.0 * s * p) / (s * s + p * p);
}
#endif

// Metals reflect both vibrations alike, and rough surfaces mix them.
Polarised polarised_reflection(vec3 n, vec3 view, float f0, float metallic, float roughness) {
#ifdef POLARISED
    float keeps = 1.0 - smoothstep(WHOLLY_UP_TO, POLARISED_UP_TO, roughness);
    vec2 ratio = fresnel_polarisation(clamp(dot(n, view), 0.0, 1.0), f0);
    ratio = mix(ratio, vec2(0.0, 1.0), metallic) * keeps;
    // Across the plane of incidence; seen from straight above any plane is one.
    vec3 across = cross(view, n);
    if (dot(across, across) < 1e-9) across = cross(view, vec3(view.y, view.z, -view.x));
    across = normalize(across);
    vec3 q, u;
    sky_stokes(reflect(-view, n), across, q, u);
#ifdef POLARISER
    vec2 turn = twice_turned(-view, across, polariser_across(-view));
    return Polarised(1.0 + ratio.x * turn.x,
                     (ratio.x + keeps * turn.x) * q - ratio.y * turn.y * u);
#else
    return Polarised(1.0, ratio.x * q);
#endif
#else
    return Polarised(1.0, vec3(0.0));
#endif
}

#version 430 core
// The sky, the ground below it, and the sun's disc with its limb darkening.

uniform samplerCube sky;
uniform float sky_scale;
uniform vec3 sun_direction;
uniform vec3 sun_disc_radiance;      // mean over the disc
uniform float sun_angular_radius;
uniform vec3 sun_upper;              // across sun_direction, from the horizon up
uniform vec2 flattening;             // by refraction: see atmosphere/refraction.py
uniform vec3 hiding_moon;            // in an eclipse
uniform float hiding_radius;         // 0: none
uniform float edge_px;               // width of edges
uniform vec3 limb_darkening[6];      // polynomial in cos psi, constant first, mean 1

in vec3 ray;
out vec4 frag_radiance;

//!include sky_lookup.glsl

#ifdef POLARISER
//!include polarised_sky.glsl

// Twice what a polariser passes of the sky, so that unpolarised light keeps its radiance.
vec3 through_polariser(vec3 d, vec3 radiance) {
    vec3 q, u;
    sky_stokes(d, polariser_across(d), q, u);
    return max(radiance + q, 0.0);
}
#else
vec3 through_polariser(vec3 d, vec3 radiance) {
    return radiance;
}
#endif

#ifdef SUN_FACTOR
//!include sun_factor.glsl
#endif

#ifdef THROUGH_AIR
//!include through_air.glsl
#endif

#ifdef BACKGROUND
uniform float sun_solid_angle;
//!background
#endif

// A direction relative to the sun's centre before refraction, right and up (rad).
vec2 about_sun(vec3 d) {
    // The cross product keeps its precision where acos of the dot product has none.
    vec3 across = cross(d, sun_direction);
    float upper = dot(d, sun_upper), angle = asin(min(1.0, length(across)));
    if (dot(d, sun_direction) <= 0.0) return vec2(3.0, 0.0);
    if (angle > 4.0 * sun_angular_radius) return vec2(angle, 0.0);
    return vec2(dot(across, sun_upper), upper - flattening.x * upper - flattening.y * upper * upper);
}

vec3 sun_disc(vec3 d, vec3 mean_radiance) {
    vec2 at = about_sun(d);
    float angle = length(at);
    float edge = max(edge_px * fwidth(angle), 1e-6);
    float covered = clamp((sun_angular_radius - angle) / edge + 0.5, 0.0, 1.0);
    float ratio = min(angle / sun_angular_radius, 1.0);
    float c = sqrt(max(0.0, 1.0 - ratio * ratio));
    vec3 darkening = limb_darkening[5];
    for (int k = 4; k >= 0; --k) darkening = darkening * c + limb_darkening[k];
    if (hiding_radius > 0.0) {
        float beside = length(at - about_sun(hiding_moon)) - hiding_radius;
        covered *= clamp(beside / edge + 0.5, 0.0, 1.0);
    }
    return mean_radiance * max(darkening, 0.0) * covered;
}

// With OVER_HORIZON the compiler omits the code for `lower`.
void main() {
    vec3 d = normalize(ray);
    float over_horizon = d.y;
#ifdef THROUGH_AIR
    over_horizon -= ground_horizon();
#endif
    float above = clamp(over_horizon / max(edge_px * fwidth(d.y), 1e-7) + 0.5, 0.0, 1.0);
#ifdef BACKGROUND
    vec3 upper = through_polariser(d, background_radiance(d));
    upper += sun_disc(d, background_sunlight(d) / sun_solid_angle);
    vec3 lower = upper;
#else
    vec3 upper = through_polariser(d, sky_on_side(sky, d, 1.0) * sky_scale);
    upper += sun_disc(d, sun_disc_radiance);
    vec3 lower = sky_on_side(sky, d, -1.0) * sky_scale;
#endif
#ifdef THROUGH_AIR
    background_through_air(d, lower, upper);
#endif
#ifdef OVER_HORIZON
    frag_radiance = vec4(upper, 1.0);
#else
    frag_radiance = vec4(mix(lower, upper, above), 1.0);
#endif
}

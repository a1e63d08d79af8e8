// The light that reaches a surface by all ways but straight from the sun: RGB irradiance in W m^-2,
// and the share of the open sky's that arrives, in alpha. render/surface_light.py uploads it.
// Uses: eye_to_point, sky_irradiance.

layout(binding = 5) uniform sampler2D light_map;
layout(binding = 6) uniform sampler3D light_probes;  // its layers: six faces, each all of z
//!include surface_light_block.glsl

const float GROUND_FADE = 0.7;  // of the half width, where the map goes over into open ground

vec4 map_light(vec2 at_px) {
    vec4 light = texture(light_map, at_px * surface.texel);
    return vec4(light.rgb * surface.radiance_scale, light.a);
}

#ifdef GROUND_LIGHT
// At a point relative to the eye: daylight/light_map.py says where it lies in the map.
vec4 ground_light(vec3 point) {
    vec2 away_m = surface.ground_eye_m + point.xz;
    vec2 reach = away_m / surface.ground_half_width_m;
    vec2 along = asinh(sinh(surface.ground_warp) * reach) / surface.ground_warp;
    vec2 at_px = surface.ground_first + clamp(0.5 + 0.5 * along, 0.0, 1.0) * surface.ground_steps;
    float far = smoothstep(GROUND_FADE, 1.0, max(abs(reach.x), abs(reach.y)));
    return mix(map_light(at_px), vec4(surface.open_ground, 1.0), far);
}
#endif

#ifdef LIGHT_PROBES
// Of a plane with normal n: each of the six planes by its squared cosine, so that shares sum up
// to one (McTaggart 2004, "Half-Life 2 / Valve Source shading").
vec4 probe_light(vec3 point, vec3 n) {
    // Half a step off the surface: the nearest probes are else behind it.
    vec3 at = surface.probes_eye + point * surface.probes_per_m + 0.5 * n;
    at = clamp(at, vec3(0.0), surface.probe_counts - 1.0) + 0.5;
    vec3 size = vec3(surface.probe_counts.xy, 6.0 * surface.probe_counts.z);
    vec3 weight = n * n / dot(n, n);
    vec4 light = vec4(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        float face = 2.0 * axis + (n[axis] < 0.0 ? 1.0 : 0.0);
        float layer = at.z + face * surface.probe_counts.z;
        light += weight[axis] * texture(light_probes, vec3(at.xy, layer) / size);
    }
    return vec4(light.rgb * surface.radiance_scale, light.a);
}
#endif

// How much more or less light a plane has with normal n than with another, by the open sky.
vec3 tilted(vec3 n, vec3 from, float most) {
    vec3 wanted = sky_irradiance(n), had = sky_irradiance(from);
    return clamp((wanted + 1e-20) / (had + 1e-20), 1.0 / most, most);
}

// Air in front of a near point; near_air.py defines near and fills the tables.

//!include air_block.glsl
// A mean along the ray.
//!sampler sampler2D near_radiance
// In m^-1.
//!sampler sampler2D near_extinction

// As in air.glsl, to second order in the small optical depth.
vec3 through_air(vec3 radiance, vec3 d, float metres, float share) {
    vec2 nodes = vec2(textureSize(near_radiance, 0));
    vec2 at = (gl_FragCoord.xy / air.picture_px * (nodes - 1.0) + 0.5) / nodes;
    vec3 optical_depth = textureLod(near_extinction, at, 0.0).rgb * metres;
    vec3 absorbed = optical_depth * (1.0 - 0.5 * optical_depth);
    return radiance + absorbed * (share * textureLod(near_radiance, at, 0.0).rgb - radiance);
}

#version 430 core
// The cloud shadow map: a layer's optical depth along the sun, from places at the lowest base.

//!include cloud_block.glsl
//!include cloud_textures.glsl
//!include cloud_density.glsl

// From the lowest base to this layer's.
uniform float rise_m;
in vec2 at;
out float optical_depth;

const int STEPS = 24;

void main() {
    vec2 place = at * 2.0 - 1.0;
    vec2 stretch = clouds.shadow_near_m / (1.0 - clouds.shadow_growth * abs(place));
    vec2 level = place * stretch - clouds.shadow_origin_m;
    float sine = max(clouds.sun_direction.y, clouds.sun_slope);
    vec2 slope = clouds.sun_direction.xz / sine;
    float texel_m = max(stretch.x, stretch.y) * 2.0 / clouds.shadow_texels;
    float step_m = clouds.thickness_m / float(STEPS);
    float width_m = max(texel_m, 0.5 * step_m / sine);
    float depth = 0.0;
    for (int i = 0; i < STEPS; ++i) {
        float over_base_m = (float(i) + 0.5) * step_m;
        depth += cloud_density_at(level + slope * (rise_m + over_base_m), over_base_m, width_m);
    }
    optical_depth = depth * step_m / sine * clouds.extinction_per_m;
}

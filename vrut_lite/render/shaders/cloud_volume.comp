#version 430 core
// Depths of the layer on a grid: the twin of daylight/cloud_light_volume.py, which explains it.
// FILL writes densities; else one height is summed, towards the sun and up (way 0), or from the sun
// and down (way 1).

//!include cloud_block.glsl
layout(local_size_x = 8, local_size_y = 8) in;

#ifdef FILL
//!include cloud_density.glsl
layout(r16f, binding = 0) writeonly uniform image3D density_image;
#else
layout(binding = 0) uniform sampler3D density;
layout(binding = 1) uniform sampler3D depths_before;
layout(rgba16f, binding = 0) uniform image3D depths;
uniform int height;
uniform int way;
uniform float heights;
const float SUB_STEPS = 8.0;
const float MOST = 6e4;  // of 16 bits
#endif

vec2 level_of(vec2 place) {
    return place * clouds.shadow_near_m / (1.0 - clouds.shadow_growth * abs(place));
}

float texel_m(vec2 level, float columns) {
    float far = max(abs(level.x), abs(level.y));
    float stretch = 1.0 + clouds.shadow_growth * far / clouds.shadow_near_m;
    return 2.0 * clouds.shadow_near_m / columns * stretch * stretch;
}

#ifdef FILL
void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    ivec3 size = imageSize(density_image);
    vec2 grid = level_of((vec2(at) + 0.5) * 2.0 / vec2(size.xy) - 1.0);
    vec2 level = grid - clouds.shadow_origin_m;
    float width_m = texel_m(grid, float(size.x));
    Column column = cloud_column(level, width_m);
    for (int k = 0; k < size.z; ++k) {
        float share = (float(k) + 0.5) / float(size.z);
        float there = cloud_density(cloud_envelope(column, share), level,
                                    share * clouds.thickness_m, width_m);
        imageStore(density_image, ivec3(at, k), vec4(there));
    }
}
#else
vec2 place_of(vec2 grid) {
    return 0.5 + 0.5 * grid / (clouds.shadow_near_m + clouds.shadow_growth * abs(grid));
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    float columns = float(imageSize(depths).x);
    vec2 grid = level_of((vec2(at) + 0.5) * 2.0 / columns - 1.0);
    float step_m = clouds.thickness_m / heights;
    float sine = max(clouds.sun_direction.y, clouds.sun_slope);
    vec2 slope_m = clouds.sun_direction.xz / sine * step_m * (way == 0 ? 1.0 : -1.0);
    float steps = clamp(ceil(length(slope_m) / texel_m(grid, columns)), 1.0, SUB_STEPS);
    float voxel = (float(height) + 0.5) / heights, along = 0.0;
    for (float m = 0.5; m < steps; m += 1.0)
        along += textureLod(density, vec3(place_of(grid + slope_m * (m / steps)), voxel), 0.0).r;
    vec2 part = vec2(along / (steps * sine), texelFetch(density, ivec3(at, height), 0).r)
              * clouds.extinction_per_m * step_m;
    int here = way == 0 ? height : height + 1, before = way == 0 ? height + 1 : height;
    float edge = (float(before) + 0.5) / (heights + 1.0);
    vec4 beyond = textureLod(depths_before, vec3(place_of(grid + slope_m), edge), 0.0);
    vec4 above = texelFetch(depths_before, ivec3(at, before), 0);
    vec4 depth = imageLoad(depths, ivec3(at, here));
    if (way == 0) depth.rb = min(vec2(beyond.r, above.b) + part, MOST);
    else depth.ga = min(vec2(beyond.g, above.a) + part, MOST);
    imageStore(depths, ivec3(at, here), depth);
}
#endif

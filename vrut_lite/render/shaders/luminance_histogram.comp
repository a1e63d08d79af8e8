#version 430 core
// Counts of a picture's pixels by stops of luminance: the twin of pictures/luminance_histogram.py.

layout(local_size_x = 16, local_size_y = 16) in;
layout(std430, binding = 0) buffer Counts { uint counts[]; };
uniform sampler2D radiance;
uniform vec3 luminance_weights;
uniform float least_log2, bins_per_stop;

// Pixels of a work group along each edge, of which each invocation takes a sixteenth.
const int TILE = 64;
shared uint own[BINS];

void main() {
    uint lane = gl_LocalInvocationIndex, lanes = gl_WorkGroupSize.x * gl_WorkGroupSize.y;
    for (uint k = lane; k < BINS; k += lanes) {
        own[k] = 0u;
    }
    barrier();
    ivec2 size = textureSize(radiance, 0);
    ivec2 lower = TILE * ivec2(gl_WorkGroupID.xy) + ivec2(gl_LocalInvocationID.xy);
    for (int row = 0; row < TILE; row += int(gl_WorkGroupSize.y)) {
        for (int column = 0; column < TILE; column += int(gl_WorkGroupSize.x)) {
            ivec2 at = lower + ivec2(column, row);
            if (any(greaterThanEqual(at, size))) {
                continue;
            }
            float value = dot(texelFetch(radiance, at, 0).rgb, luminance_weights);
            if (isnan(value) || isinf(value)) {
                continue;
            }
            float stops = log2(max(value, exp2(least_log2))) - least_log2;
            atomicAdd(own[clamp(int(floor(stops * bins_per_stop)), 0, BINS - 1)], 1u);
        }
    }
    barrier();
    for (uint k = lane; k < BINS; k += lanes) {
        if (own[k] > 0u) {
            atomicAdd(counts[k], own[k]);
        }
    }
}

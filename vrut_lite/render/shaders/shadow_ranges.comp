#version 430 core
// Nearest and farthest depth in the cells of a shadow map. FIRST: of cells of 8 x 8 texels. CORNERS:
// of the four cells around each corner, for a place's nearest corner has half a cell all around it.
// Else of cells twice as wide.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 0) uniform writeonly image2D ranges;
uniform sampler2D source;
uniform int level;
uniform int left;     // of the cells of corners, which lie side by side, widest last

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
#ifdef FIRST
    vec2 texel = 1.0 / vec2(textureSize(source, 0));
    vec4 nearest = vec4(1.0), farthest = vec4(0.0);
    for (int j = 1; j < 8; j += 2) {
        for (int i = 1; i < 8; i += 2) {
            vec4 four = textureGather(source, vec2(8 * at + ivec2(i, j)) * texel);
            nearest = min(nearest, four);
            farthest = max(farthest, four);
        }
    }
    vec2 found = vec2(min(min(nearest.x, nearest.y), min(nearest.z, nearest.w)),
                      max(max(farthest.x, farthest.y), max(farthest.z, farthest.w)));
#else
    ivec2 last = textureSize(source, level) - 1;
#ifdef CORNERS
    ivec2 first = at - 1;
#else
    ivec2 first = 2 * at;
#endif
    if (any(greaterThan(first, last))) return;
    vec2 found = vec2(1.0, 0.0);
    for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 2; ++i) {
            vec2 cell = texelFetch(source, clamp(first + ivec2(i, j), ivec2(0), last), level).rg;
            found = vec2(min(found.x, cell.x), max(found.y, cell.y));
        }
    }
#endif
    imageStore(ranges, at + ivec2(left, 0), vec4(found, 0.0, 0.0));
}

#version 430 core
// Nearest and farthest depth in the cells of a shadow map. FIRST: of cells of 4 x 4 texels. Else, of
// cells twice as wide as those of a level: each cell's own, for the next level, and with half a cell
// around it, which one fetch then finds for every place in the cell.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 0) uniform writeonly image2D own;
#ifdef FIRST
uniform sampler2D depths;
#else
layout(rg32f, binding = 1) uniform writeonly image2D around;
uniform sampler2D cells;
uniform int level;
#endif

vec2 joined(vec2 a, vec2 b) {
    return vec2(min(a.x, b.x), max(a.y, b.y));
}

#ifdef FIRST
void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    vec2 texel = 1.0 / vec2(textureSize(depths, 0)), corner = vec2(4 * at) + 1.0;
    vec4 a = textureGather(depths, corner * texel);
    vec4 b = textureGather(depths, (corner + vec2(2.0, 0.0)) * texel);
    vec4 c = textureGather(depths, (corner + vec2(0.0, 2.0)) * texel);
    vec4 d = textureGather(depths, (corner + 2.0) * texel);
    vec4 nearest = min(min(a, b), min(c, d)), farthest = max(max(a, b), max(c, d));
    imageStore(own, at, vec4(min(min(nearest.x, nearest.y), min(nearest.z, nearest.w)),
                             max(max(farthest.x, farthest.y), max(farthest.z, farthest.w)), 0, 0));
}
#else
void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), last = textureSize(cells, level) - 1;
    if (any(greaterThan(2 * at, last))) return;
    vec2 inner = vec2(1.0, 0.0), all = inner;
    for (int j = -1; j <= 2; ++j) {
        for (int i = -1; i <= 2; ++i) {
            vec2 cell = texelFetch(cells, clamp(2 * at + ivec2(i, j), ivec2(0), last), level).rg;
            all = joined(all, cell);
            if (i * (1 - i) >= 0 && j * (1 - j) >= 0) inner = joined(inner, cell);
        }
    }
    imageStore(own, at, vec4(inner, 0, 0));
    imageStore(around, at, vec4(all, 0, 0));
}
#endif

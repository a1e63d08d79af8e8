#version 430 core
// Means over the rays of rows of what their columns bring: the sky's nodes, or with PATCHES, in
// addition, the patches. Twin: hour/gather.py.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Entries { uint entries[]; };
layout(std430, binding = 1) readonly buffer Rows { uvec4 rows[]; };
layout(std430, binding = 2) readonly buffer Columns { vec4 columns[]; };
layout(std430, binding = 3) buffer Light { vec4 light[]; };
uniform uint count;

#ifdef PATCHES
//!include hour_bends.glsl
#endif

// A column, and a number of rays: see rays/ray_table.py.
uvec2 column_and_rays(uint e) {
#ifdef WIDE
    uint word = entries[e];
    return uvec2(word & 0xFFFFFFu, (word >> 24) + 1u);
#else
    uint half_word = (entries[e >> 1] >> (16u * (e & 1u))) & 0xFFFFu;
    return uvec2(half_word & 0x3FFFu, (half_word >> 14) + 1u);
#endif
}

void main() {
    uint row = gl_GlobalInvocationID.x;
    if (row >= count) return;
    uvec4 own = rows[row];
#ifdef PATCHES
    uint first = own.y, last = rows[row + 1u].x;
#else
    uint first = own.x, last = own.y;
#endif
    vec4 sum = vec4(0.0);
    for (uint e = first; e < last; ++e) {
        uvec2 entry = column_and_rays(e);
        sum += float(entry.y) * columns[entry.x];
    }
    sum /= float(max(own.z, 1u));
#ifdef PATCHES
    sum += light[row];
    if (row < texels) sum /= bends(own.w);
#endif
    light[row] = sum;
}

// Weighted sums of rows of four numbers: `Links` of hour/card_tables.py.

layout(std430, binding = 0) readonly buffer LinkStart { uint link_start[]; };
layout(std430, binding = 1) readonly buffer LinkEntry { uvec2 link_entry[]; };
layout(std430, binding = 2) readonly buffer LinkedRows { vec4 linked_rows[]; };

vec4 linked(uint row) {
    vec4 sum = vec4(0.0);
    for (uint e = link_start[row]; e < link_start[row + 1u]; ++e) {
        uvec2 entry = link_entry[e];
        sum += uintBitsToFloat(entry.y) * linked_rows[entry.x];
    }
    return sum;
}

#version 430 core
// A step of smoothing. Twin: `smoothed_rows` and `mix_at_seams` of hour/smoothing.py.
layout(local_size_x = 64) in;

//!include hour_links.glsl
layout(std430, binding = 3) writeonly buffer Smooth { vec4 smooth_rows[]; };
uniform uint count;

void main() {
    uint row = gl_GlobalInvocationID.x;
    if (row < count) smooth_rows[row] = linked(row);
}

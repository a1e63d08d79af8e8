#version 430 core
// The light map's texture.
layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f, binding = 0) writeonly uniform image2D light_map;
layout(std430, binding = 0) readonly buffer Shown { vec4 shown[]; };
layout(std430, binding = 1) readonly buffer RowOf { int row_of[]; };
uniform uint texels;

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = imageSize(light_map);
    if (any(greaterThanEqual(at, size))) return;
    uint row = uint(row_of[at.y * size.x + at.x]);
    imageStore(light_map, at, row < texels ? shown[row] : vec4(0.0));
}

#version 430 core
// A picture for display as bytes of red, green and blue, row 0 at the top, for a buffer to read.

layout(local_size_x = 256) in;
layout(std430, binding = 1) writeonly buffer Bytes { uint words[]; };
uniform sampler2D display;
uniform int row_groups;         // work groups of a row of groups

void main() {
    ivec2 size = textureSize(display, 0);
    // Four pixels are three words.
    uint quad = (gl_WorkGroupID.y * uint(row_groups) + gl_WorkGroupID.x) * gl_WorkGroupSize.x
        + gl_LocalInvocationID.x;
    int first = 4 * int(quad), last = size.x * size.y - 1;
    if (first > last) {
        return;
    }
    uint bytes[12];
    for (int k = 0; k < 4; ++k) {
        int pixel = min(first + k, last);
        ivec2 at = ivec2(pixel % size.x, size.y - 1 - pixel / size.x);
        uvec3 rgb = uvec3(255.0 * texelFetch(display, at, 0).rgb + 0.5);
        bytes[3 * k] = rgb.r;
        bytes[3 * k + 1] = rgb.g;
        bytes[3 * k + 2] = rgb.b;
    }
    for (int word = 0; word < 3; ++word) {
        words[3u * quad + uint(word)] = bytes[4 * word] | bytes[4 * word + 1] << 8
            | bytes[4 * word + 2] << 16 | bytes[4 * word + 3] << 24;
    }
}

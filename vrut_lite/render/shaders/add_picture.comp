#version 430 core
// Adds a picture to a sum of pictures, or begins one.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform image2D total;
uniform sampler2D picture;
uniform bool first;

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(total)))) {
        return;
    }
    vec4 before = first ? vec4(0.0) : imageLoad(total, at);
    imageStore(total, at, before + texelFetch(picture, at, 0));
}
